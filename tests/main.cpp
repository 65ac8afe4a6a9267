/// The main of every test program. What a program is called says whose tests it runs: fuzz_test those of all sources
/// tests/fuzz/*_test.cpp, fuzz_stress those of tests/fuzz/*_stress.cpp, and fuzz_doors_test, a link, those of
/// tests/fuzz/doors_test.cpp only.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>

namespace {

/// Whether tests of this source are run by this program: "/x/tests/fuzz/doors_test.cpp" by fuzz_doors_test, fuzz_test.
bool runs(const std::string& program, const std::filesystem::path& source) {
  const std::string name = source.stem().string();
  std::string folder = source.parent_path().generic_string();
  std::replace(folder.begin(), folder.end(), '/', '_');
  return (folder + "_" + name).ends_with("_" + program) ||
         (folder + name.substr(name.rfind('_'))).ends_with("_" + program);
}

/// Adds to the filter what leaves out the tests that this program does not run.
void leave_out_tests_not_of(const std::string& program) {
  const auto& all = *::testing::UnitTest::GetInstance();
  std::string others;
  for (int s = 0; s < all.total_test_suite_count(); ++s) {
    const auto& suite = *all.GetTestSuite(s);
    for (int t = 0; t < suite.total_test_count(); ++t) {
      const auto& test = *suite.GetTestInfo(t);
      if (!runs(program, test.file())) others += std::string(":") + suite.name() + "." + test.name();
    }
  }
  std::string& filter = ::testing::GTEST_FLAG(filter);
  if (others.empty()) return;
  if (filter.find('-') == std::string::npos) others.front() = '-';
  filter += others;
}

}  // namespace

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  leave_out_tests_not_of(std::filesystem::path(argv[0]).stem().string());
  return RUN_ALL_TESTS();
}
