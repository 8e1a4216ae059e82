#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/support/command.hpp"
#include "tests/support/temporary_directory.hpp"

namespace palpate {
namespace {

using ::testing::HasSubstr;

TEST(Installation, ChecksTheShippedSceneFromWhereverItIs) {
  const test::TemporaryDirectory prefix;
  const std::string quoted = "'" + prefix.path().string() + "'";
  const auto installed = test::runCommand(PALPATE_INSTALL_COMMAND " " + quoted);
  ASSERT_EQ(installed.exit_code, 0) << installed.output;

  const auto checked = test::runCommand(quoted + "/bin/palpate check " + quoted +
                                        "/share/palpate/scenes/liver/liver.toml");
  EXPECT_EQ(checked.exit_code, 0) << checked.output;
  EXPECT_THAT(checked.output, HasSubstr("492 nodes"));
  for (const char* verb : {"build", "query"}) {
    const auto help = test::runCommand(quoted + "/bin/palpate " + verb + " --help");
    EXPECT_EQ(help.exit_code, 0) << help.output;
  }
  for (const char* file : {"LICENSE", "README.md", "docs/scene.md"})
    EXPECT_TRUE(std::filesystem::exists(prefix / "share/doc/palpate" / file)) << file;
}

}  // namespace
}  // namespace palpate
