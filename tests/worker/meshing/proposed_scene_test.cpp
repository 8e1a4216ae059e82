#include "worker/meshing/proposed_scene.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/mesh/mesh_reader.hpp"
#include "common/problem/problem.hpp"
#include "common/problem/problem_warnings.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/meshes.hpp"
#include "worker/meshing/guessed_unit.hpp"

namespace palpate {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

const LengthUnit& unit(const std::string& word) {
  return *std::ranges::find(length_units, word, &LengthUnit::word);
}

Scene sceneOf(const Mesh& mesh, const std::string& word = "m") {
  return parseScene(proposedScene(mesh, "organ", "organ.msh", {unit(word)}).toml, "scene.toml");
}

TEST(GuessedUnit, FollowsTheSizeOfTheBodyAndNamesAlternatives) {
  const auto word = [](double extent) { return guessedUnit(extent).value().unit.word; };
  const auto doubt = [](double extent) { return guessedUnit(extent).value().doubt; };
  EXPECT_EQ(word(0.21), "m");
  EXPECT_THAT(doubt(0.21), IsEmpty());
  EXPECT_EQ(word(0.004), "m");
  EXPECT_THAT(doubt(0.004), HasSubstr("0.4 cm wide"));
  EXPECT_EQ(word(21), "cm");
  EXPECT_THAT(doubt(21), HasSubstr("2.1 cm wide in millimetres"));
  EXPECT_THAT(doubt(1.2), HasSubstr("0.12 cm wide in millimetres, or 120 cm wide in metres"));
  EXPECT_EQ(word(60), "mm");
  EXPECT_THAT(doubt(60), HasSubstr("60 cm wide in centimetres"));
  EXPECT_EQ(word(210), "mm");
  EXPECT_THAT(doubt(210), IsEmpty());
  EXPECT_THAT(doubt(4000), HasSubstr("400 cm wide"));
  for (const double extent : {0.0, 1e-4, 2e4, std::nan("")})
    EXPECT_FALSE(guessedUnit(extent)) << extent;
}

TEST(GuessedUnit, RefusesUnknownUnits) {
  EXPECT_EQ(unitNamed("cm").metres, 0.01);
  test::expectBadInput([] { unitNamed("inch"); }, {"--unit inch", "m, cm or mm"});
}

TEST(ProposedScene, FixesAGroupOnlyIfItsNameAndShapeAllow) {
  Mesh mesh = test::boxMesh({0.1, 0.06, 0.04}, {8, 5, 4});
  const auto fixed = [&] {
    return proposedScene(mesh, "organ", "organ.msh", {unit("m")}).choices.front();
  };
  const NodeSet side = mesh.node_groups.at("xmin");
  mesh.node_groups.clear();
  for (const char* name : {"prefix", "background", "database"}) mesh.node_groups[name] = side;
  NodeSet line;
  for (const std::int32_t node : side)
    if (mesh.nodes[node][2] == 0) line.push_back(node);
  mesh.node_groups["fixed edge"] = line;
  EXPECT_THAT(fixed(), HasSubstr("15 % along x"));
  for (const char* name : {"bcFixed", "BC_FIXED", "base plate", "fixation2"}) {
    mesh.node_groups[name] = side;
    EXPECT_THAT(fixed(), HasSubstr(name));
    mesh.node_groups.erase(name);
  }
}

TEST(ProposedScene, HasNoWarningsForBodiesOfManyShapesAndSizes) {
  for (const auto& [name, mesh] :
       {std::pair("box", test::boxMesh({0.1, 0.06, 0.04}, {8, 5, 4})),
        std::pair("blob", test::blobMesh(6)), std::pair("pea", test::cubeMesh(0.012, 5)),
        std::pair("torso", test::boxMesh({0.6, 0.3, 0.2}, {12, 6, 4}))}) {
    SCOPED_TRACE(name);
    const ProposedScene proposed = proposedScene(mesh, "organ", "organ.msh", {unit("m")});
    EXPECT_THAT(proposed.warnings, IsEmpty());
    const Problem problem = resolve(parseScene(proposed.toml, "scene.toml"), mesh);
    EXPECT_THAT(warningsOf(problem), IsEmpty());
    EXPECT_GT(problem.active.size(), 10u);
  }
}

TEST(ProposedScene, IsTheSameInEveryUnit) {
  const Mesh mesh = test::blobMesh(6);
  const Scene metres = sceneOf(mesh);
  EXPECT_EQ(metres.name, "organ");
  EXPECT_EQ(metres.mesh, "organ.msh");
  for (const char* word : {"cm", "mm"}) {
    const Scene scene = sceneOf(mesh, word);
    EXPECT_NEAR(scene.active.at(0).radius, metres.active.at(0).radius, 1e-9);
    EXPECT_NEAR(scene.workspace.radius, metres.workspace.radius, 1e-9);
    EXPECT_NEAR(scene.workspace.spacing, metres.workspace.spacing, 1e-9);
  }
}

TEST(ProposedScene, FixesTheGroupWhoseNameSaysSo) {
  Mesh mesh = test::blobMesh(6);
  mesh.node_groups["Fixed nodes"] = mesh.node_groups.at("zmin");
  mesh.node_groups["base"] = mesh.node_groups.at("xmin");
  EXPECT_EQ(sceneOf(mesh).fixed.groups, std::vector<std::string>{"Fixed nodes"});
  mesh.node_groups["Fixed nodes"].resize(2);
  EXPECT_EQ(sceneOf(mesh).fixed.groups, std::vector<std::string>{"base"}) << "two hold nothing";
  mesh.node_groups["base"] = surfaceNodes(mesh);
  EXPECT_THAT(sceneOf(mesh).fixed.groups, IsEmpty()) << "the whole surface is not a base";
}

TEST(ProposedScene, FixesTheBroaderEndOfTheLongestAxis) {
  Mesh mesh = test::boxMesh({0.04, 0.1, 0.04}, {4, 10, 4});
  HalfSpace fixed = sceneOf(mesh).fixed.half_spaces.at(0);
  EXPECT_EQ(fixed.axis, 1);
  EXPECT_TRUE(fixed.below) << "both alike";
  for (Eigen::Vector3d& node : mesh.nodes) node[0] *= 1 + 4 * node[1];
  finishMesh(mesh, "a box made in code");
  fixed = sceneOf(mesh).fixed.half_spaces.at(0);
  EXPECT_FALSE(fixed.below);
  EXPECT_EQ(fixed.fraction, 0.15);
}

TEST(ProposedScene, ReportsUncertaintiesAndComponents) {
  Mesh mesh = test::blobMesh(6);
  mesh.element_groups = {{"liver", {0, 1, 2}}, {"tumour", {3}}};
  const std::string toml =
      proposedScene(mesh, "organ", "organ.msh", {unit("cm"), "20 cm wide, and more"}).toml;
  EXPECT_THAT(toml, HasSubstr("<- check this: 20 cm wide, and more"));
  EXPECT_THAT(toml, HasSubstr("[[region]] group = \"tumour\"  (1 of"));
}

TEST(ProposedScene, RefusesAMeshWithoutAPossibleScene) {
  Mesh two = test::cubeMesh(0.1, 3);
  const Mesh other = two;
  const auto first = static_cast<std::int32_t>(two.nodes.size());
  for (const Eigen::Vector3d& node : other.nodes)
    two.nodes.emplace_back(node + Eigen::Vector3d(0.3, 0, 0));
  for (const Tetrahedron& t : other.tetrahedra)
    two.tetrahedra.push_back({t[0] + first, t[1] + first, t[2] + first, t[3] + first});
  finishMesh(two, "two boxes");
  test::expectBadInput([&] { sceneOf(two); }, {"2 pieces that share no face", "no fixed node"});
}

}  // namespace
}  // namespace palpate
