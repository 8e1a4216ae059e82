#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>

#include "tests/support/command.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

/// What each folder may include. The three programs never include each other; tests and deploy may
/// see everything.
const std::map<std::string, std::set<std::string>> allowed = {
    {"proto", {"proto"}},
    {"common", {"common", "proto"}},
    {"scheduler", {"scheduler", "common", "proto"}},
    {"worker", {"worker", "common", "proto"}},
    {"viewer", {"viewer", "common", "proto"}}};

/// "FILE includes FOLDER/..." for every include that the folder of the file may not have.
std::vector<std::string> forbiddenIncludes(const fs::path& root) {
  static const std::regex include(
      R"re(^\s*#\s*include\s*["<](proto|common|scheduler|worker|viewer|tests|deploy)/)re");
  std::vector<std::string> found;
  for (const auto& [folder, may_include] : allowed)
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(root / folder)) {
      if (!entry.is_regular_file()) continue;
      std::ifstream in(entry.path());
      std::smatch match;
      for (std::string line; std::getline(in, line);)
        if (std::regex_search(line, match, include) && !may_include.contains(match[1]))
          found.push_back(fs::relative(entry.path(), root).string() + " includes " +
                          match[1].str());
    }
  return found;
}

TEST(Architecture, IncludesOnlyPointDown) {
  EXPECT_THAT(forbiddenIncludes(PALPATE_SOURCE_DIR), ::testing::IsEmpty());
}

TEST(Architecture, NoProgramLinksOpenMpi) {
  int programs = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(PALPATE_BIN_DIR)) {
    if (!entry.path().filename().string().starts_with("palpate")) continue;
    const test::CommandResult libraries = test::runCommand("ldd '" + entry.path().string() + "'");
    EXPECT_EQ(libraries.exit_code, 0) << libraries.output;
    EXPECT_THAT(libraries.output, ::testing::HasSubstr("libc.so")) << entry.path();
    EXPECT_THAT(
        libraries.output,
        ::testing::Not(::testing::ContainsRegex("libmpi|openmpi|open-rte|open-pal|libmpich")))
        << entry.path();
    ++programs;
  }
  EXPECT_GE(programs, 1) << "nothing is built in " << PALPATE_BIN_DIR;
}

}  // namespace
}  // namespace palpate
