#include "viewer/loaded_models.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <thread>
#include <vector>

#include "common/base/error.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/pressed_body.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/support/touchable_body.hpp"

namespace palpate {
namespace {

class LoadedModelsTest : public testing::Test {
 protected:
  LoadedModelsTest() { seal(1); }
  void seal(double factor) const {
    test::TouchableBody(test::cubeMesh(0.1, 4), {{112, factor}, {113}}).seal(file);
  }

  test::TemporaryDirectory directory;
  std::filesystem::path file = directory / "body.h5";
};

/// Regression: all methods of all spaces were prepared before the start: half a minute for 356
/// spaces.
TEST_F(LoadedModelsTest, PreparesTheFirstMethodBeforeTheRunAndTheRestDuringIt) {
  LoadedModels loaded({file}, {.methods = {"trilinear", "potential"}});
  EXPECT_FALSE(loaded.first().isPrepared(0)) << "it can be seen before";
  loaded.prepareFirst();
  EXPECT_TRUE(loaded.first().isPrepared(0));
  EXPECT_FALSE(loaded.first().isPrepared(1));
  loaded.prepareTheRest();
  while (!loaded.first().isPrepared(1)) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

TEST_F(LoadedModelsTest, PreparesPressuresDuringTheRun) {
  test::PressedBody(test::cubeMesh(0.1, 4), {{112}, {113}}).seal(file);
  LoadedModels loaded({file}, {.methods = {"trilinear"}, .pressures = true});
  loaded.prepareFirst();
  EXPECT_FALSE(loaded.first().pressures().isPrepared()) << "the picture does not wait for the rest";
  loaded.prepareTheRest();
  while (!loaded.first().pressures().isPrepared())
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

TEST_F(LoadedModelsTest, ReportsItsProgressInTheWaitingThread) {
  const Mesh mesh = test::cubeMesh(0.1, 4);
  test::TouchableBody(mesh, test::wholeSurface(mesh)).seal(file);
  LoadedModels loaded({file}, {});
  const std::thread::id here = std::this_thread::get_id();
  std::vector<double> shares;
  loaded.prepareFirst([&](const HapticModel& model, double share) {
    EXPECT_EQ(std::this_thread::get_id(), here);
    EXPECT_EQ(&model, &loaded.first());
    shares.push_back(share);
    return true;
  });
  ASSERT_FALSE(shares.empty());
  EXPECT_EQ(shares.front(), 0) << "it is told before anything is prepared";
  EXPECT_TRUE(std::ranges::is_sorted(shares));
  EXPECT_TRUE(loaded.first().isPrepared(0));
}

TEST_F(LoadedModelsTest, StopsPreparingWhenTheUserLeaves) {
  LoadedModels loaded({file, file}, {});
  int asked = 0;
  EXPECT_FALSE(loaded.prepareFirst([&](const HapticModel&, double) {
    ++asked;
    return false;
  }));
  EXPECT_GT(asked, 0);
  for (const HapticModel* model : loaded.pointers()) EXPECT_FALSE(model->isPrepared(0));
  EXPECT_TRUE(loaded.prepareFirst()) << "another caller may still need them";
  for (const HapticModel* model : loaded.pointers()) EXPECT_TRUE(model->isPrepared(0));
}

TEST_F(LoadedModelsTest, AreReloadedInTheBackgroundAndHandedOverComplete) {
  ModelsReload reload({file, file}, {});
  while (!reload.ended()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  const auto fresh = reload.take();
  ASSERT_EQ(fresh->pointers().size(), 2U);
  for (const HapticModel* model : fresh->pointers()) EXPECT_TRUE(model->isPrepared(0));
  ModelsReload absent({directory / "none.h5"}, {});
  EXPECT_THROW(absent.take(), Error);
}

/// Regression: F5 blocked the window and Ctrl-C until everything was prepared.
TEST_F(LoadedModelsTest, AnUnneededPreparationEndsSoon) {
  const Mesh mesh = test::cubeMesh(0.1, 4);
  test::TouchableBody(mesh, test::wholeSurface(mesh)).seal(file);
  const std::vector<std::filesystem::path> files(8, file);
  const auto now = [] { return std::chrono::steady_clock::now(); };
  const auto begin = now();
  { ModelsReload(files, {.methods = {"rbf-cubic"}}).take(); }
  const auto whole = now() - begin;
  const auto again = now();
  { const ModelsReload reload(files, {.methods = {"rbf-cubic"}}); }
  EXPECT_LT(now() - again, whole / 4);
  std::optional<LoadedModels> loaded(std::in_place, files,
                                     HapticModelOptions{{"trilinear", "rbf-cubic"}});
  loaded->prepareTheRest();
  const auto left = now();
  loaded.reset();
  EXPECT_LT(now() - left, whole / 4);
}

TEST_F(LoadedModelsTest, NoticesThatAFileWasReplaced) {
  const LoadedModels loaded({file}, {});
  EXPECT_FALSE(loaded.replaced());
  seal(2);
  EXPECT_EQ(loaded.replaced(), file);
}

}  // namespace
}  // namespace palpate
