#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "common/dataset/hdf5_reader.hpp"
#include "tests/support/shell_script.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/system/process.hpp"
#include "tests/worker/meshing/surfaces.hpp"

/// `palpate touch`: from a surface to a hand in it.
namespace palpate {
namespace {

using test::contentOf;
using test::Process;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// A ball of 12 cm in an STL file in millimetres.
class TouchTest : public ::testing::Test {
 protected:
  void SetUp() override {
    PALPATE_NEEDS(test::hasProgram("gmsh"), "gmsh");
    PALPATE_NEEDS(test::hasMeshio(), "python3-meshio");
    test::writeStl(test::sphereSurface(60, 8), directory_ / "ball.stl");
  }
  /// Runs the verb and expects an exit code. Returns the output.
  std::string touch(const std::vector<std::string>& words, int expected,
                    const std::string& duration = "0.1") {
    std::vector<std::string> all = {"touch", "--headless", "--duration", duration};
    all.insert(all.end(), words.begin(), words.end());
    Process run("palpate-viewer", all, directory_.path());
    EXPECT_EQ(run.wait(), expected) << run.output();
    return run.output();
  }
  bool has(const char* file) const { return std::filesystem::exists(directory_ / file); }

  test::TemporaryDirectory directory_;
};

TEST_F(TouchTest, AHandFeelsASurfaceThatNobodyHasMeshed) {
  EXPECT_THAT(
      touch({"ball.stl", "--nodes", "200", "--hand-speed", "0.05", "--record", "run.h5"}, 0, "4"),
      AllOf(HasSubstr("unit       millimetres"), HasSubstr("fixed      the "),
            HasSubstr("palpate build ball.toml"), Not(HasSubstr("next:"))));
  EXPECT_THAT(contentOf(directory_ / "ball.toml"),
              AllOf(HasSubstr("name = \"ball\""), HasSubstr("mesh = \"ball.msh\"")));
  hdf5::Reader in(directory_ / "run.h5");
  in.findArrays();
  const auto followed = in.readList<double>("/contact/followed");
  const auto force = in.readList<Eigen::Vector3d>("/force/raw");
  std::size_t felt = 0;
  for (std::size_t n = 0; n < force.size(); ++n)
    felt += followed[n] > 0.9 && force[n].norm() > 0.05 ? 1 : 0;
  EXPECT_GT(felt, 500u) << "of " << force.size() << " ticks";
}

TEST_F(TouchTest, WhatIsMadeOnceIsUsedAsItIs) {
  touch({"ball.stl", "--nodes", "200"}, 0);
  std::ofstream(directory_ / "ball.toml", std::ios::app) << "# mine\n";
  const std::string scene = contentOf(directory_ / "ball.toml");
  EXPECT_THAT(touch({"ball.stl"}, 0), HasSubstr("ball.toml exists and is used as it is"));
  EXPECT_THAT(touch({"ball.toml"}, 0), Not(HasSubstr("used as it is")));
  EXPECT_THAT(touch({"ball.stl", "--nodes", "300"}, 2), HasSubstr("ball.toml exists, so"));
  EXPECT_EQ(contentOf(directory_ / "ball.toml"), scene);

  std::filesystem::last_write_time(
      directory_ / "ball.stl",
      std::filesystem::last_write_time(directory_ / "ball.toml") + std::chrono::seconds(1));
  EXPECT_THAT(touch({"ball.stl"}, 2), HasSubstr("remove or rename ball.toml and ball.msh"));
  EXPECT_EQ(contentOf(directory_ / "ball.toml"), scene);

  std::filesystem::remove(directory_ / "ball.toml");
  const std::string mesh = contentOf(directory_ / "ball.msh");
  EXPECT_THAT(touch({"ball.msh", "--unit", "mm"}, 0), Not(HasSubstr("making a mesh")));
  EXPECT_EQ(contentOf(directory_ / "ball.msh"), mesh);
  EXPECT_TRUE(has("ball.toml"));
}

TEST_F(TouchTest, ARefusedOrganIsExplainedAndLeavesNoFiles) {
  TriangleSoup holed = test::sphereSurface(60, 8);
  holed.triangles.pop_back();
  test::writeStl(holed, directory_ / "open.stl");
  std::ofstream(directory_ / "ball.docx") << "words";
  std::ofstream(directory_ / "ball.h5") << "numbers";
  const auto before =
      std::distance(std::filesystem::directory_iterator(directory_.path()), {});  // and the logs
  EXPECT_THAT(touch({"open.stl"}, 2), HasSubstr("palpate mesh: open.stl: "));
  EXPECT_THAT(touch({"ball.stl", "--nodes", "200", "--unit", "m"}, 2),
              HasSubstr("palpate new: ball.msh: the body is 11"));
  EXPECT_THAT(touch({"ball.docx"}, 2), AllOf(HasSubstr("unknown extension"), HasSubstr(".vtu")));
  EXPECT_THAT(touch({"ball.h5"}, 2), HasSubstr("palpate view ball.h5"));
  EXPECT_THAT(touch({"none.stl"}, 2), HasSubstr("none.stl: there is no such file"));
  EXPECT_THAT(touch({"ball.stl", "--rate", "1"}, 2), HasSubstr("--rate 1"));
  const auto after = std::distance(std::filesystem::directory_iterator(directory_.path()), {});
  EXPECT_EQ(after, before + 6) << "a log of each run";
}

TEST_F(TouchTest, AnInterruptEndsTheMesherAndLeavesNoFiles) {
  std::filesystem::create_directory(directory_ / "scratch");
  test::writeScript(directory_ / "gmsh", "echo $$ > mesher.pid\nexec sleep 60");
  const test::FirstInPath first(directory_.path());
  Process run("/usr/bin/env",
              {"TMPDIR=" + (directory_ / "scratch").string(), PALPATE_BIN_DIR "/palpate-viewer",
               "touch", "ball.stl", "--headless", "--duration", "1"},
              directory_.path());
  ASSERT_TRUE(test::eventually([&] {
    return contentOf(directory_ / "mesher.pid").ends_with('\n');
  })) << run.output();
  const int mesher = std::stoi(contentOf(directory_ / "mesher.pid"));
  EXPECT_EQ(run.stop(SIGINT), 130) << run.output();
  EXPECT_TRUE(test::eventually([&] { return kill(mesher, 0) != 0; }));
  EXPECT_TRUE(std::filesystem::is_empty(directory_ / "scratch"));
  EXPECT_FALSE(has("ball.msh") || has("ball.toml"));
}

}  // namespace
}  // namespace palpate
