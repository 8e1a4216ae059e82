#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "common/scene/scene.hpp"
#include "tests/support/command.hpp"
#include "tests/support/temporary_directory.hpp"
#include "viewer/report/area_measures.hpp"

// Parts of the shipped organs, built by the real programs and compared with exact solutions:
// forces, error bounds, and agreement of query and solve.

namespace palpate {
namespace {

/// The touched part of a shipped organ.
struct Part {
  const char* scene;       ///< below deploy/scenes
  Eigen::Vector3d center;  ///< m, centre of the touched part
  double radius;           ///< m
  std::int32_t probes;
  double median;  ///< limit of the median relative error; half as many sites have at least 1.3
                  ///< times the error
};

/// A displacement at a place, both in m.
struct Push {
  Eigen::Vector3d place, displacement;
};

class BuiltOrgan {
 public:
  explicit BuiltOrgan(const Part& part) {
    const std::filesystem::path shipped =
        std::filesystem::path(PALPATE_SOURCE_DIR) / "deploy/scenes" / part.scene;
    Scene scene = readScene(shipped);
    scene.active[0].surface = SurfaceSelection{.spheres = {{part.center, part.radius}}};
    scene.accuracy.probes = part.probes;
    std::filesystem::copy_file(shipped.parent_path() / std::filesystem::path(scene.mesh).filename(),
                               directory_ / std::filesystem::path(scene.mesh).filename());
    std::ofstream(scene_file_) << resolvedToml(scene);
    const test::CommandResult built = test::runCommand(
        program("palpate-scheduler") + " build " + scene_file_ + " -q -j 2 -o " + dataset_file_);
    // Points without an equilibrium are no failure of a build.
    EXPECT_TRUE(built.exit_code == 0 || built.exit_code == 3) << built.output;
    dataset_.emplace(dataset_file_);
    const Accuracy& wanted = dataset_->scene().accuracy;
    measures_ = measureAreas(*dataset_, {wanted.force_error, wanted.force_floor}).at(0);
  }

  const AreaMeasures& measures() const { return measures_; }

  /// The first probes within the force limit, for both `query` and `solve`.
  std::vector<Push> pushes(std::size_t count) const {
    std::vector<Push> found;
    for (const auto& probe : measures_.probes.comparisons)
      if (found.size() < count) found.push_back({probe.place, probe.displacement});
    return found;
  }

  std::vector<nlohmann::json> query(const std::vector<Push>& pushes) const {
    return ask(program("palpate-answers") + " query " + dataset_file_, pushes);
  }
  std::vector<nlohmann::json> solve(const std::vector<Push>& pushes) const {
    return ask(program("palpate-worker") + " solve " + scene_file_, pushes);
  }

 private:
  static std::string program(const std::string& name) {
    return std::string(PALPATE_BIN_DIR) + "/" + name;
  }

  std::vector<nlohmann::json> ask(const std::string& command,
                                  const std::vector<Push>& pushes) const {
    const std::string file = (directory_ / "pushes").string();
    std::ofstream lines(file);
    lines.precision(17);
    for (const Push& push : pushes)
      lines << push.place.transpose() << ' ' << push.displacement.transpose() << '\n';
    lines.close();
    std::istringstream output(
        test::runCommand(command + " -q --json --at - --displacement - < " + file).output);
    std::vector<nlohmann::json> answers;
    for (std::string line; std::getline(output, line);)
      answers.push_back(nlohmann::json::parse(line));
    return answers;
  }

  test::TemporaryDirectory directory_;
  const std::string scene_file_ = (directory_ / "part.toml").string(),
                    dataset_file_ = (directory_ / "part.h5").string();
  std::optional<Dataset> dataset_;
  AreaMeasures measures_;
};

Eigen::Vector3d forceIn(const nlohmann::json& answer) {
  const auto force = answer.at("force").get<std::array<double, 3>>();
  return Eigen::Map<const Eigen::Vector3d>(force.data());
}

void expectTruth(const Part& part, std::size_t fewest) {
  const BuiltOrgan organ(part);
  const AreaProbes& probes = organ.measures().probes;
  EXPECT_GE(probes.area.count, fewest) << "of " << probes.counts.all;
  EXPECT_GE(probes.area.within_target, 0.97);
  EXPECT_LE(probes.area.relative.median, part.median) << "sites are far apart, or cells coarse";
  EXPECT_GE(probes.area.bound_holds, 0.98);
  EXPECT_GE(probes.area.bound_over_error.median, 4)
      << "otherwise it fails at some places of other organs";
  EXPECT_LE(probes.area.bound_over_error.median, 12);

  const std::vector<Push> pushes = organ.pushes(12);
  const std::vector<nlohmann::json> felt = organ.query(pushes), exact = organ.solve(pushes);
  ASSERT_EQ(felt.size(), pushes.size());
  ASSERT_EQ(exact.size(), pushes.size());
  std::size_t bounded = 0;
  for (std::size_t n = 0; n < pushes.size(); ++n) {
    const double error = (forceIn(felt[n]) - forceIn(exact[n])).norm();
    EXPECT_NEAR(error, probes.comparisons[n].newtons, 1e-4) << "the report says the same";
    if (error <= felt[n].at("error_bound").get<double>()) ++bounded;
  }
  EXPECT_GE(bounded + 1, pushes.size());
}

TEST(BuiltOrgan, AnswersAsSolvedOnAPartOfTheLiver) {
  expectTruth({"liver/liver-surface.toml", {0.0059, 0.0019, 0.0459}, 0.03, 60, 0.0034}, 20);
}

TEST(BuiltOrgan, AnswersAsSolvedOnAPartOfTheDome) {
  expectTruth({"dome/dome.toml", {0.05, 0, 0}, 0.02, 150, 0.0018}, 20);
}

}  // namespace
}  // namespace palpate
