#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/support/command.hpp"

namespace palpate {
namespace {

TEST(Programs, NoProgramLinksOpenMpi) {
  int programs = 0;
  for (const auto& entry : std::filesystem::directory_iterator(PALPATE_BIN_DIR)) {
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
