#include "viewer/loaded_models.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "tests/support/meshes.hpp"
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

/// All methods of all spaces were once prepared before the start: half a minute for 356 spaces.
TEST_F(LoadedModelsTest, PreparesTheFirstMethodBeforeTheStartAndTheRestBeside) {
  LoadedModels loaded({file}, {.methods = {"trilinear", "potential"}});
  EXPECT_TRUE(loaded.first().isPrepared(0));
  EXPECT_FALSE(loaded.first().isPrepared(1));
  loaded.prepareTheRest();
  while (!loaded.first().isPrepared(1)) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

TEST_F(LoadedModelsTest, EndsAPreparationThatNobodyWaitsFor) {
  LoadedModels loaded({file}, {});
  loaded.prepareTheRest();
}

TEST_F(LoadedModelsTest, NoticesThatAFileWasReplaced) {
  const LoadedModels loaded({file}, {});
  EXPECT_FALSE(loaded.replaced());
  seal(2);
  EXPECT_EQ(loaded.replaced(), file);
}

}  // namespace
}  // namespace palpate
