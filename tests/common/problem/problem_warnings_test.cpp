#include "common/problem/problem_warnings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/meshes.hpp"
#include "tests/support/problems.hpp"
#include "tests/support/reference_data.hpp"

namespace palpate {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

/// The blob of 20 cm with fixed side xmin and a patch of 4 cm at the other end.
class ProblemWarnings : public ::testing::Test {
 protected:
  std::vector<std::string> warnings() {
    return warningsOf(test::clampedProblem(scene, mesh, near, patch_radius));
  }
  Material& material() { return scene.regions[0].material; }

  Scene scene = test::mooneyRivlinScene();
  Mesh mesh = test::blobMesh();
  Eigen::Vector3d near = {0.1, 0, 0.02};
  double patch_radius = 0.04;
};

TEST_F(ProblemWarnings, AreEmptyForSoundScenes) { EXPECT_THAT(warnings(), IsEmpty()); }

TEST_F(ProblemWarnings, NameTheUnitThatModuliLookLike) {
  material().c10 = 1.3;
  material().c01 = 1.28;
  EXPECT_THAT(warnings(), ElementsAre(AllOf(HasSubstr("is 15.5 Pa, softer"), HasSubstr("kPa,"))));
  material() = {.law = LawName::neo_hookean, .mu = 5e-3};
  EXPECT_THAT(warnings(), ElementsAre(HasSubstr("look like MPa, but moduli are in Pa")));
  material().mu = 5e-6;
  EXPECT_THAT(warnings(), ElementsAre(HasSubstr("look like GPa")));
}

TEST_F(ProblemWarnings, ReportTissueAsStiffAsBone) {
  scene = test::youngScene(LawName::linear);
  material().young = 2e9;
  EXPECT_THAT(warnings(), ElementsAre(AllOf(HasSubstr("2e+09 Pa, stiffer than soft tissue"),
                                            HasSubstr("moduli are in Pa"))));
}

TEST_F(ProblemWarnings, KnowTheModulusOfEveryLaw) {
  const std::vector<Material> materials = {
      {.law = LawName::linear, .young = 15, .poisson = 0.3},
      {.law = LawName::st_venant_kirchhoff, .young = 15, .poisson = 0.3},
      {.law = LawName::modified_st_venant_kirchhoff, .young = 15},
      {.law = LawName::mooney_rivlin, .c10 = 1.3, .c01 = 1.2},
      {.law = LawName::neo_hookean, .mu = 5},
      {.law = LawName::yeoh, .c10 = 2.5, .c20 = 1, .c30 = 0},
      {.law = LawName::ogden, .ogden = {{5, 2}}},
      {.law = LawName::veronda_westmann, .c1 = 2, .c2 = 2.5},
      {.law = LawName::holzapfel_gasser_ogden, .mu = 5, .k1 = 2, .k2 = 1}};
  for (const Material& soft : materials)
    EXPECT_NEAR(youngModulus(soft), 15, 1e-9) << word(soft.law);
}

TEST_F(ProblemWarnings, ReportLockingOfTetrahedraWithoutPressure) {
  for (const LawName law : {LawName::linear, LawName::st_venant_kirchhoff}) {
    scene = test::youngScene(law, 0.495);
    scene.workspace.radius = 0.05;
    scene.discretization.pressure = PressureSpace::none;
    EXPECT_THAT(warnings(), ElementsAre(AllOf(HasSubstr("poisson = 0.495"), HasSubstr("locks"))));
    scene.discretization.displacement = DisplacementSpace::p2;
    EXPECT_THAT(warnings(), ElementsAre(AllOf(HasSubstr("P2 displacement"), HasSubstr("locks"))));
    scene = test::youngScene(law, 0.48);
    scene.workspace.radius = 0.05;
    EXPECT_THAT(warnings(), IsEmpty());
  }
  scene = test::mooneyRivlinScene();
  material().bulk = 1e6;
  EXPECT_THAT(warnings(), IsEmpty()) << "it has a pressure";
  scene.discretization.pressure = PressureSpace::none;
  EXPECT_THAT(warnings(), ElementsAre(AllOf(HasSubstr("bulk = 1e+06 Pa"), HasSubstr("locks"))));
}

TEST_F(ProblemWarnings, NameParametersThatAreNegligiblySmall) {
  material() = {.law = LawName::neo_hookean, .mu = 3000, .bulk = 1, .density = 1.06};
  EXPECT_THAT(warnings(), ElementsAre(HasSubstr("Poisson's ratio -0.999"), HasSubstr("g/cm^3")));
  material().bulk = 3000;
  material().density = 1060;
  EXPECT_THAT(warnings(), IsEmpty());
  material() = {.law = LawName::holzapfel_gasser_ogden, .mu = 3000, .k1 = 2.3, .k2 = 0.84};
  material().fibers = {Eigen::Vector3d::UnitZ()};
  EXPECT_THAT(warnings(), ElementsAre(HasSubstr("k1 is in kPa")));
  material().k1 = 10000;
  EXPECT_THAT(warnings(), IsEmpty());
  material().bulk = 20000;
  EXPECT_THAT(warnings(), ElementsAre(HasSubstr("the fibres are too soft")));
}

TEST_F(ProblemWarnings, KnowTheStrainsAtWhichALawLosesStability) {
  material() = {.law = LawName::yeoh, .c10 = 1500, .c20 = -5000};
  scene.workspace.radius = 0.03;
  EXPECT_THAT(warnings(), IsEmpty()) << "15 % of the distance to the fixed nodes";
  scene.workspace.radius = 0.06;
  EXPECT_THAT(warnings(), ElementsAre(HasSubstr("unstable beyond a shear of 0.22")));
  material().c30 = 12000;
  EXPECT_THAT(warnings(), IsEmpty()) << "36 c20^2 < 60 c30 c10: it stiffens before it gives way";
  scene = test::youngScene(LawName::st_venant_kirchhoff);
  scene.workspace.radius = 0.1;
  EXPECT_THAT(warnings(), ElementsAre(HasSubstr("compression of 0.42")));
}

TEST_F(ProblemWarnings, ReportASingleLinearElementBetweenToolAndFixedNodes) {
  mesh = test::boxMesh({0.01, 0.06, 0.06}, {1, 4, 4});
  near = {0.01, 0.03, 0.03};
  patch_radius = 0.02;
  scene.workspace.radius = 0.005;
  scene.workspace.spacing = 0.0025;
  EXPECT_THAT(warnings(), ElementsAre(HasSubstr("single element between the tool and")));
  mesh = test::boxMesh({0.01, 0.06, 0.06}, {2, 4, 4});
  EXPECT_THAT(warnings(), IsEmpty());
}

TEST_F(ProblemWarnings, ReportASingleLinearElementBetweenToolAndBone) {
  mesh = test::boxMesh({0.03, 0.06, 0.06}, {3, 4, 4});
  near = {0.03, 0.03, 0.03};
  patch_radius = 0.02;
  scene.workspace.radius = 0.005;
  scene.workspace.spacing = 0.0025;
  Region bone{"bone", {.law = LawName::st_venant_kirchhoff, .young = 1e8, .poisson = 0.3}};
  scene.regions.push_back(bone);
  const auto setBoneUpTo = [&](double x) {
    mesh.element_groups["bone"].clear();
    for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e)
      if (middleOf(mesh, e)[0] < x)
        mesh.element_groups["bone"].push_back(static_cast<std::int32_t>(e));
  };
  const auto of_the_layer = Contains(HasSubstr("single element between the tool and"));
  setBoneUpTo(0.02);
  EXPECT_THAT(warnings(), of_the_layer);
  setBoneUpTo(0.01);
  EXPECT_THAT(warnings(), Not(of_the_layer)) << "two elements";
  setBoneUpTo(0.02);
  scene.regions[1].material.young = 1e6;
  EXPECT_THAT(warnings(), Not(of_the_layer)) << "no more rigid than gristle";
}

/// A scene of a report.
struct ReportedScene {
  std::string name;
  const char* warning;  ///< a part of its only warning; empty: it has none
};

TEST(ReportedScenes, HaveTheWarningsOfTheirMistakes) {
  PALPATE_REFERENCE_FILE(numerics, "cases/numerics");
  const std::vector<ReportedScene> scenes = {{"tip", ""},
                                             {"F3_yeoh", "unstable beyond a shear of 0.22"},
                                             {"F4_bulk_1", "Poisson's ratio -0.999"},
                                             {"F4_bulk_100", "Poisson's ratio -0.864"},
                                             {"F4_bulk_2200", ""},
                                             {"F4_bulk_20000", ""},
                                             {"F4_density_gcc", "in g/cm^3"},
                                             {"F4_density_si", ""},
                                             {"F4_k1_kPa", "k1 is in kPa"},
                                             {"F8_linear_0499_P1", ""},
                                             {"F8_linear_0499_P2", ""},
                                             {"F8_penalty_P2_1e6", "remove pressure"},
                                             {"F8_penalty_P2_1e7", "remove pressure"},
                                             {"F8_penalty_P2_1e8", "remove pressure"},
                                             {"F9_hgo_bulk_4000", "the fibres are too soft"},
                                             {"F9_hgo_bulk_20000", "the fibres are too soft"},
                                             {"F9_hgo_bulk_100000", "the fibres are too soft"},
                                             {"F10_pad8_1", "single element between"},
                                             {"F10_pad16_4", ""}};
  for (const auto& [name, warning] : scenes) {
    SCOPED_TRACE(name);
    const std::vector<std::string> warnings = warningsOf(loadProblem(numerics / (name + ".toml")));
    if (std::string(warning).empty())
      EXPECT_THAT(warnings, IsEmpty());
    else
      EXPECT_THAT(warnings, ElementsAre(HasSubstr(warning)));
  }
}

TEST_F(ProblemWarnings, NameElementsThatViolateInfSup) {
  scene.discretization.pressure = PressureSpace::p1;
  EXPECT_THAT(warnings(), ElementsAre(HasSubstr("inf-sup")));
  scene.discretization = {DisplacementSpace::p2, PressureSpace::p2};
  EXPECT_THAT(
      warnings(),
      ElementsAre(HasSubstr("pressure = \"P2\" with P2 displacement violates the inf-sup")));
  scene.discretization.pressure = PressureSpace::p1;
  EXPECT_THAT(warnings(), IsEmpty());
}

TEST_F(ProblemWarnings, ReportAnActiveNodeFarFromItsRequestedPosition) {
  near = {0.2, 0, 0.02};
  EXPECT_THAT(warnings(), ElementsAre(AllOf(HasSubstr("near = (0.2, 0, 0.02)"),
                                            HasSubstr("more than an edge"))));
}

TEST_F(ProblemWarnings, ReportAWorkspaceThatStretchesTheTissueTooFar) {
  scene.workspace.radius = 0.24;
  near = {0.1, 0, 0.02};
  EXPECT_THAT(warnings(), IsEmpty());
  near = {-0.05, 0, 0.06};
  patch_radius = 0.03;
  EXPECT_THAT(warnings(), ElementsAre(HasSubstr("single element between"),
                                      AllOf(HasSubstr("workspace.radius = 0.24 m"),
                                            HasSubstr("times its length"))));
  scene.workspace.radius = 0.5;
  EXPECT_THAT(warnings(),
              ElementsAre(HasSubstr("single element between"), HasSubstr("body's diagonal")));
}

TEST_F(ProblemWarnings, ReportToolsOnSingleNodes) {
  patch_radius = 0;
  EXPECT_THAT(warnings(), ElementsAre(HasSubstr("single node (radius = 0)")));
  patch_radius = 1e-4;
  EXPECT_THAT(warnings(), ElementsAre(HasSubstr("no other node")));
}

/// A plate 5 mm thick and 10 cm wide, touched by a finger.
TEST(FingerWarnings, ReportFingersThatAreTooSmallOrReachAroundALobe) {
  Scene scene = test::mooneyRivlinScene();
  scene.fixed.groups = {"xmin"};
  scene.workspace.radius = 0.02;
  scene.workspace.spacing = 0.01;
  scene.active = {{.name = "skin",
                   .radius = 0.02,
                   .tool = ToolKind::finger,
                   .surface = SurfaceSelection{.groups = {"zmax"}}}};
  const auto on = [&](const Mesh& mesh) { return warningsOf(resolve(scene, mesh)); };
  EXPECT_THAT(on(test::cubeMesh(0.1, 10)), IsEmpty()) << "neighbouring fingers are not duplicates";
  EXPECT_THAT(on(test::boxMesh({0.1, 0.1, 0.005}, {20, 20, 1})),
              ElementsAre(AllOf(HasSubstr("skin-"), HasSubstr("thin lobe"))));
  EXPECT_THAT(on(test::cubeMesh(0.1, 3)),
              ElementsAre(AllOf(HasSubstr("radius 0.02 m"), HasSubstr("smaller than an edge"))));
}

TEST_F(ProblemWarnings, ReportNearlyFlatElements) {
  mesh = test::cubeMesh(0.1, 2);
  mesh.nodes[13][2] += 0.049;  // the middle node, almost to the top
  patch_radius = 0.06;
  EXPECT_THAT(warnings(), ElementsAre(HasSubstr("nearly flat")));
}

}  // namespace
}  // namespace palpate
