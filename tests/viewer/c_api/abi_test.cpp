#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/command.hpp"
#include "tests/support/temporary_directory.hpp"
#include "viewer/c_api/palpate.h"

namespace palpate {
namespace {

using ::testing::ContainsRegex;
using ::testing::ElementsAreArray;
using ::testing::HasSubstr;
using ::testing::Not;

const std::string only_append =
    "The ABI of libpalpate is recorded in tests/viewer/c_api/abi.txt. "
    "What is recorded there may not change: append members at the end of a structure, "
    "add functions and constants, and record them; "
    "anything else breaks programs that were compiled before, "
    "and needs a new PALPATE_ABI_VERSION and soname.";

std::vector<std::string> linesOf(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

/// Recorded lines that begin with one of these words.
std::vector<std::string> recorded(const std::vector<std::string>& words) {
  std::ifstream in(PALPATE_SOURCE_DIR "/tests/viewer/c_api/abi.txt");
  EXPECT_TRUE(in.is_open());
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);)
    for (const std::string& word : words)
      if (line.starts_with(word + " ")) lines.push_back(line);
  return lines;
}

test::CommandResult run(const std::string& command) {
  test::CommandResult result = test::runCommand(command);
  EXPECT_EQ(result.exit_code, 0) << command << '\n' << result.output;
  return result;
}

TEST(Abi, ExportsExactlyTheRecordedFunctions) {
  const auto symbols = linesOf(run("nm -D --defined-only --format=posix " PALPATE_LIBRARY).output);
  std::vector<std::string> functions;
  for (const std::string& symbol : symbols) {
    std::istringstream words(symbol);
    std::string name, kind;
    words >> name >> kind;
    EXPECT_EQ(kind, "T") << symbol;
    functions.push_back("function " + name);
  }
  EXPECT_THAT(functions, ElementsAreArray(recorded({"function"}))) << only_append;
}

/// A C program that prints the recorded structures and constants as its compiler lays them out.
std::string programOf(const std::vector<std::string>& lines) {
  std::string program = "#include <stdio.h>\n#include \"palpate.h\"\nint main(void) {\n";
  for (const std::string& line : lines) {
    std::istringstream words(line);
    std::string kind, name;
    words >> kind >> name;
    const std::size_t dot = name.find('.');
    if (kind == "constant")
      program += fmt::format("printf(\"{0} {1} %ld\\n\", (long)({1}));\n", kind, name);
    else if (kind == "member")
      program += fmt::format(
          "printf(\"{0} {1} %zu %zu\\n\", offsetof({2}, {3}), sizeof((({2}*)0)->{3}));\n", kind,
          name, name.substr(0, dot), name.substr(dot + 1));
    else
      program += fmt::format("printf(\"{0} {1} %zu\\n\", sizeof({1}));\n", kind, name);
  }
  return program + "return 0;\n}\n";
}

TEST(Abi, KeepsTheRecordedStructuresAndConstants) {
  const auto lines = recorded({"constant", "type", "struct", "member"});
  const test::TemporaryDirectory directory;
  std::ofstream(directory / "abi.c") << programOf(lines);
  const std::string built =
      fmt::format("cc -std=c99 -Wall -Wextra -Wpedantic -Werror -I '{0}' '{1}.c' -o '{1}' && '{1}'",
                  PALPATE_SOURCE_DIR "/viewer/c_api", (directory / "abi").string());
  EXPECT_THAT(linesOf(run(built).output), ElementsAreArray(lines)) << only_append;
}

// If a member were missing in abi.txt, nobody would notice that it was moved.
TEST(Abi, RecordsAllBytesOfEveryStructure) {
  std::string name;
  long size = 0, end = 0;
  int structures = 0;
  for (const std::string& line : recorded({"struct", "member"})) {
    std::istringstream words(line);
    std::string kind, what;
    long first = 0, second = 0;
    words >> kind >> what >> first >> second;
    if (kind == "struct") {
      EXPECT_EQ(end, size) << name;
      name = what;
      size = first;
      end = 0;
      ++structures;
      continue;
    }
    EXPECT_EQ(first, end) << what << " does not begin where the member before it ends";
    EXPECT_TRUE(first == 0 || !what.ends_with(".size")) << what;
    end = first + second;
  }
  EXPECT_EQ(end, size) << name;
  EXPECT_GE(structures, 9);
}

TEST(Abi, SaysItsVersion) {
  EXPECT_EQ(palpate_abi_version(), PALPATE_ABI_VERSION);
  EXPECT_STREQ(palpate_version(), PALPATE_PROJECT_VERSION);
  EXPECT_THAT(run("objdump -p " PALPATE_LIBRARY).output,
              ContainsRegex("SONAME +libpalpate.so." + std::to_string(PALPATE_ABI_VERSION)));
}

TEST(Abi, HeaderIsStrictC99AndCxx) {
  const std::string c_api = "'" PALPATE_SOURCE_DIR "/viewer/c_api/palpate.h'",
                    both = " -include '" PALPATE_SOURCE_DIR "/viewer/devices/palpate_device.h' ";
  const std::string strict =
      " -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Werror -fsyntax-only ";
  run("cc -x c -std=c99" + strict + both + c_api);
  run("c++ -x c++ -std=c++11 -Wno-pragma-once-outside-header" + strict + both + c_api);
}

TEST(Abi, LinksNeitherPictureNorSchedulerNorSolverLibraries) {
  const std::string libraries = run("ldd " PALPATE_LIBRARY).output;
  EXPECT_THAT(libraries, HasSubstr("libc.so"));
  EXPECT_THAT(libraries, Not(HasSubstr("not found")));
  EXPECT_THAT(
      libraries,
      Not(ContainsRegex(
          "libglfw|libGL|imgui|libX11|libmpi|open-rte|open-pal|libmpich|mumps|libzmq|libsqlite|libprotobuf")));
}

}  // namespace
}  // namespace palpate
