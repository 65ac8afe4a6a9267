// An installed Brink, used by a project of its own that knows nothing but find_package(brink).
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>

namespace brink::consumer_test {
namespace {

// The script installs this build, builds tests/consumer against it and runs that: a ball meets the floor when
// it should.
TEST(Consumer, InstalledPackageBuildsAndRunsAProject) {
  const std::filesystem::path log = std::filesystem::path(BRINK_BINARY_DIR) / "consumer.log";
  const std::string command =
      "'" BRINK_SOURCE_DIR "/tests/consumer/run.sh' '" BRINK_BINARY_DIR "' >'" + log.string() + "' 2>&1";
  const int status = std::system(command.c_str());
  std::ostringstream text;
  text << std::ifstream(log).rdbuf();
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << text.str();
  // what the README says that its example prints
  std::ostringstream readme;
  readme << std::ifstream(BRINK_SOURCE_DIR "/README.md").rdbuf();
  const std::string page = readme.str(), lead = "It prints `";
  const std::size_t begin = page.find(lead);
  ASSERT_NE(begin, std::string::npos);
  const std::size_t from = begin + lead.size(), end = page.find('`', from);
  EXPECT_NE(text.str().find('\n' + page.substr(from, end - from) + '\n'), std::string::npos) << text.str();
}

std::string text_of(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

// Headers that pages tell users of the library to include, in the table of questions and where files are explained.
TEST(Consumer, HeadersThatPagesNameAreInstalled) {
  const std::string installed = text_of(BRINK_BINARY_DIR "/public_headers.txt");
  ASSERT_NE(installed.find("scheduler/simulator/simulator.h\n"), std::string::npos) << installed;
  const std::string page = text_of(BRINK_SOURCE_DIR "/docs/architecture.md");
  const std::regex header("`((core/query|core/base/error|scheduler/simulator/simulator)[^` ]*\\.h)`");
  int named = 0;
  for (std::sregex_iterator it(page.begin(), page.end(), header), end; it != end; ++it, ++named)
    EXPECT_NE(installed.find((*it)[1].str() + "\n"), std::string::npos) << (*it)[1];
  EXPECT_GE(named, 6);
  EXPECT_NE(installed.find("scenes/run_file/run_file.h\n"), std::string::npos)
      << "docs/run-files.md names it";
}

}  // namespace
}  // namespace brink::consumer_test
