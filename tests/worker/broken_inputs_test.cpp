#include <gtest/gtest.h>

#include <functional>

#include "common/mesh/mesh_reader.hpp"
#include "common/problem/problem.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/file_bytes.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/worker/meshing/surfaces.hpp"
#include "worker/meshing/mesh_conversion.hpp"

// Typical mistakes in scenes and meshes: each error says where, what is wrong and what to do.

namespace palpate {
namespace {

/// Expects an error of one sentence that contains all of these.
void expectSentence(const std::function<void()>& action, std::initializer_list<std::string> words) {
  test::expectBadInput(
      [&] {
        try {
          action();
        } catch (const Error& error) {
          EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << "one sentence";
          throw;
        }
      },
      words);
}

constexpr const char* sound_scene = R"(mesh = "cube.msh"
[material]
law = "mooney-rivlin"
c10 = 1300
c01 = 1280
[fixed]
group = "xmin"
[[active]]
name = "tip"
near = [0.1, 0.05, 0.05]
radius = 0.02
[workspace]
radius = 0.05
spacing = 0.025
)";

const std::string whole_material = "law = \"mooney-rivlin\"\nc10 = 1300\nc01 = 1280";

/// A scene on a cube of 0.1 m, with its other files.
struct BrokenScene : testing::Test {
  BrokenScene() {
    test::writeGmsh22(test::cubeMesh(0.1, 3), directory / "cube.msh");
    test::putInto(directory / "binary.msh", "$MeshFormat\n2.2 1 8\n");
    for (const char* other : {"cube.vtu", "cube.stl"}) test::putInto(directory / other, "solid");
  }
  /// The valid scene with `what` replaced is refused.
  void refuses(const std::string& what, const std::string& instead,
               std::initializer_list<std::string> words) const {
    SCOPED_TRACE(instead);
    std::string text = sound_scene;
    const std::size_t at = text.find(what);
    ASSERT_NE(at, std::string::npos) << what;
    test::putInto(directory / "scene.toml", text.replace(at, what.size(), instead));
    expectSentence([&] { loadProblem(directory / "scene.toml"); }, words);
  }
  const test::TemporaryDirectory directory;
};

TEST_F(BrokenScene, IsRefusedWithFileLineKeyAndRemedy) {
  test::putInto(directory / "scene.toml", sound_scene);
  EXPECT_NO_THROW(loadProblem(directory / "scene.toml"));
  // The mesh file.
  refuses("cube.msh", "none.msh", {"scene.toml:1: mesh = ", "none.msh", "there is no such file"});
  refuses("cube.msh", "cube.vtu",
          {"scene.toml:1: mesh", "palpate mesh ", "cube.vtu -o ", "cube.msh"});
  refuses("cube.msh", "cube.stl",
          {"scene.toml:1: mesh", "palpate mesh ", "cube.stl -o ", "cube.msh"});
  refuses("cube.msh", "binary.msh", {"binary.msh:2", "binary", "palpate mesh ", "-o NEW.msh"});
  refuses("cube.msh", "meshes/", {"scene.toml:1: mesh", "is a folder"});
  refuses("mesh = \"cube.msh\"", "", {"scene.toml:1", "\"mesh\" is missing"});
  refuses("[material]", "length_unit = \"mm\"\n[material]",
          {"scene.toml:1: the mesh is only 0.0001 m wide", "Write length_unit = \"m\""});
  refuses("[material]", "length_unit = \"inch\"\n[material]",
          {"scene.toml:2: length_unit", "m, cm or mm"});
  // Fixed nodes.
  refuses("[fixed]\ngroup = \"xmin\"\n", "",
          {"scene.toml:1: \"fixed\" is missing", "a [fixed] table"});
  refuses("group = \"xmin\"", "",
          {"scene.toml:6: [fixed] selects no node", "nothing holds the body"});
  refuses("\"xmin\"", "\"base\"",
          {"scene.toml:7: fixed.group: there is no \"base\"", "the mesh has body, xmax, xmin"});
  refuses("group = \"xmin\"", "box = { lowest = [1, 1, 1], highest = [2, 2, 2] }",
          {"scene.toml:7: fixed.box selects no node", "from (0, 0, 0) to (0.1, 0.1, 0.1) m"});
  refuses("group = \"xmin\"", "box = { lowest = [-1, -1, -1], highest = [2, 2, 2] }",
          {"scene.toml:6: [fixed] selects all 64 nodes", "nothing is left to move"});
  refuses("group = \"xmin\"", "nodes = [0]",
          {"scene.toml:6: [fixed] holds 1 node on one line", "fix at least three nodes"});
  refuses("group = \"xmin\"", "nodes = [64]",
          {"scene.toml:7: fixed.nodes: there is no node 64", "nodes 0 to 63"});
  refuses("group = \"xmin\"", "below = { axis = \"x\", fraction = 15 }",
          {"scene.toml:7: fixed.below.fraction", "at most 1"});
  refuses("group = \"xmin\"", "group = \"xmin\"\nabove.axis = \"x\"\nabove.at = 1",
          {"scene.toml:8: fixed.above selects no node", "from (0, 0, 0) to (0.1, 0.1, 0.1) m"});
  refuses("group = \"xmin\"", "sphere = { center = [0, 0, 0] }",
          {"scene.toml:7", "fixed.sphere.radius", "missing"});
  // Active nodes.
  refuses(
      "[0.1, 0.05, 0.05]", "[0.0, 0.05, 0.05]",
      {"scene.toml:9: active \"tip\": node", "one of the 16 fixed nodes", "move it, or fix fewer"});
  refuses("[workspace]", "[[active]]\nnode = 640\nname = 'side'\n[workspace]",
          {"scene.toml:14: active \"side\": there is no node 640", "nodes 0 to 63"});
  refuses("[0.1, 0.05, 0.05]", "[100, 50, 50]",
          {"scene.toml:9: active \"tip\"", "122.3 m away", "length_unit"});
  refuses("near = [0.1, 0.05, 0.05]", "node = 640",
          {"scene.toml:9: active \"tip\": there is no node 640", "nodes 0 to 63"});
  refuses("near = [0.1, 0.05, 0.05]\n", "", {"scene.toml:8: active.near", "give one of near"});
  refuses("radius = 0.02", "radius = 0.2",
          {"scene.toml:9: active \"tip\": its patch of 48 nodes", "make radius smaller"});
  refuses("\"tip\"", "\"the tip\"", {"scene.toml:9: active.name", "letters, digits"});
  refuses("radius = 0.02", "tool = \"finger\"", {"scene.toml:11: active.tool", "finger", "radius"});
  refuses("radius = 0.02", "radius = 0.2\ntool = \"finger\"",
          {"scene.toml:9: active \"tip\": a finger of radius 0.2 m", "make radius smaller"});
  refuses("radius = 0.02", "radius = 0.02\ntool = \"hand\"",
          {"scene.toml:12: active.tool", "write rigid, weighted-average or finger"});
  refuses("near = [0.1, 0.05, 0.05]\nradius = 0.02",
          "surface = \"all\"\ntool = \"finger\"\nradius = 0.0002",
          {"scene.toml:12: a finger of radius 0.0002 m", "5000 sites", "make radius larger"});
  // The material.
  refuses("c10", "c1O", {"scene.toml:4: unknown key \"material.c1O\"", "did you mean \"c10\""});
  refuses("[workspace]", "[worksapce]", {"scene.toml:12", "did you mean \"workspace\""});
  refuses("c01 = 1280", "c10 = 1280", {"scene.toml:5: not TOML", "cannot redefine"});
  refuses("c01 = 1280\n", "", {"scene.toml:2: \"material.c01\" is missing", "Pa"});
  refuses("1300", "1300 Pa", {"scene.toml:4: not TOML"});
  refuses(whole_material, "law = \"linear\"\nyoung = 15480\npoisson = 0.5",
          {"scene.toml:5: material.poisson", "modified-st-venant-kirchhoff"});
  refuses(whole_material,
          "law = \"holzapfel-gasser-ogden\"\nmu = 3000\nk1 = 2300\nk2 = 0.8\nfiber = \"direction\"",
          {"scene.toml:7: material.fiber: there are no element vectors \"direction\""});
  refuses("[fixed]", "[gravity]\nacceleration = [0, 0, -9.81]\n[fixed]",
          {"scene.toml:7: gravity.acceleration", "needs a density"});
  refuses("[fixed]",
          "[[region]]\ngroup = \"tumour\"\nlaw = \"linear\"\nyoung = 1e4\npoisson = 0.3\n[fixed]",
          {"scene.toml:7: region.group: there is no volume group \"tumour\"", "the mesh has body"});
  refuses("[material]",
          "[[region]]\ngroup = \"body\"\nlaw = \"linear\"\nyoung = 1e4\npoisson = 0.3\n"
          "[[region]]\nlaw = \"linear\"\nyoung = 1e4\npoisson = 0.3\n"
          "sphere = { center = [1, 1, 1], radius = 0.1 }\n[material]",
          {"scene.toml:11: region.sphere", "from (0, 0, 0)"});
  refuses("[fixed]",
          "[[region]]\ngroup = \"body\"\nlaw = \"linear\"\nyoung = 1e4\npoisson = 0.3\n[fixed]",
          {"scene.toml:2: [material]: the regions cover the whole body", "remove it"});
  refuses("[fixed]", "[discretization]\npressure = \"P2\"\n[fixed]",
          {"scene.toml:7: discretization.pressure", "write P1-stabilized or P1"});
  // Workspace, spacing and device.
  refuses("spacing = 0.025", "spacing = 0.25",
          {"scene.toml:13: workspace.radius", "smaller than the spacing"});
  refuses("spacing = 0.025", "spacing = 0.0001",
          {"scene.toml:13: workspace.radius / workspace.spacing", "choose a larger spacing"});
  refuses("radius = 0.05\nspacing = 0.025", "radius = 50\nspacing = 25",
          {"scene.toml:13: workspace.radius = 50 m", "3 times the diagonal", "unit"});
  refuses("[workspace]", "[device]\nprofile = \"tuoch\"\n[workspace]",
          {"scene.toml:13: device.profile", "did you mean \"touch\""});
  refuses("[workspace]", "[accuracy]\nforce_error = 3\n[workspace]",
          {"scene.toml:13: accuracy.force_error", "between 0 and 1"});
  refuses("[workspace]", "[storage]\nprecision = \"float16\"\n[workspace]",
          {"scene.toml:13: storage.precision", "did you mean \"float32\""});
}

constexpr const char* four_points = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n";

std::string binaryStlWithout(std::size_t bytes) {
  const test::TemporaryDirectory directory;
  test::writeBinaryStl(test::sphereSurface(1, 2), directory / "s.stl");
  std::string all = test::bytesIn(directory / "s.stl");
  all.replace(0, 5, "made ");
  return all.substr(0, all.size() - bytes);
}

/// A legacy VTK file with one cell of this type.
std::string vtkOf(const std::string& type, const std::string& nodes) {
  return "# vtk DataFile Version 3.0\nmade in code\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 8 "
         "double\n0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 0 1 1\nCELLS 1 " +
         std::to_string(1 + std::stoi(nodes)) + "\n" + nodes + "\nCELL_TYPES 1\n" + type + "\n";
}

/// A Gmsh file with one tetrahedron that lists node 4 twice, in lines 9 and 10.
constexpr const char* gmsh_twice =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n4 5 5 5\n"
    "$EndNodes\n$Elements\n1\n1 4 2 1 1 1 2 3 4\n$EndElements\n";

/// The same in version 4.1, which lists numbers before positions.
constexpr const char* gmsh41_twice =
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 5 1 4\n3 1 0 5\n1\n2\n3\n4\n4\n0 0 0\n1 0 0\n"
    "0 1 0\n0 0 1\n5 5 5\n$EndNodes\n$Elements\n1 1 1 1\n3 1 4 1\n1 1 2 3 4\n$EndElements\n";

/// A part with one tetrahedron, in the first 8 lines.
const std::string abaqus_part =
    "*PART, NAME=Organ\n*NODE\n1, 0,0,0\n2, 1,0,0\n3, 0,1,0\n4, 0,0,1\n*ELEMENT, TYPE=C3D4\n"
    "1, 1,2,3,4\n*END PART\n*ASSEMBLY, NAME=All\n";

/// A separate mesh file, as read by `palpate mesh`.
struct BrokenMesh : testing::Test {
  void SetUp() override { PALPATE_NEEDS(test::hasMeshio(), "python3-meshio"); }
  void refuses(const std::string& name, const std::string& content,
               std::initializer_list<std::string> words) const {
    SCOPED_TRACE(name);
    test::putInto(directory / name, content);
    expectSentence([&] { convertMesh(directory / name, directory.path()); }, words);
  }
  const test::TemporaryDirectory directory;
};

TEST_F(BrokenMesh, IsRefusedWithFileLineAndReason) {
  const std::string febio_head =
      "<?xml version=\"1.0\"?>\n<febio_spec version=\"4.0\">\n<Mesh>\n"
      "<Nodes>\n<node id=\"1\">0,0,0</node>\n</Nodes>\n";
  const std::string febio_elements =
      febio_head + "<Elements type=\"tet4\" name=\"all\">\n<elem id=\"1\">1,1,1,1</elem>\n";
  refuses("cut.stl", binaryStlWithout(7), {"cut.stl: it announces 48 triangles", "truncated"});
  refuses("words.stl", "this is a letter\n", {"words.stl:1: this is not an STL file", "\"solid\""});
  refuses("comma.stl", "solid\nfacet\nouter loop\nvertex 0,5 0 0\n",
          {"comma.stl:4", "expected numbers, found \"0,5 0 0\""});
  refuses("corner.stl", "solid\nvertex 0 0 0\nvertex 1 0 0\n",
          {"corner.stl:3", "fewer than three corners", "truncated"});
  refuses("unended.stl",
          "solid a\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendsolid a\nsolid b\nvertex 0 0 0\n"
          "vertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n",
          {"unended.stl:11: there is no endsolid", "the file is truncated; save it again"});
  refuses("empty.stl", "solid nothing\nendsolid\n",
          {"empty.stl: there are neither tetrahedra nor"});
  refuses("far.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n",
          {"far.obj:4: a face has a corner that does not exist", "3 vertices are defined"});
  refuses("word.obj", "v 0 0 zero\n", {"word.obj:1", "expected numbers, found \"0 0 zero\""});
  refuses("cut.off", std::string("OFF\n4 4 0\n") + four_points + "3 0 1 2\n",
          {"cut.off:7: the file is truncated"});
  refuses("none.off", "4 4 0\n", {"none.off:1: this is not a plain OFF file"});
  refuses("cut.ply", "ply\nformat ascii 1.0\nelement vertex 4\n",
          {"cut.ply:1: ", "its header is truncated"});
  refuses("short.ply",
          "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
          "property float z\nend_header\n0 0 0 1\n",
          {"short.ply: the file is truncated"});
  refuses("word.ply", "ply\nformat runes 1.0\nend_header\n",
          {"word.ply:2: unknown header line \"format runes 1.0\""});
  refuses("scalar.ply",
          "ply\nformat ascii 1.0\nelement face 1\nproperty int vertex_indices\nend_header\n0\n",
          {"scalar.ply: the corners of its faces are not a list"});
  refuses(
      "inf.ply",
      "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "3 0 inf 2\n",
      {"inf.ply: the file is truncated, or has text"});
  refuses("brick.inp", "*NODE\n1, 0, 0, 0\n*ELEMENT, TYPE=SPRINGA\n1, 1, 1\n",
          {"brick.inp: elements of type SPRINGA are not read", "C3D4 and C3D10"});
  refuses("lost.inp", "*NODE\n1, 0, 0, 0\n*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 4\n",
          {"lost.inp:4: node 2 is used but not defined"});
  refuses("more.inp", "*NODE\n1, 0, 0, 0\n*ELEMENT, TYPE=C3D4\n1, 1, 1, 1, 1, 1\n",
          {"more.inp:4: expected an element of 4 nodes, found 5"});
  refuses("set.inp", "*NODE\n1, 0, 0, 0\n*ELSET, ELSET=all\nliver\n",
          {"set.inp:4: there is no set \"liver\""});
  refuses("loop.inp", "*NODE\n*INCLUDE, INPUT=loop.inp\n", {"loop.inp:2: ", "includes itself"});
  refuses("beside.inp", "*NODE\n*INCLUDE, INPUT=none.inp\n",
          {"beside.inp:2: *INCLUDE, INPUT=none.inp: there is no file ", "put it there"});
  refuses("nothing.inp", "*NODE\n*INCLUDE\n",
          {"nothing.inp:2: *INCLUDE names no file: write *INCLUDE, INPUT=FILE"});
  refuses("inf.inp", "*NODE\ninf, 0, 0, 0\n",
          {"inf.inp:2: node number inf is not a whole number", "correct it"});
  refuses("made.inp", "*NODE\n1, 0, 0, 0\n*NGEN\n1, 9\n",
          {"made.inp:3: *NGEN creates nodes or elements", "write a flat model", ".vtu"});
  refuses("copied.inp", "*NODE\n*ELGEN\n1, 9\n",
          {"copied.inp:2: *ELGEN creates nodes or elements"});
  refuses("round.inp", "*NODE, SYSTEM=C\n1, 1, 90, 0\n",
          {"round.inp:1: *NODE, SYSTEM=C: only rectangular coordinates are read", "flat"});
  refuses("system.inp", "*SYSTEM\n1, 0, 0\n*NODE\n",
          {"system.inp:2: *SYSTEM moves the nodes after it", "write a flat model"});
  refuses("moved.inp", abaqus_part + "*INSTANCE, NAME=O, PART=Organ\n0., 0., 5.\n*END INSTANCE\n",
          {"moved.inp:12: this line moves an instance of part ORGAN", "remove the line"});
  refuses("turned.inp",
          abaqus_part + "*INSTANCE, NAME=O, PART=Organ\n0,0,0\n0,0,0,1,0,0,90\n*END INSTANCE\n",
          {"turned.inp:13: this line moves an instance of part ORGAN", "remove the line"});
  refuses(
      "two.inp",
      abaqus_part + "*INSTANCE, NAME=O, PART=Organ\n*END INSTANCE\n*INSTANCE, NAME=P, PART=Organ\n",
      {"two.inp: there are 2 instances of part ORGAN", "export one"});
  refuses("range.inp", "*NODE\n1, 0, 0, 0\n*NSET, NSET=all, GENERATE\n1, 300000000\n",
          {"range.inp:4: GENERATE makes more than 10000000 members", "list only existing ones"});
  refuses("plane.inp", "*NODE\n1, 0, 0\n", {"plane.inp:2: expected a node number and three"});
  refuses("text.feb", "no XML at all\n", {"text.feb:1: this is not XML"});
  refuses("old.feb", "<febio_spec version=\"1.2\">\n</febio_spec>\n",
          {"old.feb:1: there is no <Geometry> or <Mesh>", "FEBio 2.5"});
  refuses("shell.feb",
          febio_head + "<Elements type=\"truss2\">\n</Elements>\n</Mesh></febio_spec>\n",
          {"shell.feb:7: elements of type \"truss2\" are not read", "tet4 and tet10"});
  refuses(
      "few.feb",
      febio_head +
          "<Elements type=\"tet4\">\n<elem id=\"1\">1,1,1</elem>\n</Elements></Mesh></febio_spec>",
      {"few.feb:8: expected 4 nodes, found 3"});
  refuses("lost.feb",
          febio_head +
              "<Elements type=\"tet4\">\n<elem id=\"1\">1,2,3,4</elem>\n</Elements></Mesh>"
              "</febio_spec>",
          {"lost.feb:8: node '2' is used but not defined"});
  refuses(
      "twice.feb",
      "<febio_spec>\n<Mesh>\n<Nodes>\n<node id=\"3\">0,0,0</node>\n<node id=\"3\">1,0,0</node>\n"
      "</Nodes>\n</Mesh>\n</febio_spec>\n",
      {"twice.feb:5: node 3 is defined twice", "give each its own number"});
  refuses("same.feb",
          febio_elements + "<elem id=\"1\">1,1,1,1</elem>\n</Elements></Mesh></febio_spec>",
          {"same.feb:9: element 1 is defined twice", "give each its own number"});
  refuses("runes.feb", "<?xml version=\"1.0\" encoding=\"utf-99\"?>\n<febio_spec/>\n",
          {"runes.feb:1: the encoding that this line names cannot be read", "utf-99", "as UTF-8"});
  refuses("place.feb",
          febio_elements +
              "</Elements></Mesh>\n<MeshData><ElementData elem_set=\"all\">\n"
              "<e lid=\"x\">0,0,1</e></ElementData></MeshData></febio_spec>",
          {"place.feb:11: lid=\"x\" must be the position of an element"});
  refuses("twice.node", "2 3 0 0\n4 0 0 0\n4 1 0 0\n",
          {"twice.node:3: node 4 is defined twice", "give each its own number"});
  refuses("inf.node", "1 3 0 0\ninf 0 0 0\n",
          {"inf.node:2: node number inf is not a whole number"});
  refuses("alone.node", "4 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n",
          {"alone.ele: No such file or directory"});
  refuses("cut.node", "4 3 0 0\n0 0 0 0\n", {"cut.node: expected 4 points, found 1"});
  refuses("plane.node", "4 2 0 0\n", {"plane.node:1: the first line must be: number of points, 3"});
  refuses(
      "brick.vtk", vtkOf("12", "8 0 1 2 3 4 5 6 7"),
      {"brick.vtk: it has volume cells that are not tetrahedra", "1 of kind hexahedron", ".stl"});
  refuses("line.vtk", vtkOf("3", "2 0 1"),
          {"line.vtk: there are neither tetrahedra nor triangles"});
  refuses("far.vtk", vtkOf("10", "4 0 1 2 9"),
          {"far.vtk: a cell (tetra) uses point 9", "there are 8"});
  refuses("surface.vtk",
          "# vtk DataFile Version 3.0\nmade in code\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n"
          "0 0 0 1 0 0 0 1 0\nPOLYGONS 1 4\n3 0 1 2\n",
          {"surface.vtk:4: it is a surface", "save it as .stl", "3D Slicer", "ParaView"});
  refuses("surface.vtp",
          "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\"><PolyData/></VTKFile>\n",
          {"surface.vtp:1: it is a surface", "save it as .stl"});
  refuses("surface.vtu",
          "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\"><PolyData/></VTKFile>\n",
          {"surface.vtu:1: it is a surface", "save it as .stl"});
  refuses("not.vtk", "# stl\n", {"not.vtk:1: this is not a legacy VTK file", ".vtu"});
  refuses("cut.vtu", "<?xml version=\"1.0\"?>\n<VTKFile type=\"Unstr",
          {"cut.vtu:2: this is not XML"});
  refuses("begun.msh", "$MeshFormat\n", {"begun.msh:2: there is no version", "save it again"});
  refuses("cut.msh", "$MeshFormat\n2.2 1 8\n\x01\x01", {"cut.msh: the file is truncated"});
  refuses("other.msh", std::string("$MeshFormat\n4.1 1 8\n") + std::string("\0\0\0\1", 4),
          {"other.msh:3", "another byte order"});
  refuses("twice.msh", gmsh_twice, {"twice.msh:10: node 4 is defined twice", "its own number"});
  refuses("twice41.msh", gmsh41_twice, {"twice41.msh:11: node 4 is defined twice"});
  refuses("word.msh",
          "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n2\n1 0 0 0\n2 0 one 0\n$EndNodes\n",
          {"word.msh:7: the file is truncated, or has text"});
  refuses("number.msh",
          "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$ElementData\none\n$EndElementData\n",
          {"number.msh:5: $ElementData is truncated, or has text", "save it again"});
  refuses("letter.doc", "dear all\n",
          {"letter.doc: unknown extension", "a surface as .stl", "as .vtu"});
  refuses("solid.stl.gz", "\x1f\x8b", {"solid.stl.gz: it is compressed: decompress it first"});
}

}  // namespace
}  // namespace palpate
