#include "common/mesh/self_intersections.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

#include "common/mesh/mesh_reader.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/reference_data.hpp"
#include "tests/verification/meshes.hpp"

namespace palpate {
namespace {

using test::expectBadInput;
using test::moved;
using test::together;
using test::welded;

std::int64_t cutsIn(const Mesh& mesh) {
  return selfIntersectionsOf(mesh.nodes, mesh.surface).count;
}

Mesh box(int cells = 2) { return test::cubeMesh(1, cells); }

/// The box with the other diagonals on its two sides across x.
Mesh mirroredBox(int cells = 2) {
  Mesh mesh = box(cells);
  for (Eigen::Vector3d& node : mesh.nodes) node[1] = 1 - node[1];
  for (Tetrahedron& t : mesh.tetrahedra) std::swap(t[2], t[3]);
  finishMesh(mesh, "a mirrored box");
  return mesh;
}

TEST(SelfIntersections, DoNotOccurInSoundSurfaces) {
  for (const Mesh& mesh : {test::blobMesh(), verification::sphereOctantMesh(0.05, 0.07, 4),
                           verification::quarterTubeMesh(1, 2, 0.5, 4)})
    EXPECT_EQ(cutsIn(mesh), 0);
}

TEST(SelfIntersections, DoNotOccurWhereRoundingBendsFlatSides) {
  std::mt19937 random(5);
  std::normal_distribution<double> number;
  for (int turn = 0; turn < 50; ++turn) {
    Mesh mesh = test::distortedBoxMesh({1, 2, 3}, {4, 4, 4});
    Eigen::Vector4d rotation;
    for (double& x : rotation) x = number(random);
    const Eigen::Matrix3d turned = Eigen::Quaterniond(rotation.normalized()).toRotationMatrix();
    for (Eigen::Vector3d& node : mesh.nodes)
      node = turned * node + turn * turn * Eigen::Vector3d(1, -1, 1);
    EXPECT_EQ(cutsIn(mesh), 0) << "random rotation " << turn;
  }
}

TEST(SelfIntersections, AreFoundWhereverTwoBoxesMeet) {
  const auto cuts = [](const Eigen::Vector3d& offset) {
    return cutsIn(together(box(), moved(box(), offset)));
  };
  EXPECT_GT(cuts({0.5, 0.5, 0.5}), 0) << "corners on corners of the grid";
  EXPECT_GT(cuts({0.31, 0.27, 0.43}), 0);
  EXPECT_GT(cuts({0.4, 0, 0}), 0) << "sides in one plane";
  EXPECT_GT(cuts({1, 0.2, 0.1}), 0) << "touching";
  EXPECT_EQ(cuts({1.001, 0, 0}), 0);
}

TEST(SelfIntersections, AreFoundBesideASharedCornerAndAFoldedEdge) {
  const std::vector<Eigen::Vector3d> points = {{0, 0, 0},   {1, 0, 0},      {0, 1, 0},
                                               {1, 1, 1},   {0.3, 0.3, -1}, {0.2, 0.2, 0},
                                               {1, 0.5, 0}, {0.5, 1, 0}};
  EXPECT_EQ(selfIntersectionsOf(points, {{0, 1, 2}, {0, 3, 4}}).count, 1) << "through the inside";
  EXPECT_EQ(selfIntersectionsOf(points, {{0, 1, 2}, {0, 6, 7}}).count, 1)
      << "over each other in a plane";
  EXPECT_EQ(selfIntersectionsOf(points, {{0, 1, 2}, {0, 1, 5}}).count, 1) << "folded";
  EXPECT_EQ(selfIntersectionsOf(points, {{0, 1, 2}, {1, 3, 2}}).count, 0);
  EXPECT_EQ(selfIntersectionsOf(points, {{0, 1, 2}, {1, 3, 2}}).first[0], -1);
  EXPECT_EQ(selfIntersectionsOf({{0, 0, 0}, {2, 2, 0}, {3, 1, 0}, {4, 4, 0}, {1, 1, 0}},
                                {{0, 1, 2}, {3, 2, 4}})
                .count,
            1)
      << "with a corner on an edge";
}

TEST(Overlaps, NonMatchingFacesAreRefusedWithTheirPosition) {
  const auto refused = [](const Mesh& mesh, const std::string& place = "at (") {
    expectBadInput([&] { refuseOverlaps(mesh, "m.msh"); }, {"m.msh: ", "overlap", place});
  };
  const Eigen::Vector3d beside(1, 0, 0);
  refused(together(box(), moved(mirroredBox(), beside)), "at (1, ");
  refused(welded(together(box(), moved(mirroredBox(), beside))), "at (1, ");
  refused(together(box(1), moved(box(2), beside)));
  refused(welded(together(box(1), moved(box(2), beside))));
  refused(together(box(2), moved(box(3), beside)));
}

TEST(Overlaps, InterpenetratingPartsAreRefused) {
  for (const Eigen::Vector3d& by : {Eigen::Vector3d(0.9, 0.03, 0.02), {0.31, 0.27, 0.43}})
    expectBadInput([&] { refuseOverlaps(together(box(), moved(box(), by)), "m.msh"); },
                   {"m.msh: ", "overlap"});
}

TEST(Overlaps, MatchingAndWeldedFacesAreAccepted) {
  const Mesh layers = together(box(), moved(box(), {1, 0, 0}));
  EXPECT_NO_THROW(refuseOverlaps(layers, "a cut through the body"));
  EXPECT_NO_THROW(refuseOverlaps(welded(layers), "welded"));
  EXPECT_NO_THROW(refuseOverlaps(together(box(), moved(box(), {1 + 1e-9, 1e-9, 0})), "rounded"));
  EXPECT_NO_THROW(refuseOverlaps(together(box(), moved(box(), {1, 1, 0})), "one edge"));
}

TEST(Overlaps, AreFoundInReportedMeshesAndNotInTheirSoundTwins) {
  PALPATE_REFERENCE_FILE(reports, "cases/reports");
  for (const char* name : {"k03_crossed.msh", "k03_crossed27.msh"})
    expectBadInput([&] { readGmsh(reports / name); }, {name, "overlap"});
  for (const char* name : {"k01_layers.msh", "k01_welded.msh", "k03_alike.msh", "k03_alike27.msh"})
    EXPECT_NO_THROW(readGmsh(reports / name));
  for (const char* name : {"cases/flap.msh", "cases/dome.msh", "meshes/liver-5984.msh"})
    EXPECT_NO_THROW(readGmsh(test::referenceData(name)));
}

}  // namespace
}  // namespace palpate
