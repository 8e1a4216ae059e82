#include "worker/meshing/tetrahedra.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/mesh/mesh_reader.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/shell_script.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/worker/meshing/surfaces.hpp"

namespace palpate {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Key;

class FilledSurface : public ::testing::Test {
 protected:
  Tetrahedra fill(const TriangleSoup& soup, const Fineness& fineness,
                  Mesher mesher = Mesher::gmsh) {
    surface = closedSurface(soup, "organ.stl", Bodies::only);
    return fillWithTetrahedra(surface, fineness, mesher, folder.path(), "organ.stl");
  }
  static double shareOf(double nodes, double wanted) { return std::abs(std::log(nodes / wanted)); }

  test::TemporaryDirectory folder;
  ClosedSurface surface;
};

TEST_F(FilledSurface, HasAboutTheRequestedNodesAndGroupsBodyAndSurface) {
  PALPATE_NEEDS(test::hasProgram("gmsh"), "gmsh");
  for (const TriangleSoup& soup : {test::sphereSurface(50, 8), test::torusSurface(60, 20)}) {
    const Tetrahedra filled = fill(soup, {.nodes = 400});
    EXPECT_LE(shareOf(static_cast<double>(filled.mesh.nodes.size()), 400),
              std::log(1 + near_enough));
    EXPECT_THAT(filled.mesh.element_groups, Contains(Key("body")));
    EXPECT_THAT(filled.mesh.node_groups, Contains(Key("surface")));
    const MeshQuality quality = measure(filled.mesh);
    EXPECT_NEAR(quality.volume / surface.volume, 1, 0.06);
    EXPECT_GT(quality.worst_shape, 0.1);
    EXPECT_EQ(parseGmsh(filled.msh, "again").nodes, filled.mesh.nodes);
  }
}

TEST_F(FilledSurface, KeepsTheEdgesOfABoxAndTheRequestedSize) {
  PALPATE_NEEDS(test::hasProgram("gmsh"), "gmsh");
  const Tetrahedra filled = fill(test::boxSurface({100, 60, 40}, 4), {.size = 15});
  const MeshQuality quality = measure(filled.mesh);
  EXPECT_NEAR(quality.volume, 100 * 60 * 40, 1e-6 * quality.volume);
  EXPECT_NEAR(quality.mean_edge, 15, 4);
  EXPECT_THAT(filled.notes, IsEmpty());
}

TEST_F(FilledSurface, RefusesASizeInAnotherUnit) {
  for (const auto& [size, words] : {std::pair(0.05, "e+09 nodes"), std::pair(500.0, "no element")})
    test::expectBadInput([&] { fill(test::sphereSurface(50, 6), {.size = size}); },
                         {"organ.stl: --size", words, "the body is 100 wide", "unit of the file"});
}

TEST_F(FilledSurface, LeavesCavitiesEmpty) {
  const TriangleSoup soup = test::together(test::sphereSurface(50, 8), test::sphereSurface(20, 6));
  for (const auto& [program, mesher] :
       {std::pair("gmsh", Mesher::gmsh), std::pair("tetgen", Mesher::tetgen)}) {
    SCOPED_TRACE(program);
    PALPATE_NEEDS(test::hasProgram(program), program);
    if (mesher == Mesher::tetgen) PALPATE_NEEDS(test::hasMeshio(), "python3-meshio");
    const Tetrahedra filled = fill(soup, {.nodes = 800}, mesher);
    EXPECT_NEAR(measure(filled.mesh).volume / surface.volume, 1, 0.06);
    for (const Eigen::Vector3d& node : filled.mesh.nodes) EXPECT_GT(node.norm(), 17);
  }
}

TEST_F(FilledSurface, TetgenKeepsTheGivenTriangles) {
  PALPATE_NEEDS(test::hasProgram("tetgen"), "tetgen");
  PALPATE_NEEDS(test::hasMeshio(), "python3-meshio");
  const Tetrahedra filled = fill(test::sphereSurface(50, 5), {.nodes = 300}, Mesher::tetgen);
  EXPECT_NEAR(measure(filled.mesh).volume / surface.volume, 1, 1e-9);
  EXPECT_THAT(filled.mesh.element_groups, Contains(Key("body")));
  EXPECT_THAT(filled.notes, Contains(HasSubstr("filled by tetgen")));
}

TEST_F(FilledSurface, NamesThePackageOfAMissingProgram) {
  const test::FirstInPath nowhere(folder.path(), true);
  for (const Mesher mesher : {Mesher::gmsh, Mesher::tetgen, Mesher::automatic})
    test::expectError(
        ExitCode::failed, [&] { fill(test::sphereSurface(50, 3), {.nodes = 100}, mesher); },
        {"organ.stl", mesher == Mesher::gmsh ? "(Debian: gmsh)" : "(Debian: tetgen)"});
}

TEST_F(FilledSurface, TriesTetgenIfGmshFailsAndQuotesGmsh) {
  PALPATE_NEEDS(test::hasProgram("tetgen"), "tetgen");
  PALPATE_NEEDS(test::hasMeshio(), "python3-meshio");
  const test::FirstInPath ours(folder.path());
  test::writeScript(folder / "gmsh",
                    "echo 'Info    : begins'\n"
                    "echo 'Error   : Wrong topology of boundary mesh'\nexit 1");
  const Tetrahedra filled = fill(test::sphereSurface(50, 5), {.nodes = 300}, Mesher::automatic);
  EXPECT_THAT(filled.notes, Contains(HasSubstr("Wrong topology of boundary mesh")));
  EXPECT_THAT(filled.notes, Contains(HasSubstr("filled by tetgen")));
  test::expectError(ExitCode::failed,
                    [&] { fill(test::sphereSurface(50, 5), {.nodes = 300}, Mesher::gmsh); },
                    {"organ.stl: cannot fill", "Wrong topology", "--mesher"});
}

TEST_F(FilledSurface, TriesTetgenIfGmshCrashesAndKeepsAnEarlierMesh) {
  PALPATE_NEEDS(test::hasProgram("gmsh"), "gmsh");
  PALPATE_NEEDS(test::hasProgram("tetgen"), "tetgen");
  PALPATE_NEEDS(test::hasMeshio(), "python3-meshio");
  const test::FirstInPath ours(folder.path());
  test::writeScript(folder / "gmsh", "kill -SEGV $$");
  const Tetrahedra filled = fill(test::sphereSurface(50, 5), {.nodes = 300}, Mesher::automatic);
  EXPECT_THAT(filled.notes, Contains(HasSubstr("gmsh was killed by signal 11")));
  EXPECT_THAT(filled.notes, Contains(HasSubstr("filled by tetgen")));
  // The first edge length gives too many nodes, and gmsh crashes in the run with the second one.
  test::writeScript(folder / "gmsh", "[ -e \"$0.ran\" ] && kill -SEGV $$\ntouch \"$0.ran\"\nPATH=" +
                                         ours.before + " exec gmsh \"$@\"");
  const Tetrahedra first = fill(test::boxSurface({100, 10, 10}, 10), {.nodes = 60});
  EXPECT_GT(first.mesh.nodes.size(), 60u);
}

TEST_F(FilledSurface, KeepsItsVolumeIfDetailsNeedMoreNodes) {
  test::writeGmsh22(test::boxMesh({100, 60, 40}, {10, 6, 4}), folder / "first.msh");
  test::writeGmsh22(test::boxMesh({100, 60, 36}, {4, 3, 2}), folder / "next.msh");
  const std::string at = folder.path().string();
  const test::FirstInPath ours(folder.path());
  test::writeScript(folder / "gmsh",
                    "for made in \"$@\"; do case $made in */body.msh) break;; esac; done\ncp " +
                        at + "/first.msh \"$made\" && cp " + at + "/next.msh " + at + "/first.msh");
  const Tetrahedra filled = fill(test::boxSurface({100, 60, 40}), {.nodes = 100});
  EXPECT_NEAR(measure(filled.mesh).volume, 100 * 60 * 40, 1);
  EXPECT_THAT(filled.notes, Contains(HasSubstr("100 nodes were requested")));
}

TEST_F(FilledSurface, DoesNotDependOnTheUsersGmshSettings) {
  PALPATE_NEEDS(test::hasProgram("gmsh"), "gmsh");
  const char* home = std::getenv("HOME");
  const std::string before = home != nullptr ? home : "";
  const auto nodes = [&] {
    return fill(test::sphereSurface(50, 5), {.size = 20}).mesh.nodes.size();
  };
  const std::size_t wanted = nodes();
  const test::TemporaryDirectory user;
  std::ofstream(user / ".gmshrc") << "Mesh.MeshSizeFactor = 0.5;\nMesh.ElementOrder = 2;\n";
  setenv("HOME", user.path().c_str(), 1);
  EXPECT_EQ(nodes(), wanted);
  setenv("HOME", before.c_str(), 1);
}

TEST(EdgeLength, GivesTheRequestedNumberOfNodes) {
  EXPECT_GT(edgeFor(1, 6, 100), edgeFor(1, 6, 1000));
  const double h = edgeFor(1, 6, 1e9);
  EXPECT_NEAR(std::numbers::sqrt2 / (h * h * h) / 1e9, 1, 0.01) << "nearly all nodes are inside";
}

}  // namespace
}  // namespace palpate
