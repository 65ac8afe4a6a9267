// What the pages promise: the example of README.md is a program that is built and run, its first command has
// a scene, and every file that a page names is there.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace brink::readme_example_test {
namespace {

namespace fs = std::filesystem;

const fs::path kRoot = BRINK_SOURCE_DIR;

std::string text_of(const fs::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Contents of every fenced block of the language, in order.
std::vector<std::string> blocks(const std::string& page, const std::string& language) {
  std::vector<std::string> found;
  const std::string fence = "```" + language + "\n";
  for (std::size_t at = page.find(fence); at != std::string::npos; at = page.find(fence, at)) {
    const std::size_t begin = at + fence.size(), end = page.find("```", begin);
    if (end == std::string::npos) break;
    found.push_back(page.substr(begin, end - begin));
    at = end + 3;
  }
  return found;
}

/// The page without its fenced blocks.
std::string prose_of(const fs::path& page) {
  std::string prose;
  bool fenced = false;
  std::istringstream lines(text_of(page));
  for (std::string line; std::getline(lines, line);) {
    const bool fence = line.rfind("```", 0) == 0;
    if (!fenced && !fence) prose += line + '\n';
    fenced = fenced != fence;
  }
  return prose;
}

std::vector<fs::path> pages() {
  std::vector<fs::path> files{kRoot / "README.md", kRoot / "CHANGELOG.md"};
  for (const auto& entry : fs::directory_iterator(kRoot / "docs"))
    if (entry.path().extension() == ".md") files.push_back(entry.path());
  return files;
}

std::set<std::string> matches(const std::string& text, const char* pattern) {
  const std::regex regex(pattern);
  std::set<std::string> found;
  for (std::sregex_iterator i(text.begin(), text.end(), regex), end; i != end; ++i)
    found.insert((*i)[1].str());
  return found;
}

// The consumer test (consumer_test.cpp) builds and runs tests/consumer/readme_example.cpp against an
// installed Brink; the README shows that file and nothing else.
TEST(ReadmeExample, IsTheProgramThatTheConsumerTestBuildsAndRuns) {
  const auto shown = blocks(text_of(kRoot / "README.md"), "cpp");
  ASSERT_EQ(shown.size(), 1U);
  EXPECT_EQ(shown.front(), text_of(kRoot / "tests/consumer/readme_example.cpp"));
  EXPECT_NE(text_of(kRoot / "tests/consumer/CMakeLists.txt").find("readme_example.cpp"), std::string::npos);
  EXPECT_NE(text_of(kRoot / "tests/consumer/run.sh").find("build/readme_example"), std::string::npos);
}

// The page on scheduling shows a policy of one's own and the program that adds it, which the consumer test
// builds and runs too.
TEST(SchedulingPage, ShowsThePolicyThatTheConsumerTestBuildsAndRuns) {
  const auto shown = blocks(text_of(kRoot / "docs/scheduling.md"), "cpp");
  ASSERT_EQ(shown.size(), 2U);
  EXPECT_EQ(shown[0], text_of(kRoot / "tests/consumer/earliest_first.h"));
  EXPECT_EQ(shown[1], text_of(kRoot / "tests/consumer/own_policy.cpp"));
  EXPECT_NE(text_of(kRoot / "tests/consumer/run.sh").find("build/own_policy"), std::string::npos);
}

TEST(Readme, ItsTwoCommandsAreARunOfASceneThatIsThereAndTheTests) {
  const std::string page = text_of(kRoot / "README.md");
  const auto scenes = matches(page, R"(\n\./brink run (\S+\.toml))");
  ASSERT_EQ(scenes.size(), 1U);
  EXPECT_TRUE(fs::exists(kRoot / *scenes.begin())) << *scenes.begin();
  EXPECT_NE(page.find("\n./brink test\n"), std::string::npos);
}

TEST(Pages, LinksLeadToFilesThatAreThere) {
  for (const fs::path& page : pages())
    for (const std::string& link : matches(prose_of(page), R"(\]\(([^)#\s]+))"))
      if (link.find("://") == std::string::npos) {
        EXPECT_TRUE(fs::exists(page.parent_path() / link)) << page.filename() << " links to " << link;
      }
}

// Names in capitals stand for a choice of the reader's (scenes/gallery/NAME.toml).
TEST(Pages, SourceFilesThatTheyNameAreThere) {
  std::size_t named = 0;
  for (const fs::path& page : pages())
    for (
        const std::string& file : matches(
            text_of(page),
            R"(\b((?:core|integrators|scheduler|scenes|tests|docs)/[a-z0-9_./-]+\.(?:h|cpp|md|toml|sh))\b)")) {
      ++named;
      EXPECT_TRUE(fs::exists(kRoot / file)) << page.filename() << " names " << file;
    }
  EXPECT_GT(named, 20U);
}

}  // namespace
}  // namespace brink::readme_example_test
