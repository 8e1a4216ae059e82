#include "common/problem/problem.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numeric>

#include "common/mesh/node_set.hpp"
#include "common/problem/problem_warnings.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/reference_data.hpp"
#include "tests/support/temporary_directory.hpp"

namespace palpate {
namespace {

using test::expectBadInput;
using test::expectError;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

/// A 0.2 m cube of 4^3 cells (125 nodes, node spacing 0.05 m), fixed below, touched in the middle
/// of the top.
class Problem : public ::testing::Test {
 protected:
  Problem() {
    scene.name = "cube";
    scene.mesh = "cube.msh";
    scene.regions[0].material.c10 = 1300;
    scene.regions[0].material.c01 = 1280;
    scene.fixed.half_spaces = {{2, true, 0.1, std::nullopt}};
    scene.active = {{"top", Eigen::Vector3d(0.1, 0.1, 0.21), std::nullopt, 0}};
  }

  palpate::Problem resolved() const { return resolve(scene, mesh); }
  void refuses(std::initializer_list<std::string> words) const {
    expectBadInput([this] { resolved(); }, words);
  }

  static constexpr std::int32_t top = 2 + 5 * (2 + 5 * 4), center = 2 + 5 * (2 + 5 * 2);
  Scene scene;
  Mesh mesh = test::cubeMesh(0.2, 4);
};

TEST_F(Problem, FindsTheNearestSurfaceNodeAndTheFixedNodes) {
  const palpate::Problem problem = resolved();
  EXPECT_EQ(problem.fixed, mesh.node_groups.at("zmin"));
  ASSERT_THAT(problem.active, SizeIs(1));
  EXPECT_EQ(problem.active[0].node, top);
  EXPECT_THAT(problem.active[0].nodes, ElementsAre(top));
}

TEST_F(Problem, IncludesANodeExactlyAtThePatchRadius) {
  scene.active[0].radius = 0.05;
  EXPECT_THAT(resolved().active[0].nodes,
              ElementsAre(top - 25, top - 5, top - 1, top, top + 1, top + 5));
}

TEST_F(Problem, LeavesFixedNodesOutOfAPatch) {
  scene.active[0] = {"side", std::nullopt, 2 + 25, 0.05};
  const ActivePatch patch = resolved().active[0];
  EXPECT_THAT(patch.nodes, ElementsAre(26, 27, 28, 32, 52));
}

TEST_F(Problem, UnitesAllSelectors) {
  scene.fixed = {};
  scene.fixed.half_spaces = {{0, false, std::nullopt, 0.19}};
  scene.fixed.boxes = {{{0, 0, 0}, {0.05, 0, 0}}};
  scene.fixed.spheres = {{{0, 0.2, 0}, 0.05}};
  scene.fixed.groups = {"xmax"};
  scene.fixed.nodes = {10, 10};
  std::vector<std::int32_t> expected = mesh.node_groups.at("xmax");
  for (const int node : {0, 1, 20, 21, 15, 45, 10}) expected.push_back(node);
  std::sort(expected.begin(), expected.end());
  EXPECT_EQ(resolved().fixed, expected);
}

TEST_F(Problem, FixesTheLowestPlaneByTheSmallestFraction) {
  scene.fixed.half_spaces[0].fraction = 1e-9;
  EXPECT_EQ(resolved().fixed, mesh.node_groups.at("zmin"));
}

TEST_F(Problem, MakesEveryMovableNodeOfASurfaceActive) {
  scene.active = {{.name = "skin", .radius = 0.05, .surface = SurfaceSelection{.all = true}}};
  const palpate::Problem problem = resolved();
  const NodeSet surface = surfaceNodes(mesh);
  ASSERT_EQ(problem.active.size(), surface.size() - mesh.node_groups.at("zmin").size());
  ASSERT_EQ(problem.scene.active.size(), problem.active.size());
  for (std::size_t i = 0; i < problem.active.size(); ++i) {
    const ActivePatch& patch = problem.active[i];
    EXPECT_EQ(patch.name, fmt::format("skin-{}", patch.node));
    EXPECT_TRUE(contains(surface, patch.node) && !contains(problem.fixed, patch.node));
    EXPECT_EQ(problem.scene.active[i],
              (ActiveSelection{.name = patch.name, .node = patch.node, .radius = 0.05}));
    if (patch.node == top) {
      EXPECT_THAT(patch.nodes, SizeIs(6));
    }
  }
  EXPECT_EQ(problemId(decodeProblem(encodeProblem(problem))), problemId(problem));
}

TEST_F(Problem, UnitesTheSelectorsOfASurface) {
  SurfaceSelection surface;
  surface.boxes = {{{0, 0, 0.2}, {0.05, 0, 0.2}}};
  surface.spheres = {{{0.1, 0.1, 0.2}, 0.05}};
  surface.groups = {"xmax"};
  scene.active = {{.name = "some", .surface = surface}, {.name = "one", .node = top}};
  NodeSet expected = {100, 101, top, top - 1, top + 1, top - 5, top + 5};
  for (const std::int32_t node : mesh.node_groups.at("xmax"))
    if (node >= 25) expected.push_back(node);  // the lowest layer is fixed
  sortUnique(expected);
  NodeSet found;
  const palpate::Problem problem = resolved();
  for (const ActivePatch& patch : problem.active)
    if (patch.name != "one") found.push_back(patch.node);
  EXPECT_EQ(found, expected);
  EXPECT_EQ(problem.active.back().name, "one");
}

TEST_F(Problem, RefusesSurfacesWithNothingToTouch) {
  const auto refusesSurface = [&](SurfaceSelection surface,
                                  std::initializer_list<std::string> words) {
    scene.active = {{.name = "skin", .surface = std::move(surface)}};
    refuses(words);
  };
  refusesSurface({.spheres = {{{0.1, 0.1, 0.1}, 0.02}}}, {"active \"skin\": surface.sphere"});
  refusesSurface({.boxes = {{{1, 1, 1}, {2, 2, 2}}}}, {"active \"skin\": surface.box"});
  refusesSurface({.groups = {"xmx"}}, {"active \"skin\": surface.group", "\"xmx\"", "xmax"});
  refusesSurface({.groups = {"zmin"}}, {"active \"skin\": surface", "25 nodes", "fixed"});
  scene.active = {{.name = "skin", .surface = SurfaceSelection{.all = true}},
                  {.name = fmt::format("skin-{}", top), .node = 30}};
  refuses({"two active nodes", fmt::format("\"skin-{}\"", top)});
}

TEST_F(Problem, RefusesAGroupOfAMeshWithoutAny) {
  scene.fixed.groups = {"basis"};
  mesh.node_groups.clear();
  refuses({"\"basis\"", "no physical groups"});
}

TEST_F(Problem, RefusesAnActiveNodeInsideTheBody) {
  scene.active[0] = {"deep", std::nullopt, center, 0};
  refuses({"active \"deep\"", "inside the body", "nearest surface node"});
}

/// The patch surrounds the fixed nodes below it.
TEST_F(Problem, RefusesAPatchThatLeavesNoFreedomToKeepAVolume) {
  scene.active[0].near = Eigen::Vector3d(0, 0.1, 0.05);
  scene.active[0].radius = 0.08;
  for (const DisplacementSpace displacement : {DisplacementSpace::p1, DisplacementSpace::p2}) {
    scene.discretization.displacement = displacement;
    scene.discretization.pressure = PressureSpace::p1;
    refuses({"active \"top\"", "cannot keep its volume", "make radius smaller", "bulk"});
    scene.regions[0].material.bulk = 40000;
    EXPECT_NO_THROW(resolved()) << "the volume may change";
    scene.regions[0].material.bulk.reset();
  }
  scene.discretization = {DisplacementSpace::p1, PressureSpace::p1_stabilized};
  EXPECT_NO_THROW(resolved()) << "the stabilisation allows it";
}

TEST_F(Problem, AcceptsAPatchThatCoversWholeElements) {
  scene.discretization = {DisplacementSpace::p2, PressureSpace::p1};
  scene.active[0].radius = 0.09;
  EXPECT_NO_THROW(resolved());
}

TEST_F(Problem, RefusesABodyThatCanRotate) {
  scene.fixed = {};
  scene.fixed.nodes = {0, 1, 4};
  refuses({"on one line", "turn"});
  scene.fixed.nodes = {0, 1, 5};
  EXPECT_NO_THROW(resolved());
}

TEST_F(Problem, RefusesMillimetresTakenForMetresSayingSo) {
  for (Eigen::Vector3d& node : mesh.nodes) node *= 1000;
  refuses({"200 m wide", "millimetres read as metres", "length_unit = \"mm\""});
}

TEST_F(Problem, RefusesAnUnsupportedComponent) {
  const Mesh other = test::cubeMesh(0.1, 1);
  for (const Tetrahedron& t : other.tetrahedra)
    mesh.tetrahedra.push_back({t[0] + 125, t[1] + 125, t[2] + 125, t[3] + 125});
  for (const Eigen::Vector3d& node : other.nodes)
    mesh.nodes.push_back(node + Eigen::Vector3d(0.5, 0, 0.3));
  finishMesh(mesh, "two pieces");
  refuses({"2 pieces", "8 nodes around node 125", "no fixed node"});
}

TEST_F(Problem, RefusesAComponentAttachedByOneNodeOrEdge) {
  const Mesh other = test::cubeMesh(0.1, 2), body = mesh;
  const auto hang = [&](const Eigen::Vector3d& by) {
    mesh = test::welded(test::together(body, test::moved(other, by)));
  };
  for (const DisplacementSpace space : {DisplacementSpace::p1, DisplacementSpace::p2}) {
    scene.discretization.displacement = space;
    hang({0.2, 0.2, 0.2});
    refuses({"2 pieces", "joined to the others by 1 node", "(0.2, 0.2, 0.2)", "turn"});
    hang({0.2, 0.1, 0.2});
    refuses({"2 pieces", "on one line", "(0.2, 0.1, 0.2)", "turn"});
    hang({0.2, 0.1, 0.1});
    EXPECT_NO_THROW(resolved()) << "joined by faces";
  }
}

TEST_F(Problem, AcceptsAComponentAttachedAtThreeNodes) {
  const Mesh cube = test::cubeMesh(0.1, 1);
  mesh = cube;
  for (const Eigen::Vector3d& by : {Eigen::Vector3d(0.2, 0, 0), {0, 0.2, 0}, {0.1, 0.1, 0.1}})
    mesh = test::together(mesh, test::moved(cube, by));
  mesh = test::welded(mesh);
  EXPECT_THAT(warningsOf(resolved()),
              Contains(HasSubstr("4 pieces of the body meet without a common face in 3 nodes")));
}

TEST_F(Problem, WarnsOfCoincidentNodes) {
  mesh = test::together(mesh, test::moved(mesh, {0.2, 0, 0}));
  EXPECT_THAT(warningsOf(resolved()),
              Contains(AllOf(HasSubstr("coincident nodes: 25"), HasSubstr("node 125"),
                             HasSubstr("(0.2, 0, 0)"), HasSubstr("--weld"))));
}

TEST_F(Problem, RefusesAContrastInWhichForcesWouldBeLost) {
  scene.regions[0].material = {.law = LawName::neo_hookean, .mu = 3000};
  Region bone{"", {.law = LawName::st_venant_kirchhoff, .young = 1e10, .poisson = 0.3}};
  bone.spheres = {{{0.1, 0.1, 0.1}, 0.05}};
  scene.regions.push_back(bone);
  EXPECT_NO_THROW(resolved());
  scene.regions[1].material.young = 1e11;
  refuses({"1e+11 Pa", "1e+07 times", "3e+03 Pa", "nearly rigid"});
}

TEST_F(Problem, RegionsSelectTetrahedraByTheirCentroid) {
  Region lump{"", scene.regions[0].material};
  lump.material.c10 = 9000;
  lump.spheres = {{{0.1, 0.1, 0.1}, 0.05}};
  lump.boxes = {{{0, 0, 0.15}, {0.05, 0.05, 0.2}}};
  scene.regions.push_back(lump);
  const palpate::Problem problem = resolved();
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    const Eigen::Vector3d x = middleOf(mesh, e);
    const bool inside = (x - lump.spheres[0].center).norm() <= 0.05 ||
                        (x[0] <= 0.05 && x[1] <= 0.05 && x[2] >= 0.15);
    EXPECT_EQ(problem.region_of[e], inside ? 1 : 0) << e;
  }
  EXPECT_EQ(decodeProblem(encodeProblem(problem)).scene.regions, problem.scene.regions);
  scene.regions[1].spheres[0].radius = 0.001;
  refuses({"region.sphere", "tetrahedron", "edges are"});
}

TEST_F(Problem, RefusesAWorkspaceMuchLargerThanTheBody) {
  scene.workspace.radius = 1.1;
  refuses({"workspace.radius = 1.1 m", "0.3464 m"});
}

TEST_F(Problem, RefusesALatticeOfTooManyPoints) {
  scene.workspace = {.radius = 0.1, .spacing = 0.0005};
  refuses({"workspace.spacing", "larger spacing"});
}

TEST_F(Problem, SurvivesDamagedBytes) {
  mesh = test::cubeMesh(0.2, 1);
  scene.fixed.half_spaces[0].fraction = 0.5;
  const std::string bytes = encodeProblem(resolved());
  const auto decodesOrRefuses = [](const std::string& damaged) {
    try {
      return encodeProblem(decodeProblem(damaged)) ==
             damaged;  // cut between two node groups, or another number
    } catch (const Error& error) {
      return error.exitCode() == ExitCode::failed;
    }
  };
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    EXPECT_TRUE(decodesOrRefuses(bytes.substr(0, at))) << at;
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x55);
    EXPECT_TRUE(decodesOrRefuses(damaged)) << at;
  }
  expectError(ExitCode::failed, [&] { decodeProblem(bytes.substr(0, bytes.size() / 2)); },
              {"damaged"});
}

TEST_F(Problem, IdIgnoresSettingsThatChangeNoConfiguration) {
  const ContentId id = problemId(resolved());
  scene.name = "other";
  scene.mesh = "/elsewhere/file.msh";
  scene.metres_per_unit = 0.001;
  scene.active[0].near = Eigen::Vector3d(0.11, 0.1, 0.2);
  scene.fixed.half_spaces = {};
  scene.fixed.groups = {"zmin"};
  mesh.node_groups.erase("ymax");
  scene.accuracy.levels = 1;
  scene.device = Device{device_profiles[2]};
  scene.storage = {StoredNodes::all, StoredPrecision::int16};
  scene.contact = ContactMode::glued;
  EXPECT_EQ(problemId(resolved()), id);
}

TEST_F(Problem, IdChangesWithEverythingElse) {
  std::vector<ContentId> ids = {problemId(resolved())};
  const Scene original = scene;
  const auto changed = [&](auto&& change) {
    scene = original;
    change();
    ids.push_back(problemId(resolved()));
  };
  changed([&] { scene.regions[0].material.c10 = 1300.0000000000002; });
  changed([&] { scene.discretization.constraint = Constraint::det_F_minus_1; });
  changed([&] { scene.workspace.max_force = 3; });
  changed([&] { scene.workspace.spacing = 0.01; });
  changed([&] { scene.workspace.reject_inverted = false; });
  changed([&] { scene.accuracy.probes = 10; });
  changed([&] { scene.accuracy.force_error = 0.03; });
  changed([&] { scene.accuracy = {.force_error = 0.03, .levels = 4}; });
  changed([&] { scene.active[0].name = "other"; });
  changed([&] { scene.active[0].radius = 0.05; });
  changed([&] { scene.fixed.nodes = {25}; });
  changed([&] { mesh.nodes[3][1] += 1e-12; });
  std::sort(ids.begin(), ids.end());
  EXPECT_EQ(std::unique(ids.begin(), ids.end()), ids.end());
}

/// The cube with quadratic displacements, its upper half the group "upper".
class QuadraticProblem : public Problem {
 protected:
  QuadraticProblem() {
    scene.discretization = {DisplacementSpace::p2, PressureSpace::p1};
    for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e)
      if (middleOf(mesh, e)[2] > 0.1)
        mesh.element_groups["upper"].push_back(static_cast<std::int32_t>(e));
  }

  /// Every node of the problem that satisfies `inside`.
  template <class Inside>
  static std::vector<std::int32_t> nodesWhere(const palpate::Problem& problem, Inside inside) {
    std::vector<std::int32_t> nodes;
    for (std::size_t n = 0; n < problem.mesh.nodes.size(); ++n)
      if (inside(problem.mesh.nodes[n])) nodes.push_back(static_cast<std::int32_t>(n));
    return nodes;
  }

  void useFibers(const std::string& field = "") {
    Material& material = scene.regions[0].material;
    material = {};
    material.law = LawName::holzapfel_gasser_ogden;
    material.mu = material.k1 = material.k2 = 1;
    if (field.empty())
      material.fibers = {{0, 0, 1}, {0.6, 0, 0.8}};
    else
      material.fiber_field = field;
  }

  void addUpperRegion() {
    scene.regions.push_back({"upper", scene.regions[0].material});
    scene.regions[1].material.density = 99;
  }
};

TEST_F(QuadraticProblem, SelectsMidEdgeNodesByTheirPosition) {
  scene.fixed.half_spaces = {{2, true, std::nullopt, 0.03}};
  scene.active[0].radius = 0.026;
  const palpate::Problem problem = resolved();
  EXPECT_EQ(problem.fixed, nodesWhere(problem, [](auto& x) { return x[2] < 0.03; }));
  EXPECT_EQ(problem.fixed.size(), 2 * 81u);
  EXPECT_EQ(problem.active[0].node, top);
  const Eigen::Vector3d at = mesh.nodes[top];
  EXPECT_EQ(problem.active[0].nodes,
            nodesWhere(problem, [&](auto& x) { return (x - at).norm() <= 0.026; }));
  EXPECT_GT(problem.active[0].nodes.size(), 5u);
  EXPECT_EQ(problem.pressures.count(), 125u);
}

TEST_F(QuadraticProblem, MakesOnlyVerticesOfASurfaceActive) {
  scene.active = {{.name = "skin", .surface = SurfaceSelection{.groups = {"zmax"}}}};
  const palpate::Problem problem = resolved();
  EXPECT_THAT(problem.active, SizeIs(25));
  EXPECT_LT(problem.active.back().node, 125);
}

TEST_F(QuadraticProblem, FixesTheEdgesBetweenListedVertices) {
  scene.fixed = {};
  scene.fixed.nodes = {0, 1, 5, 4};
  const palpate::Problem problem = resolved();
  const std::int32_t x_edge = midEdgeNode(problem.mesh, 0, 1),
                     y_edge = midEdgeNode(problem.mesh, 0, 5);
  std::vector<std::int32_t> expected = {0, 1, 4, 5, x_edge, y_edge};
  if (const std::int32_t diagonal = midEdgeNode(problem.mesh, 1, 5); diagonal >= 0)
    expected.push_back(diagonal);
  std::sort(expected.begin(), expected.end());
  EXPECT_EQ(problem.fixed, expected);
}

TEST_F(QuadraticProblem, CountsOnlyVerticesForTheUser) {
  scene.fixed.nodes = {125};
  refuses({"fixed.nodes", "125", "0 to 124"});
  scene.fixed.nodes = {};
  scene.active[0] = {"top", std::nullopt, 125, 0};
  refuses({"active \"top\"", "125", "0 to 124"});
}

TEST_F(QuadraticProblem, SerializesRegionsFibersAndWeightsBitForBit) {
  useFibers();
  addUpperRegion();
  scene.active[0].radius = 0.08;
  scene.active[0].tool = ToolKind::weighted_average;
  const palpate::Problem problem = resolved();
  const std::string bytes = encodeProblem(problem);
  const palpate::Problem again = decodeProblem(bytes);
  EXPECT_TRUE(encodeProblem(again) == bytes);
  EXPECT_EQ(problemId(again), problemId(problem));
  EXPECT_EQ(again.mesh.nodes, problem.mesh.nodes);
  EXPECT_EQ(again.mesh.surface, problem.mesh.surface);
  EXPECT_EQ(again.mesh.edges, problem.mesh.edges);
  EXPECT_EQ(again.mesh.mid_edge_nodes, problem.mesh.mid_edge_nodes);
  EXPECT_EQ(again.mesh.node_groups, problem.mesh.node_groups);
  EXPECT_EQ(again.fixed, problem.fixed);
  EXPECT_EQ(again.region_of, problem.region_of);
  EXPECT_EQ(again.fibers, problem.fibers);
  EXPECT_EQ(again.active[0].weights, problem.active[0].weights);
  EXPECT_TRUE(again.scene.regions == problem.scene.regions);
}

TEST_F(QuadraticProblem, DamagedRegionsFibersAndWeightsAreRefused) {
  const Material without_fibers = scene.regions[0].material;
  useFibers();
  addUpperRegion();
  scene.active[0].radius = 0.08;
  scene.active[0].tool = ToolKind::weighted_average;
  const auto refused = [&](auto&& damage, std::initializer_list<std::string> words) {
    palpate::Problem problem = resolved();
    damage(problem);
    expectError(
        ExitCode::failed, [&] { decodeProblem(encodeProblem(problem)); }, words);
  };
  refused([](auto& p) { p.region_of[3] = 2; }, {"damaged", "regions"});
  refused([](auto& p) { p.region_of.pop_back(); }, {"damaged", "regions"});
  refused([](auto& p) { p.fibers.pop_back(); }, {"damaged", "fibres for 383 of 384", "need 384"});
  refused(
      [&](auto& p) {
        for (Region& region : p.scene.regions) region.material = without_fibers;
      },
      {"damaged", "fibres for 384 of 384", "need 0"});
  refused([](auto& p) { p.fibers[7][1] *= 1.1; }, {"damaged", "a fibre of length 1.1"});
  refused([](auto& p) { p.active[0].weights[2] += 1e-6; }, {"damaged", "weights"});
  refused([](auto& p) { p.active[0].weights.clear(); }, {"damaged", "0 weights"});
}

TEST_F(QuadraticProblem, IdChangesWithDisplacementGravityRegionsFibersAndTools) {
  std::vector<ContentId> ids;
  const auto add = [&](auto&& change) {
    change();
    ids.push_back(problemId(resolved()));
  };
  useFibers();
  add([] {});
  add([&] { scene.gravity = {0, 0, -9.81}; });
  add([&] { scene.active[0].radius = 0.08; });
  add([&] { scene.active[0].tool = ToolKind::weighted_average; });
  add([&] { scene.active[0].radius = 0.081; });
  add([&] { addUpperRegion(); });
  add([&] { mesh.element_groups["upper"].pop_back(); });
  mesh.element_vectors["grain"].assign(mesh.tetrahedra.size(), {1, 0, 0});
  add([&] { useFibers("grain"); });
  add([&] { mesh.element_vectors["grain"][5] = {0, 1, 0}; });
  add([&] { scene.discretization.pressure = PressureSpace::p2; });
  add([&] { scene.discretization = {DisplacementSpace::p1, PressureSpace::p1}; });
  std::sort(ids.begin(), ids.end());
  EXPECT_EQ(ids.size(), 11u);
  EXPECT_EQ(std::unique(ids.begin(), ids.end()), ids.end());
}

TEST_F(QuadraticProblem, IdIgnoresNamesOfGroupsAndFields) {
  mesh.element_vectors["grain"].assign(mesh.tetrahedra.size(), {1, 0, 0});
  useFibers("grain");
  addUpperRegion();
  const ContentId id = problemId(resolved());
  mesh.element_groups = {{"other", mesh.element_groups.at("upper")}};
  mesh.element_vectors = {{"fibre", mesh.element_vectors.at("grain")}};
  for (Region& region : scene.regions) region.material.fiber_field = "fibre";
  scene.regions[1].group = "other";
  EXPECT_EQ(problemId(resolved()), id);
}

TEST_F(QuadraticProblem, AssignsEveryTetrahedronItsRegion) {
  addUpperRegion();
  const palpate::Problem problem = resolved();
  const std::vector<std::int32_t>& upper = mesh.element_groups.at("upper");
  EXPECT_EQ(upper.size(), 192u);
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e)
    EXPECT_EQ(problem.region_of[e], contains(upper, static_cast<std::int32_t>(e)));
  EXPECT_TRUE(problem.fibers.empty());
}

TEST_F(QuadraticProblem, RefusesRegionsThatAreNotAPartitionOfTheBody) {
  addUpperRegion();
  scene.regions.push_back({"all", scene.regions[0].material});
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e)
    mesh.element_groups["all"].push_back(static_cast<std::int32_t>(e));
  refuses({"is in \"upper\" and in \"all\"", "tetrahedron 192", "centre at"});
  scene.regions = {{"upper", scene.regions[0].material}};
  refuses({"[[region]]", "tetrahedron 0", "centre at", "is in no region", "[material]"});
  mesh.element_groups = {{"upper", {}}};
  refuses({"region.group", "\"upper\" has no tetrahedron"});
  mesh.element_groups.clear();
  refuses({"region.group", "no physical groups of volumes"});
}

TEST_F(QuadraticProblem, TakesFibersFromTheMeshAndNormalisesThem) {
  useFibers("grain");
  addUpperRegion();
  scene.regions[1].material.fiber_field = "";
  scene.regions[1].material.fibers = {{0, 1, 0}};
  std::vector<Eigen::Vector3d>& grain = mesh.element_vectors["grain"];
  grain.assign(mesh.tetrahedra.size(), {0, 3, 4});
  for (const std::int32_t element : mesh.element_groups.at("upper")) grain[element] = {0, 0, 0};
  const palpate::Problem problem = resolved();
  EXPECT_EQ(problem.fibers.at(0)[0], Eigen::Vector3d(0, 0.6, 0.8));
  EXPECT_EQ(problem.fibers.at(0)[1], Eigen::Vector3d(0, 0, 0));
  EXPECT_EQ(problem.fibers.at(mesh.element_groups.at("upper")[0])[0], Eigen::Vector3d(0, 1, 0));
  grain[1] = {0, 0, 0};
  refuses({"material.fiber", "\"grain\" is zero", "tetrahedron 1"});
}

/// The weights of a weighted patch in the middle of the cube's top.
class WeightedPatch : public QuadraticProblem {
 protected:
  WeightedPatch() {
    scene.discretization = {};
    scene.active[0].radius = radius;
    scene.active[0].tool = ToolKind::weighted_average;
  }

  /// The second moment about the axis, from the weights and exactly. The integrals of r^2 (1 -
  /// r^2/R^2)^2 and of (1 - r^2/R^2)^2 over a disk have the ratio R^2 / 4.
  static constexpr double radius = 0.075, exact = radius * radius / 4;
  double momentOn(int cells) {
    mesh = test::cubeMesh(0.2, cells);
    const palpate::Problem problem = resolved();
    const ActivePatch& patch = problem.active[0];
    double moment = 0;
    for (std::size_t i = 0; i < patch.nodes.size(); ++i)
      moment += patch.weights[i] *
                (problem.mesh.nodes[patch.nodes[i]] - mesh.nodes[patch.node]).squaredNorm();
    return moment;
  }
};

TEST_F(WeightedPatch, HoldsTheMovableSurfaceNodesWithinTheRadius) {
  const ActivePatch patch = resolved().active[0];
  EXPECT_THAT(patch.nodes, ElementsAre(top - 6, top - 5, top - 4, top - 1, top, top + 1, top + 4,
                                       top + 5, top + 6))
      << "not the nodes below";
  ASSERT_EQ(patch.weights.size(), 9u);
  EXPECT_NEAR(std::accumulate(patch.weights.begin(), patch.weights.end(), 0.0), 1, 1e-14);
  EXPECT_NEAR(patch.weights[1], patch.weights[7], 1e-14)
      << "the mesh is symmetric under a half turn";
  EXPECT_GT(patch.weights[4], patch.weights[3]);
}

TEST_F(WeightedPatch, LeavesFixedNodesOut) {
  scene.fixed.nodes = {top + 1};
  const ActivePatch patch = resolved().active[0];
  EXPECT_EQ(patch.nodes.size(), 8u);
  EXPECT_FALSE(contains(patch.nodes, top + 1));
  EXPECT_NEAR(std::accumulate(patch.weights.begin(), patch.weights.end(), 0.0), 1, 1e-14);
}

TEST_F(WeightedPatch, RefusesToAverageFewerThanThreeNodes) {
  scene.active[0].radius = 0.04;
  refuses({"active \"top\"", "only 1", "radius of 0.04 m", "edges are", "at least 3"});
}

TEST_F(WeightedPatch, ConvergesToTheBumpAsTheMeshIsRefined) {
  double previous = INFINITY;
  for (const int cells : {4, 8, 16}) {
    const double error = std::abs(momentOn(cells) / exact - 1);
    EXPECT_LT(error, 0.35 * previous) << cells << " cells, error " << error;
    previous = error;
  }
  EXPECT_LT(previous, 0.04);
}

TEST_F(WeightedPatch, ConvergesWithQuadraticShapeFunctionsAndTheirNegativeWeights) {
  scene.discretization = {DisplacementSpace::p2, PressureSpace::p1};
  EXPECT_NEAR(momentOn(8) / exact, 1, 0.03);
  EXPECT_NEAR(momentOn(16) / exact, 1, 0.004);
}

TEST_F(Problem, IsLoadedFromFiles) {
  const test::TemporaryDirectory directory;
  test::writeGmsh41(mesh, directory / "cube.msh");
  std::ofstream(directory / "cube.toml") << resolvedToml(scene);
  EXPECT_EQ(problemId(loadProblem(directory / "cube.toml")), problemId(resolved()));
}

TEST_F(Problem, RefusesAReportedMeshThatHangsByAHinge) {
  PALPATE_REFERENCE_FILE(reports, "cases/reports");
  for (const char* name : {"k04_node.toml", "k04_edge.toml", "k04_dangling.toml"})
    expectBadInput([&] { loadProblem(reports / name); }, {name, "2 pieces", "turn"});
}

TEST_F(Problem, RefusesReportedBodiesThatHangByAnEdge) {
  PALPATE_REFERENCE_FILE(numerics, "cases/numerics");
  for (const char* name :
       {"F5_edge.toml", "F5_edge_finger.toml", "F5_edge_gravity.toml", "F5_edge_linear.toml"})
    expectBadInput([&] { loadProblem(numerics / name); }, {name, "2 pieces", "turn"});
}

TEST_F(Problem, ResolvesTheRealLiver) {
  PALPATE_REFERENCE_FILE(file, "meshes/liver-493.msh");
  scene.mesh = file;
  const test::TemporaryDirectory directory;
  std::filesystem::copy_file(file, directory / "liver-493.msh");
  scene.fixed.half_spaces = {{0, true, 0.15, std::nullopt}};
  scene.active = {{"tip", Eigen::Vector3d(0.0582, 0.1344, 0.0025), std::nullopt, 0.015}};
  std::ofstream(directory / "liver.toml") << resolvedToml(scene);
  const palpate::Problem problem = loadProblem(directory / "liver.toml");
  EXPECT_GT(problem.fixed.size(), 3u);
  EXPECT_LT((problem.mesh.nodes[problem.active[0].node] - *scene.active[0].near).norm(), 0.02);
  EXPECT_EQ(problemId(decodeProblem(encodeProblem(problem))), problemId(problem));
}

}  // namespace
}  // namespace palpate
