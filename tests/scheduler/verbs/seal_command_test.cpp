#include <gtest/gtest.h>

#include "tests/scheduler/build_world.hpp"
#include "tests/support/command.hpp"

namespace palpate {
namespace {

/// Seals the state directory with the real program. Returns the last line printed, which says what
/// the dataset lacks.
std::string lastLineOfSeal(const test::BuildWorld& world) {
  const std::string state = (world.directory / "state").string(),
                    out = (world.directory / "now.h5").string();
  const test::CommandResult sealed =
      test::runCommand(PALPATE_BIN_DIR "/palpate-scheduler seal '" + state + "' -o '" + out + "'");
  EXPECT_EQ(sealed.exit_code, 0) << sealed.output;
  const std::string lines = sealed.output.substr(0, sealed.output.find_last_not_of('\n') + 1);
  return lines.substr(lines.rfind('\n') + 1);
}

/// Regression: with every point solved, the user read that points were unknown.
TEST(SealCommand, DistinguishesAPendingCheckFromUnknownPoints) {
  test::BuildWorld world;
  const std::filesystem::path state = world.directory / "state", out = world.directory / "now.h5";
  world.solveOrigins();
  const std::string with_unknown_points = lastLineOfSeal(world);
  EXPECT_TRUE(Dataset(out).isPartial());

  world.request("a", 1);
  world.finish({"a"});
  Database(StateDirectory::databaseIn(state), Database::Access::read_write_create)
      .execute("INSERT INTO checks VALUES (0, 1, 0, 0, 0, 0, 0, 0)");
  const std::string with_a_check = lastLineOfSeal(world);
  const Dataset checked(out);
  EXPECT_TRUE(checked.isPartial());
  for (const SpaceTable& space : checked.spaces())
    for (const auto& point : space.points) EXPECT_NE(point.tag, Tag::unknown);
  EXPECT_NE(with_a_check, with_unknown_points);
}

}  // namespace
}  // namespace palpate
