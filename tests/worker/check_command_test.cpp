#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "common/scene/scene.hpp"
#include "tests/support/blob_on_disk.hpp"
#include "tests/support/command.hpp"
#include "tests/support/meshes.hpp"

namespace palpate {
namespace {

using nlohmann::json;
using test::CommandResult;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class CheckCommand : public ::testing::Test, protected test::BlobOnDisk {
 protected:
  CheckCommand() {
    scene.workspace.max_force = 100;  // N: the whole workspace is reached
    // The command warns of kernels that differ from those of the CPU.
    unsetenv("OPENBLAS_CORETYPE");
  }

  CommandResult check(const std::string& options = "") {
    return test::runCommand(std::string(PALPATE_BIN_DIR) + "/palpate-worker check " + options +
                            " " + write());
  }
  json report() { return json::parse(check("--json").output); }
  std::vector<std::string> warnings() { return report().at("warnings"); }
};

TEST_F(CheckCommand, CountsThePointsToSolve) {
  const json found = report();
  EXPECT_EQ(found.at("mesh").at("nodes"), 125);
  EXPECT_EQ(found.at("mesh").at("tetrahedra"), 384);
  EXPECT_EQ(found.at("mesh").at("groups").at("xmin"), 25);
  EXPECT_EQ(found.at("fixed_nodes"), 25);
  const int patch = found.at("active").at(0).at("patch_nodes");
  EXPECT_GT(patch, 1);
  EXPECT_EQ(found.at("active").at(0).at("unknowns"), 3 * (125 - 25 - patch) + 125);
  EXPECT_EQ(found.at("lattice").at("points"), 515);
  EXPECT_EQ(found.at("dataset_bytes"), 515 * 98 * 12) << "of the surface";
  EXPECT_THAT(found.at("warnings"), IsEmpty());
}

TEST_F(CheckCommand, PrintsTheSummaryForPeople) {
  const CommandResult result = check();
  EXPECT_EQ(result.exit_code, 0);
  for (const char* part : {"125 nodes", "384 tetrahedra", "\"xmin\"", "mooney-rivlin", "c10 = 1300",
                           "P1-stabilized", "\"tip\"", "515 points"})
    EXPECT_THAT(result.output, HasSubstr(part));
  EXPECT_THAT(result.output, ::testing::Not(HasSubstr("warning")));
}

TEST_F(CheckCommand, PrintsTheConvertedLengthsOfASceneInMillimetres) {
  Mesh mesh = test::blobMesh();
  for (Eigen::Vector3d& node : mesh.nodes) node *= 1000;
  test::writeGmsh41(mesh, directory / "blob.msh");
  std::ofstream(directory / "mm.toml") << R"(mesh = "blob.msh"
length_unit = "mm"
material = { law = "linear", young = 1000, poisson = 0.3 }
fixed = { group = "xmin" }
active = [{ name = "tip", near = [100, 0, 20], radius = 40 }]
workspace = { radius = 100, spacing = 20 }
)";
  const CommandResult result = test::runCommand(
      std::string(PALPATE_BIN_DIR) + "/palpate-worker check " + (directory / "mm.toml").string());
  EXPECT_EQ(result.exit_code, 0) << result.output;
  for (const char* part : {"1 in the files = 0.001 m", "workspace.spacing = 0.02",
                           "near = (0.1, 0, 0.02)", "radius = 0.04"})
    EXPECT_THAT(result.output, HasSubstr(part));
}

TEST_F(CheckCommand, CountsQuadraticUnknownsAndDescribesTheTool) {
  scene.discretization = {DisplacementSpace::p2, PressureSpace::p1};
  scene.active[0].tool = ToolKind::weighted_average;
  scene.storage.displacement = StoredNodes::all;
  const json found = report();
  const int middles = found.at("mesh").at("mid_edge_nodes"), fixed = found.at("fixed_nodes");
  EXPECT_EQ(found.at("mesh").at("nodes"), 125);
  EXPECT_GT(middles, 500);
  EXPECT_EQ(fixed, 81);
  EXPECT_EQ(found.at("active").at(0).at("tool"), "weighted-average");
  EXPECT_EQ(found.at("active").at(0).at("unknowns"), 3 * (125 + middles - fixed) + 125);
  EXPECT_EQ(found.at("dataset_bytes"), 515 * (12 * (125 + middles) + 4 * 125));
  EXPECT_EQ(found.at("displacement"), "P2");
}

TEST_F(CheckCommand, CountsTheSitesOfAFingerAndTheirPoints) {
  scene.active[0] = {.name = "skin",
                     .radius = 0.06,
                     .tool = ToolKind::finger,
                     .surface = SurfaceSelection{.all = true}};
  const json found = report();
  const std::size_t sites = found.at("active").size();
  EXPECT_GT(sites, 20u);
  EXPECT_EQ(found.at("active").at(0).at("tool"), "finger");
  EXPECT_LT(found.at("configurations").get<double>(), 515.0 * static_cast<double>(sites))
      << "nobody pulls";
}

TEST_F(CheckCommand, PrintsRegionsAndGravity) {
  scene.regions[0].material.density = 1060;
  scene.regions.push_back({"body", scene.regions[0].material});
  scene.regions.erase(scene.regions.begin());  // writeGmsh calls the volume "body"
  scene.gravity = {0, 0, -9.81};
  const json found = report();
  EXPECT_EQ(found.at("regions").size(), 1u);
  const json& body = found.at("regions").at(0);
  EXPECT_EQ(body.at("group"), "body");
  EXPECT_EQ(body.at("law"), "mooney-rivlin");
  EXPECT_EQ(body.at("tetrahedra"), 384);
  EXPECT_NEAR(body.at("young"), 15480, 1e-6);
  EXPECT_EQ(body.at("poisson"), 0.5);
  EXPECT_TRUE(body.at("bulk").is_null()) << "infinite";
  EXPECT_NEAR(body.at("mass"), 1060 * body.at("volume").get<double>(), 1e-9);
  EXPECT_THAT(check().output,
              AllOf(HasSubstr("1060 kg/m^3"), HasSubstr("(0, 0, -9.81) m/s^2"),
                    HasSubstr("at rest    Young's modulus 1.548e+04 Pa, Poisson's ratio 0.5,")));
}

/// problem_warnings_test covers all of them.
TEST_F(CheckCommand, PrintsTheWarningsAboutTheProblem) {
  scene.active[0].radius = 0;
  EXPECT_THAT(warnings(), Contains(HasSubstr("radius = 0")));
  EXPECT_THAT(check().output, HasSubstr("warning    active \"tip\""));
}

TEST_F(CheckCommand, EstimatesTheCostOfABuild) {
  const json found = report();
  EXPECT_GE(found.at("measured").at("transitions"), 5);
  EXPECT_GT(found.at("measured").at("reached"), 0.9);
  const double each = found.at("core_seconds").get<double>() / 515;
  const double measured = found.at("measured").at("seconds").get<double>() /
                          found.at("measured").at("transitions").get<double>();
  EXPECT_GT(each, measured / 3);
  EXPECT_LT(each, measured * 3);
}

TEST_F(CheckCommand, WarnsOfAWorkspaceThatTheForceLimitCutsOff) {
  scene.workspace.max_force = 0.5;
  EXPECT_THAT(warnings(), Contains(HasSubstr("workspace.max_force = 0.5 N")));
}

TEST_F(CheckCommand, AcceptsAFingersWorkspaceThatTheForceLimitCutsOff) {
  scene.active[0] = {.name = "skin",
                     .radius = 0.06,
                     .tool = ToolKind::finger,
                     .surface = SurfaceSelection{.all = true}};
  scene.workspace.max_force = 0.5;
  EXPECT_LT(report().at("measured").at("reached").get<double>(), 0.5);
  EXPECT_THAT(warnings(), Not(Contains(HasSubstr("workspace.max_force"))));
}

TEST_F(CheckCommand, ReportsABodyWithoutARestStateUnderItsWeight) {
  scene.regions[0].material.density = 1e7;
  scene.gravity = {0, 0, -9.81};
  const CommandResult result = check();
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_THAT(result.output, HasSubstr("no rest state"));
}

TEST_F(CheckCommand, EstimatesNothingIfNothingCanBeSolved) {
  scene.regions[0].material = {.law = LawName::yeoh, .c10 = 1500, .c20 = -50000};
  scene.workspace.radius = 0.08;
  scene.workspace.spacing = 0.08;
  EXPECT_LT(report().at("measured").at("reached"), 0.1);
  EXPECT_THAT(warnings(), Contains(HasSubstr("trial paths from rest reaches its first point")));
}

TEST_F(CheckCommand, WarnsOfTwoActiveNodesInOnePlace) {
  scene.active.push_back(scene.active[0]);
  scene.active.back().name = "again";
  EXPECT_THAT(warnings(), Contains(HasSubstr("same node")));
}

TEST_F(CheckCommand, SumsUpTheActiveNodesOfASurface) {
  scene.active = {{.name = "skin", .surface = SurfaceSelection{.all = true}}};
  const json found = report();
  EXPECT_EQ(found.at("active").size(), 98 - 25u);
  EXPECT_EQ(found.at("configurations"), (98 - 25) * 515);
  EXPECT_THAT(check().output, AllOf(HasSubstr("and 68 more"), HasSubstr("73 active nodes")));
}

TEST_F(CheckCommand, ReportsTheLimitsCutByADevice) {
  scene.workspace.max_force = 8.5;
  scene.device = Device{device_profiles[0]};  // touch: 75 mm, 3.3 N
  EXPECT_EQ(report().at("lattice").at("radius"), 0.075);
  EXPECT_EQ(report().at("device").at("max_force_cut_from"), 8.5);
  EXPECT_THAT(check().output, AllOf(HasSubstr("workspace.radius cut from 0.1 to 0.075"),
                                    HasSubstr("workspace.max_force cut from 8.5 to 3.3")));
}

TEST_F(CheckCommand, EstimatesAnAdaptiveBuildFromTheErrorOfTrialSolves) {
  scene.accuracy = {.force_error = 0.03, .levels = 1, .probes = 10};
  scene.workspace.spacing = 0.1;
  const json found = report();
  EXPECT_EQ(found.at("configurations"), 7 + 10);
  for (const char* count :
       {"configurations", "likely_configurations", "dataset_bytes", "likely_dataset_bytes"})
    EXPECT_TRUE(found.at(count).is_number_integer()) << count << ": " << found.at(count);
  EXPECT_GE(found.at("likely_configurations"), found.at("configurations"));
  EXPECT_GE(found.at("likely_core_seconds"), found.at("core_seconds"));
}

TEST_F(CheckCommand, RefusesABadSceneWithCode2) {
  scene.fixed.groups = {"nobody"};
  const CommandResult result = check();
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.output, AllOf(HasSubstr("palpate check: "), HasSubstr("nobody")));
}

}  // namespace
}  // namespace palpate
