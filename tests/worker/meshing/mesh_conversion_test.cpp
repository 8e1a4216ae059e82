#include "worker/meshing/mesh_conversion.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/base/whole_file.hpp"
#include "common/mesh/mesh_reader.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/reference_data.hpp"
#include "tests/support/shell_script.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/worker/meshing/surfaces.hpp"

namespace palpate {
namespace {

using test::expectBadInput;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

/// A distorted box of ten-node tetrahedra in two parts, and files of it in other formats.
class MeshConversion : public ::testing::Test {
 protected:
  MeshConversion() {
    body = test::distortedBoxMesh({2, 1, 1}, {4, 2, 2});
    addMidEdgeNodes(body);
    for (std::size_t e = 0; e < body.tetrahedra.size(); ++e)
      part.push_back(middleOf(body, e)[0] < 1 ? 3 : 8);
  }

  void SetUp() override { PALPATE_NEEDS(test::hasMeshio(), "python3-meshio"); }

  /// Runs a command in the directory.
  void run(const std::string& command) const {
    const test::CommandResult ran =
        test::runCommand("cd " + directory.path().string() + " && " + command);
    ASSERT_EQ(ran.exit_code, 0) << ran.output;
  }
  ConvertedMesh converted(const std::string& name) const {
    return convertMesh(directory / name, directory.path());
  }
  ClosedSurface surfaceOf(const std::filesystem::path& file) const {
    const ConvertedMesh made = convertMesh(file, directory.path());
    EXPECT_FALSE(made.is_volume);
    return closedSurface(readTriangles(made.file), "", Bodies::only);
  }

  /// The ten nodes of a tetrahedron in VTK's order.
  std::array<std::int32_t, 10> nodesOf(std::size_t e) const {
    std::array<std::int32_t, 10> nodes{};
    std::ranges::copy(body.tetrahedra[e], nodes.begin());
    std::ranges::copy(body.mid_edge_nodes[e], nodes.begin() + 4);
    return nodes;
  }

  std::ofstream create(const std::string& name) const {
    std::ofstream out(directory / name);
    out.precision(17);
    return out;
  }

  /// Writes the body with meshio: the parts as `region`, a vector field, and the points of xmin as
  /// `fixed`.
  void writeByMeshio(const std::string& name, const std::string& arguments = "",
                     const std::string& labels = "int64") const {
    std::ofstream points = create("points"), cells = create("cells"), parts = create("parts");
    for (const Eigen::Vector3d& x : body.nodes) points << x.transpose() << "\n";
    for (std::size_t e = 0; e < body.tetrahedra.size(); ++e) {
      for (const std::int32_t node : nodesOf(e)) cells << node << " ";
      cells << "\n";
      parts << part[e] << "\n";
    }
    for (std::ofstream* file : {&points, &cells, &parts}) file->close();
    std::ofstream script = create("write.py");
    script << "import meshio, numpy as np\n"
              "p, c, r = np.loadtxt('points'), np.loadtxt('cells', int), np.loadtxt('parts', int)\n"
              "m = meshio.Mesh(p, [('tetra10', c)], cell_data={'region': [r.astype('"
           << labels
           << "')],\n"
              "    'direction': [np.tile([0.0, 0.6, 0.8], (len(c), 1))]},\n"
              "    point_data={'fixed': (p[:, 0] == 0).astype('"
           << labels << "')})\nmeshio.write('" << name << "', m" << arguments << ")\n";
    script.close();
    run("/usr/bin/python3 write.py");
  }

  Mesh convert(const std::string& name, ConversionWishes wishes = {}) {
    const ConvertedMesh converted = convertMesh(directory / name, directory.path(), wishes);
    EXPECT_TRUE(converted.is_volume);
    notes = converted.notes;
    text = readText(converted.file, "mesh");
    return parseGmsh(text, name);
  }

  /// Expects the same tetrahedra with positive volume and mid-edge nodes in the middles; otherwise
  /// parseGmsh would have refused them as curved.
  void expectTheBody(const Mesh& mesh, double tolerance = 1e-12) const {
    ASSERT_EQ(mesh.tetrahedra.size(), body.tetrahedra.size());
    EXPECT_EQ(mesh.reoriented_tetrahedra, 0);
    EXPECT_TRUE(hasTenNodesEach());
    for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e)
      for (int i = 0; i < 4; ++i)
        EXPECT_LT((mesh.nodes[mesh.tetrahedra[e][i]] - body.nodes[body.tetrahedra[e][i]]).norm(),
                  tolerance);
    EXPECT_NEAR(measure(mesh).volume, 2, 1e-6);
  }

  /// Whether the written file has ten-node tetrahedra.
  bool hasTenNodesEach() const {
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);)
      if (line.find(" 11 2 ") == line.find(' ') && line.find(' ') != std::string::npos) return true;
    return false;
  }

  void expectParts(const Mesh& mesh, const std::string& low, const std::string& high) const {
    ASSERT_THAT(mesh.element_groups, Contains(::testing::Key(low)));
    ASSERT_THAT(mesh.element_groups, Contains(::testing::Key(high)));
    std::vector<std::int32_t> of_low;
    for (std::size_t e = 0; e < part.size(); ++e)
      if (part[e] == 3) of_low.push_back(static_cast<std::int32_t>(e));
    EXPECT_EQ(mesh.element_groups.at(low), of_low);
    EXPECT_EQ(mesh.element_groups.at(high).size(), part.size() - of_low.size());
  }

  /// Expects the vertices of side x = 0 under this name.
  void expectFixed(const Mesh& mesh, const std::string& name) const {
    ASSERT_THAT(mesh.node_groups, Contains(::testing::Key(name)));
    EXPECT_EQ(mesh.node_groups.at(name).size(), 9u);
    for (const std::int32_t node : mesh.node_groups.at(name)) EXPECT_EQ(mesh.nodes[node][0], 0);
  }

  test::TemporaryDirectory directory;
  Mesh body;
  std::vector<int> part;  ///< for each tetrahedron, 3 or 8
  std::vector<std::string> notes;
  std::string text;
};

TEST_F(MeshConversion, KeepsTenNodesGroupsAndVectorsReadByMeshio) {
  for (const auto& [name, arguments, labels] :
       {std::tuple("b.vtu", "", "float64"), std::tuple("a.vtu", ", binary=False", "uint8"),
        std::tuple("b.vtk", "", "int32"), std::tuple("a.vtk", ", binary=False", "int64"),
        std::tuple("old.vtk", ", file_format='vtk42'", "int32")}) {
    SCOPED_TRACE(name);
    writeByMeshio(name, arguments, labels);
    const Mesh mesh = convert(name);
    expectTheBody(mesh);
    expectParts(mesh, "region 3", "region 8");
    expectFixed(mesh, "fixed");
    ASSERT_THAT(mesh.element_vectors, Contains(::testing::Key("direction")));
    EXPECT_EQ(mesh.element_vectors.at("direction")[5], Eigen::Vector3d(0, 0.6, 0.8));
  }
}

/// VTK packs eight bits into a byte of a binary file.
TEST_F(MeshConversion, ReadsBitArraysAndSkipsNormalsOfVtk) {
  create("bits.py") << R"(import numpy as np
def write(name, binary):
    with open(name, 'wb') as out:
        def line(words):
            out.write(words.encode() + b'\n')
        def array(words, kind, values):
            line(words)
            packed = np.packbits(values) if kind == 'bit' else np.array(values, kind)
            line(' '.join(map(str, values))) if not binary else out.write(packed.tobytes() + b'\n')
        line('# vtk DataFile Version 5.1\ntwo\n' + ('BINARY' if binary else 'ASCII'))
        line('DATASET UNSTRUCTURED_GRID')
        array('POINTS 5 float', '>f4', [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1])
        array('CELLS 2 10', '>i4', [4, 0, 1, 2, 3, 4, 1, 2, 3, 4])
        array('CELL_TYPES 2', '>i4', [10, 10])
        array('CELL_DATA 2\nNORMALS facing float', '>f4', [0, 0, 1, 0, 0.6, 0.8])
        array('FIELD FieldData 1\nstiff 1 2 bit', 'bit', [0, 1])
        array('POINT_DATA 5\nSCALARS wall bit 1\nLOOKUP_TABLE default', 'bit', [1, 1, 1, 0, 0])
        array('NORMALS outward float', '>f4', [0.5] * 15)
        array('FIELD FieldData 1\nlabel 1 5 int', '>i4', [0, 0, 0, 2, 2])
write('ascii.vtk', False)
write('binary.vtk', True)
)";
  run("/usr/bin/python3 bits.py");
  for (const char* name : {"ascii.vtk", "binary.vtk"}) {
    SCOPED_TRACE(name);
    const Mesh mesh = convert(name);
    EXPECT_EQ(mesh.tetrahedra.size(), 2u);
    EXPECT_THAT(mesh.element_groups.at("stiff"), ElementsAre(1));
    EXPECT_THAT(mesh.node_groups.at("wall"), ElementsAre(0, 1, 2));
    EXPECT_THAT(mesh.node_groups.at("label 2"), ElementsAre(3, 4));
    EXPECT_EQ(mesh.node_groups.size(), 3u);
    EXPECT_THAT(mesh.element_vectors, IsEmpty());
  }
}

TEST_F(MeshConversion, ReadsMedNastranAndMeditWithTheirGroups) {
  writeByMeshio("body.vtu");
  std::ofstream script = create("others.py");
  script << "import meshio, numpy as np\n"
            "p, c, r = np.loadtxt('points'), np.loadtxt('cells', int), np.loadtxt('parts', int)\n"
            "m = meshio.Mesh(p, [('tetra10', c)], cell_data={'nastran:ref': [r]})\n"
            "meshio.write('body.bdf', m)\n"
            "m = meshio.Mesh(p, [('tetra10', c)], cell_data={'cell_tags': [-r]},\n"
            "    point_data={'point_tags': (p[:, 0] == 0).astype(int)})\n"
            "m.cell_tags, m.point_tags = {-3: ['soft'], -8: ['stiff']}, {1: ['wall']}\n"
            "meshio.write('body.med', m)\n"
            "m = meshio.Mesh(p, [('tetra', c[:, :4])], cell_data={'medit:ref': [r]})\n"
            "meshio.write('body.mesh', m)\n";
  script.close();
  run("/usr/bin/python3 others.py");
  const Mesh med = convert("body.med");
  expectTheBody(med);
  expectParts(med, "soft", "stiff");
  expectFixed(med, "wall");
  const Mesh nastran = convert("body.bdf");
  expectTheBody(nastran, 1e-6);  // its numbers have 16 columns at most
  expectParts(nastran, "ref 3", "ref 8");
  const Mesh medit = convert("body.mesh");
  EXPECT_NEAR(measure(medit).volume, 2, 1e-6);
  expectParts(medit, "ref 3", "ref 8");
}

TEST_F(MeshConversion, NamesThePackageOfAMissingMeshio) {
  writeByMeshio("body.bdf");
  create("meshio.py") << "raise ImportError('as if it were not there')\n";
  // The user's own Python, which lacks further packages.
  test::writeScript(directory / "python3", "echo numpy >&2\nexit 3");
  const test::FirstInPath own(directory.path());
  setenv("PYTHONPATH", directory.path().c_str(), 1);
  test::expectError(ExitCode::failed, [&] { convert("body.bdf"); },
                    {"body.bdf cannot be read", "Debian: python3-meshio"});
  unsetenv("PYTHONPATH");
}

TEST_F(MeshConversion, ReadsTheTenNodesOfAbaqusWithItsSets) {
  std::ofstream out = create("body.inp");
  out << "*HEADING\n** made in code\n*NODE, NSET=all\n";
  for (std::size_t n = 0; n < body.nodes.size(); ++n)
    out << n + 11 << ", " << body.nodes[n][0] << ", " << body.nodes[n][1] << ", "
        << body.nodes[n][2] << "\n";
  for (const int wanted : {3, 8}) {
    // In two blocks, as exporters write each part; lines end after eight numbers.
    out << "*ELEMENT, TYPE=C3D10MH, ELSET=" << (wanted == 3 ? "liver" : "tumour") << "\n";
    for (std::size_t e = 0; e < part.size(); ++e) {
      if (part[e] != wanted) continue;
      out << e + 1;
      for (int i = 0; i < 10; ++i) out << (i == 7 ? ",\n" : ", ") << nodesOf(e)[i] + 11;
      out << "\n";
    }
  }
  out << "*NSET, NSET=\"base plate\"\n";
  for (const std::int32_t node : body.node_groups.at("xmin")) out << node + 11 << ",\n";
  out << "*ELSET, ELSET=first, GENERATE\n1, 5, 2\n*ELSET, ELSET=both\nliver, tumour\n*STEP\n";
  out.close();
  const Mesh mesh = convert("body.inp");
  // First all elements of one part, then those of the other.
  ASSERT_EQ(mesh.tetrahedra.size(), body.tetrahedra.size());
  EXPECT_EQ(mesh.element_groups.at("liver").size() + mesh.element_groups.at("tumour").size(),
            part.size());
  EXPECT_EQ(mesh.element_groups.at("both").size(), part.size());
  EXPECT_EQ(mesh.element_groups.at("first").size(), 3u);
  for (const std::int32_t e : mesh.element_groups.at("liver"))
    EXPECT_LT(mesh.nodes[mesh.tetrahedra[e][0]][0], 1.1);
  expectFixed(mesh, "base plate");
  EXPECT_NEAR(measure(mesh).volume, 2, 1e-9);
}

TEST_F(MeshConversion, ReadsFebioOfEveryVersionWithItsSets) {
  for (const bool modern : {false, true}) {
    SCOPED_TRACE(modern);
    std::ofstream out = create("body.feb");
    out << "<?xml version=\"1.0\"?>\n<febio_spec version=\"" << (modern ? "4.0" : "2.5") << "\">\n"
        << (modern ? "<Mesh>\n" : "<Geometry>\n") << "<Nodes name=\"Object1\">\n";
    for (std::size_t n = 0; n < body.nodes.size(); ++n)
      out << "<node id=\"" << n + 1 << "\">" << body.nodes[n][0] << "," << body.nodes[n][1] << ","
          << body.nodes[n][2] << "</node>\n";
    out << "</Nodes>\n";
    for (const int wanted : {3, 8}) {
      out << "<Elements type=\"tet10\" "
          << (modern ? "name=\"Part" + std::to_string(wanted) + "\""
                     : "mat=\"" + std::to_string(wanted) + "\"")
          << ">\n";
      for (std::size_t e = 0; e < part.size(); ++e) {
        if (part[e] != wanted) continue;
        out << "<elem id=\"" << e + 1 << "\">" << nodesOf(e)[0] + 1;
        for (int i = 1; i < 10; ++i) out << ", " << nodesOf(e)[i] + 1;
        out << "</elem>\n";
      }
      out << "</Elements>\n";
    }
    out << "<NodeSet name=\"clamp\">";
    const NodeSet& fixed = body.node_groups.at("xmin");
    for (std::size_t i = 0; i < fixed.size(); ++i)
      if (modern)
        out << (i > 0 ? "," : "") << fixed[i] + 1;
      else
        out << "<node id=\"" << fixed[i] + 1 << "\"/>";
    out << "</NodeSet>\n<Surface name=\"skin\"><tri3 id=\"1\">" << fixed[0] + 1 << ","
        << fixed[1] + 1 << "," << fixed[2] + 1 << "</tri3></Surface>\n"
        << (modern ? "</Mesh>\n" : "</Geometry>\n") << "</febio_spec>\n";
    out.close();
    const Mesh mesh = convert("body.feb");
    EXPECT_NEAR(measure(mesh).volume, 2, 1e-9);
    EXPECT_TRUE(hasTenNodesEach());
    const std::string low = modern ? "Part3" : "material 3", high = modern ? "Part8" : "material 8";
    EXPECT_EQ(mesh.element_groups.at(low).size() + mesh.element_groups.at(high).size(),
              part.size());
    expectFixed(mesh, "clamp");
    EXPECT_EQ(mesh.node_groups.at("skin").size(), 3u);
  }
}

TEST_F(MeshConversion, ReportsFebioSetsWithMissingMembers) {
  create("sets.feb") << "<febio_spec>\n<Mesh>\n<Nodes>\n<node id=\"1\">0,0,0</node>\n"
                        "<node id=\"2\">1,0,0</node>\n<node id=\"3\">0,1,0</node>\n"
                        "<node id=\"4\">0,0,1</node>\n</Nodes>\n"
                        "<Elements type=\"tet4\" name=\"all\">\n<elem id=\"1\">1,2,3,4</elem>\n"
                        "</Elements>\n<NodeSet name=\"base\">1,2,3</NodeSet>\n"
                        "<NodeSet name=\"a\"><NodeSet node_set=\"base\"/>"
                        "<NodeSet node_set=\"zzz\"/></NodeSet>\n"
                        "<ElementSet name=\"e\">1, 77</ElementSet>\n</Mesh>\n<MeshData>\n"
                        "<ElementData var=\"fiber\" elem_set=\"all\"><e lid=\"1\">0,0,1</e>"
                        "<e lid=\"2\">0,0,1</e></ElementData>\n</MeshData>\n</febio_spec>\n";
  const Mesh mesh = convert("sets.feb");
  EXPECT_EQ(mesh.node_groups.at("a").size(), 3u);
  EXPECT_EQ(mesh.element_groups.at("e").size(), 1u);
  EXPECT_THAT(mesh.element_vectors, Contains(::testing::Key("fiber")));
  EXPECT_THAT(notes,
              Contains("the set \"a\" names the set \"zzz\", which is not defined before it"));
  EXPECT_THAT(notes, Contains("the set \"e\" names 1 missing element"));
  EXPECT_THAT(notes, Contains("the data \"fiber\" names 1 missing element"));
}

TEST_F(MeshConversion, ReadsTetGenCountedFromZeroOrOneWithItsRegions) {
  // The positions in TetGen's -o2 of the mid-edge nodes in the order of tetrahedron_edges.
  constexpr std::array<int, 6> tetgen_order = {5, 3, 0, 1, 4, 2};
  for (const int first : {0, 1}) {
    SCOPED_TRACE(first);
    std::ofstream node = create("body.node"), ele = create("body.ele");
    node << "# made in code\n" << body.nodes.size() << " 3 0 1\n";
    for (std::size_t n = 0; n < body.nodes.size(); ++n)
      node << n + first << "  " << body.nodes[n].transpose() << "  " << (body.nodes[n][0] == 0)
           << "\n";
    ele << body.tetrahedra.size() << "  10  1\n";
    for (std::size_t e = 0; e < part.size(); ++e) {
      ele << e + first;
      for (int i = 0; i < 4; ++i) ele << "  " << nodesOf(e)[i] + first;
      for (const int i : tetgen_order) ele << "  " << nodesOf(e)[4 + i] + first;
      ele << "  " << part[e] << "\n";
    }
    node.close();
    ele.close();
    for (const char* name : {"body.node", "body.ele"}) {
      const Mesh mesh = convert(name);
      expectTheBody(mesh);
      expectParts(mesh, "region 3", "region 8");
      expectFixed(mesh, "marker");
    }
  }
}

TEST_F(MeshConversion, ReadsTheOldestGmshFormatsWithTheGroupOfEachElement) {
  // In these formats, each element names its group.
  create("old.msh") << "$NOD\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 1\n$ENDNOD\n"
                       "$ELM\n2\n1 4 3 7 4 1 2 3 4\n2 4 8 7 4 2 3 4 5\n$ENDELM\n";
  const Mesh mesh = convert("old.msh");
  EXPECT_EQ(mesh.tetrahedra.size(), 2u);
  EXPECT_THAT(mesh.element_groups.at("volume 3"), ElementsAre(0));
  EXPECT_THAT(mesh.element_groups.at("volume 8"), ElementsAre(1));
  // Names in version 2.0 have no dimension.
  create("names.msh") << "$MeshFormat\n2 0 8\n$EndMeshFormat\n"
                         "$PhysicalNames\n1\n8 \"left lobe\"\n$EndPhysicalNames\n"
                         "$Nodes\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$EndNodes\n"
                         "$Elements\n1\n1 4 2 8 7 1 2 3 4\n$EndElements\n";
  EXPECT_THAT(convert("names.msh").element_groups.at("left lobe"), ElementsAre(0));
}

TEST_F(MeshConversion, ReadsGmshOfEveryKindWithAllItsGroups) {
  PALPATE_NEEDS(test::hasProgram("gmsh"), "gmsh");
  // Only one of the two bodies and one side of it have names. meshio cannot read such a file of
  // version 4.1.
  create("two.geo") << "SetFactory(\"OpenCASCADE\");\nBox(1) = {0, 0, 0, 1, 1, 1};\n"
                       "Box(2) = {1, 0, 0, 1, 1, 1};\nCoherence;\n"
                       "Physical Volume(\"left part\") = {1};\n"
                       "Physical Surface(\"base\") = {1};\nMesh.MeshSizeMax = 0.7;\n";
  for (const char* how : {"-order 1 -save_all -format msh41", "-order 2 -format msh41 -bin",
                          "-order 2 -save_all -format msh41 -bin", "-order 2 -format msh40",
                          "-order 1 -format msh40 -save_parametric", "-order 2 -format msh22 -bin",
                          "-order 1 -format msh22 -bin"}) {
    SCOPED_TRACE(how);
    run(std::string("gmsh -3 two.geo -v 1 -o two.msh ") + how);
    const Mesh mesh = convert("two.msh");
    const bool all = std::string(how).find("save_all") != std::string::npos;
    EXPECT_NEAR(measure(mesh).volume, all ? 2 : 1, 1e-9);
    double volume = 0;
    for (const std::int32_t e : mesh.element_groups.at("left part"))
      volume += sixVolume(mesh, static_cast<std::size_t>(e)) / 6;
    EXPECT_NEAR(volume, 1, 1e-9);
    ASSERT_THAT(mesh.node_groups, Contains(::testing::Key("base")));
    for (const std::int32_t node : mesh.node_groups.at("base")) EXPECT_EQ(mesh.nodes[node][0], 0);
  }
}

TEST_F(MeshConversion, RefusesAPartitionedMeshWhoseGroupsWouldBeLost) {
  PALPATE_NEEDS(test::hasProgram("gmsh"), "gmsh");
  create("box.geo") << "SetFactory(\"OpenCASCADE\");\nBox(1) = {0, 0, 0, 1, 1, 1};\n"
                       "Physical Volume(\"all\") = {1};\n";
  run("gmsh -3 box.geo -part 2 -v 1 -format msh41 -o box.msh");
  expectBadInput([&] { convert("box.msh"); }, {"box.msh: the mesh is partitioned: save it whole"});
}

TEST_F(MeshConversion, WeldsCoincidentNodesOnRequest) {
  const Mesh layers = test::together(test::distortedBoxMesh({1, 1, 1}, {3, 3, 3}),
                                     test::moved(test::cubeMesh(1, 3), {1 + 1e-8, 0, 0}));
  test::writeGmsh22(layers, directory / "layers.msh");
  EXPECT_EQ(measure(convert("layers.msh")).coincident.size(), 16u);
  const Mesh mesh = convert("layers.msh", {.weld = true});
  EXPECT_THAT(notes, Contains(HasSubstr("merged: 16 nodes")));
  EXPECT_EQ(mesh.nodes.size(), layers.nodes.size() - 16);
  EXPECT_EQ(mesh.tetrahedra.size(), layers.tetrahedra.size());
  EXPECT_EQ(mesh.node_groups.at("xmin").size(), 16u);
  EXPECT_EQ(measure(mesh).pieces, 1);
  EXPECT_THAT(measure(mesh).coincident, IsEmpty());
}

TEST_F(MeshConversion, WeldsTenNodeTetrahedraToo) {
  PALPATE_NEEDS(test::hasProgram("gmsh"), "gmsh");
  create("two.geo") << "SetFactory(\"OpenCASCADE\");\nBox(1) = {0, 0, 0, 1, 1, 1};\n"
                       "Box(2) = {1, 0, 0, 1, 1, 1};\nTransfinite Curve{:} = 3;\n"
                       "Transfinite Surface{:};\nTransfinite Volume{:};\n";
  run("gmsh -3 two.geo -order 2 -v 1 -o two.msh");
  EXPECT_EQ(measure(convert("two.msh", {.weld = true})).pieces, 1);
  EXPECT_TRUE(hasTenNodesEach());
}

TEST_F(MeshConversion, RefusesVoxelsAmongTetrahedraWithTheirCount) {
  const char* points = "0 0 0 40 0 0 0 40 0 40 40 0 0 0 40 40 0 40 0 40 40 40 40 40 80 20 20";
  create("voxel.vtu")
      << R"(<?xml version="1.0"?><VTKFile type="UnstructuredGrid" version="0.1" )"
      << R"(byte_order="LittleEndian"><UnstructuredGrid><Piece NumberOfPoints="9" )"
      << R"(NumberOfCells="2"><Points><DataArray type="Float64" NumberOfComponents="3" )"
      << R"(format="ascii">)" << points << R"(</DataArray></Points><Cells>)"
      << R"(<DataArray type="Int64" Name="connectivity" format="ascii">0 1 2 3 4 5 6 7 1 3 5 8)"
      << R"(</DataArray><DataArray type="Int64" Name="offsets" format="ascii">8 12</DataArray>)"
      << R"(<DataArray type="UInt8" Name="types" format="ascii">11 10</DataArray></Cells>)"
      << "</Piece></UnstructuredGrid></VTKFile>";
  create("voxel.vtk") << "# vtk DataFile Version 3.0\nmade here\nASCII\n"
                      << "DATASET UNSTRUCTURED_GRID\nPOINTS 9 double\n"
                      << points << "\nCELLS 2 14\n8 0 1 2 3 4 5 6 7\n4 1 3 5 8\n"
                      << "CELL_TYPES 2\n11\n10\n";
  for (const char* name : {"voxel.vtu", "voxel.vtk"})
    expectBadInput([&] { convert(name); }, {name, "1 of kind voxel"});
}

/// One tetrahedron for a .su2 file.
constexpr const char* su2_tetrahedron =
    "NDIME= 3\nNELEM= 1\n10 0 1 2 3 0\nNPOIN= 4\n0 0 0 0\n1 0 0 1\n0 1 0 2\n0 0 1 3\n"
    "NMARK= 1\nMARKER_TAG= base\nMARKER_ELEMS= 1\n5 0 1 2\n";

TEST_F(MeshConversion, SaysWhatMeshioLeavesOut) {
  create("named.su2") << su2_tetrahedron;
  EXPECT_EQ(convert("named.su2").tetrahedra.size(), 1u);
  EXPECT_THAT(notes, Contains(HasSubstr("meshio: ")));
}

TEST_F(MeshConversion, ReordersMidEdgeNodesOfAnotherProgram) {
  for (auto& middles : body.mid_edge_nodes) std::swap(middles[4], middles[5]);
  writeByMeshio("mixed-up.vtu");
  convert("mixed-up.vtu");
  EXPECT_THAT(notes, Contains(HasSubstr("in Gmsh's order")));
}

TEST_F(MeshConversion, RefusesCurvedEdgesUnlessOnlyCornersAreRequested) {
  body.nodes[body.mid_edge_nodes[3][2]] += Eigen::Vector3d(0.01, 0, 0);
  writeByMeshio("curved.vtu");
  expectBadInput([&] { convert("curved.vtu"); },
                 {"curved.vtu: tetrahedron ", "curved edge at (", "--straight"});
  const Mesh mesh = convert("curved.vtu", {.straight = true});
  EXPECT_THAT(notes, Contains(HasSubstr("only the corners are used")));
  EXPECT_FALSE(hasTenNodesEach());
  EXPECT_NEAR(measure(mesh).volume, 2, 1e-9);
}

/// One tetrahedron for an .inp file, followed by further lines.
constexpr const char* one_tetrahedron =
    "*NODE\n1, 0,0,0\n2, 1,0,0\n3, 0,1,0\n4, 0,0,1\n5, 1,1,1\n"
    "*ELEMENT, TYPE=C3D4, ELSET=Liver\n1, 1,2,3,4\n2, 2,5,3,4\n";

TEST_F(MeshConversion, KeepsNodeAndElementSetsOfOneNameApart) {
  create("body.inp") << one_tetrahedron
                     << "*NSET, NSET=FIXED\n1, 2, 3\n*ELSET, ELSET=Fixed\n2\n*ELSET, ELSET=FIXED\n";
  const Mesh mesh = convert("body.inp");
  EXPECT_EQ(mesh.node_groups.at("FIXED").size(), 3u);
  EXPECT_EQ(mesh.element_groups.at("Fixed").size(), 1u) << "names differ by more than capitals";
  create("both.inp") << one_tetrahedron << "*NSET, NSET=FIXED\n1, 2, 3\n*ELSET, ELSET=FIXED\n2\n";
  const Mesh both = convert("both.inp");
  EXPECT_EQ(both.node_groups.at("FIXED").size(), 3u);
  EXPECT_EQ(both.element_groups.at("FIXED elements").size(), 1u);
  EXPECT_THAT(notes, Contains(HasSubstr("a set of nodes has the same name")));
}

TEST_F(MeshConversion, ReadsAbaqusNumbersWithinTheirPart) {
  const auto write = [this](const char* more) {
    create("assembly.inp")
        << "*PART, NAME=Organ\n"
        << one_tetrahedron
        << "*NSET, NSET=Fix\n1,2,3\n*END PART\n"
           "*PART, NAME=Tool\n*NODE\n1, 9,9,9\n2, 9,9,8\n3, 9,8,9\n"
           "*ELEMENT, TYPE=R3D3\n7, 1,2,3\n*END PART\n"
           "*ASSEMBLY, NAME=All\n*INSTANCE, NAME=Organ-1, PART=Organ\n0., 0., 0.\n*END INSTANCE\n"
           "*INSTANCE, NAME=Tool-1, PART=Tool\n0., 0., 5.\n*END INSTANCE\n"
           "*NODE\n1, 20,20,20\n*NSET, NSET=Top, INSTANCE=Organ-1\n3, 4\n"
           "*NSET, NSET=Nobody\n77\n*END ASSEMBLY\n"
        << more;
  };
  write("*NSET, NSET=of, ELSET=LIVER\n");
  const Mesh mesh = convert("assembly.inp");
  EXPECT_EQ(mesh.tetrahedra.size(), 2u);
  for (const std::int32_t node : mesh.node_groups.at("Fix")) EXPECT_LT(mesh.nodes[node].norm(), 2);
  EXPECT_EQ(mesh.node_groups.at("Fix").size(), 3u);
  EXPECT_EQ(mesh.node_groups.at("Top").size(), 2u);
  EXPECT_EQ(mesh.node_groups.at("of").size(), 5u);
  EXPECT_THAT(notes, Contains(HasSubstr("\"Nobody\" names 1 missing node")));
  write(
      "*PART, NAME=Second\n*NODE\n1, 0,0,0\n2, 1,0,0\n3, 0,1,0\n4, 0,0,1\n"
      "*ELEMENT, TYPE=C3D4\n1, 1,2,3,4\n*END PART\n");
  expectBadInput([&] { convert("assembly.inp"); }, {"tetrahedra in 2 parts", "export one"});
}

TEST_F(MeshConversion, MergesRepeatedAbaqusNodesAtOnePlace) {
  create("again.inp") << "*NODE\n1, 0,0,0\n2, 1,0,0\n3, 0,1,0\n4, 0,0,1\n"
                         "*ELEMENT, TYPE=C3D4\n1, 1,2,3,4\n"
                         "*NODE\n2, 1,0,0\n3, 0,1,0\n4, 0,0,1\n5, 1,1,1\n"
                         "*ELEMENT, TYPE=C3D4\n2, 2,5,3,4\n";
  const Mesh mesh = convert("again.inp");
  EXPECT_EQ(mesh.nodes.size(), 5u);
  EXPECT_EQ(mesh.surface.size(), 6u) << "the two share a face";
}

TEST_F(MeshConversion, RefusesAnAbaqusFileThatEndsInsideAnElementOrNeedsAnother) {
  create("cut.inp") << one_tetrahedron << "3, 5, 3";
  expectBadInput([&] { convert("cut.inp"); }, {"cut.inp:10: element 3 has 2 nodes"});
  create("more.inp") << one_tetrahedron << "*NSET, NSET=base, INPUT=nodes.txt\n";
  expectBadInput([&] { convert("more.inp"); }, {"more.inp:10: INPUT=nodes.txt is not read"});
  create("twice.inp") << one_tetrahedron << "*NODE\n2, 5,5,5\n";
  expectBadInput([&] { convert("twice.inp"); }, {"twice.inp:11: node 2 is defined twice"});
}

TEST_F(MeshConversion, CorrectsRoundedMidEdgeNodes) {
  for (Eigen::Vector3d& node : body.nodes)
    node = (node + Eigen::Vector3d(312, -205, 1151)).cast<float>().cast<double>();
  writeByMeshio("rounded.vtu");
  EXPECT_NEAR(measure(convert("rounded.vtu")).volume, 2, 1e-3);
  EXPECT_THAT(notes, Contains(HasSubstr("mid-edge nodes were rounded")));
}

TEST_F(MeshConversion, ExecutesNothingFromTheCurrentFolder) {
  test::writeStl(test::sphereSurface(40, 3), directory / "a.stl");
  create("numpy.py") << "raise SystemExit('this is of somebody else')\n";
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(directory.path());
  EXPECT_FALSE(convertMesh("a.stl", directory.path()).is_volume);
  std::filesystem::current_path(before);
}

TEST_F(MeshConversion, ReportsAnUnwritableOutput) {
  test::writeStl(test::sphereSurface(40, 3), directory / "a.stl");
  std::filesystem::create_symlink("/dev/full", directory / "converted.msh");
  test::expectError(ExitCode::failed, [&] { converted("a.stl"); },
                    {"converted.msh: cannot be written: No space left", "TMPDIR"});
}

TEST_F(MeshConversion, TriangulatesNonConvexPolygons) {
  // A prism with L-shaped ends, starting from each of its corners.
  for (int first = 0; first < 6; ++first) {
    std::ofstream out = create("prism.obj");
    for (const int z : {0, 1})
      for (const auto& [x, y] : {std::pair(0, 0), {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}})
        out << "v " << x << " " << y << " " << z << "\n";
    for (const bool top : {false, true}) {
      out << "f";
      for (int i = 0; i < 6; ++i)
        out << " " << 1 + (top ? 6 + (first + i) % 6 : (first + 5 - i) % 6);
      out << "\n";
    }
    for (int i = 0; i < 6; ++i)
      out << "f " << i + 1 << " " << (i + 1) % 6 + 1 << " " << (i + 1) % 6 + 7 << " " << i + 7
          << "\n";
    out.close();
    const ClosedSurface surface = surfaceOf(directory / "prism.obj");
    EXPECT_DOUBLE_EQ(surface.volume, 3) << first;
    EXPECT_EQ(surface.triangles.size(), 20u);
  }
}

TEST_F(MeshConversion, RecognisesABinaryStlWhateverItsHeader) {
  test::writeBinaryStl(test::sphereSurface(40, 3), directory / "a.stl");
  std::string bytes = readText(directory / "a.stl", "surface");
  bytes.replace(0, 6, "solid ");
  create("more.stl") << bytes << "xy";
  EXPECT_FALSE(converted("more.stl").is_volume);
  create("cut.stl") << bytes.substr(0, bytes.size() - 500);
  expectBadInput([&] { converted("cut.stl"); }, {"cut.stl: it announces", "truncated"});
}

TEST_F(MeshConversion, ReadsTextStlWithSeveralSolidsCapitalsAndBlanks) {
  create("solids.stl") << "solid a\nvertex 0 0 0\nvertex 0 1 0\nvertex 1 0 0\n"
                          "vertex 0 0 0\nvertex 1 0 0\nvertex 0 0 1\nendsolid a\n\n"
                          "SOLID B\r\nVERTEX 0 0 0\r\nVERTEX 0 0 1\r\nVERTEX 0 1 0\r\n"
                          "VERTEX 1 0 0\r\nVERTEX 0 1 0\r\nVERTEX 0 0 1\r\n  ENDSOLID B  \r\n\r\n";
  EXPECT_DOUBLE_EQ(surfaceOf(directory / "solids.stl").volume, 1.0 / 6);
}

TEST_F(MeshConversion, RefusesVectorsOfTetrahedraThatShareANumber) {
  const char* const two_tetrahedra =
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n"
      "5 1 1 1\n$EndNodes\n$Elements\n2\n1 4 2 1 1 1 2 3 4\n1 4 2 1 1 2 5 3 4\n$EndElements\n";
  create("one.msh") << two_tetrahedra;
  EXPECT_EQ(convert("one.msh").tetrahedra.size(), 2u);
  create("data.msh") << two_tetrahedra
                     << "$ElementData\n1\n\"f\"\n1\n0\n3\n0\n3\n1\n1 0 0 1\n$EndElementData\n";
  expectBadInput(
      [&] { convert("data.msh"); },
      {"data.msh:17: $ElementData cannot be assigned: two tetrahedra have the number 1"});
}

TEST_F(MeshConversion, ReadsSurfacesOfEveryFormatToTheSameTriangles) {
  const TriangleSoup sphere = test::sphereSurface(40, 3);
  test::writeStl(sphere, directory / "a.stl");
  test::writeBinaryStl(sphere, directory / "b.STL");
  test::writeObj(sphere, directory / "c.obj");
  test::writeOff(sphere, directory / "d.off");
  test::writePly(sphere, directory / "e.ply");
  for (const char* name : {"a.stl", "b.STL", "c.obj", "d.off", "e.ply"}) {
    SCOPED_TRACE(name);
    const ClosedSurface surface = surfaceOf(directory / name);
    EXPECT_EQ(surface.points.size(), sphere.points.size());
    EXPECT_EQ(surface.triangles.size(), sphere.triangles.size());
    EXPECT_NEAR(surface.volume, closedSurface(sphere, "", Bodies::only).volume, 0.05);
  }
}

TEST_F(MeshConversion, ReadsOffWithItsCountsInTheFirstLine) {
  for (const char* first : {"OFF 4 4 6", "OFF4 4 6", "OFF\n4 4 6"}) {
    create("first.off") << first
                        << "\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
                           "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
    EXPECT_DOUBLE_EQ(surfaceOf(directory / "first.off").volume, 1.0 / 6) << first;
  }
}

TEST_F(MeshConversion, TriangulatesPolygonsAndReadsNegativeObjIndices) {
  create("cube.obj") << "v 0 0 0 1 1 1\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\n"
                        "v 0 1 1\ng sides\nf 4 3 2 1\nf -4 -3 -2 -1\nf 1 2 6 5\nf 2 3 7 6\n"
                        "f 3 4 8 7\nf 4 1 5 8\n";
  const ClosedSurface surface = surfaceOf(directory / "cube.obj");
  EXPECT_EQ(surface.triangles.size(), 12u);
  EXPECT_DOUBLE_EQ(surface.volume, 1);
  EXPECT_THAT(surface.notes, ::testing::IsEmpty());
}

/// Two tetrahedra for a .mesh file, and markings.
constexpr const char* medit_tetrahedra =
    "MeshVersionFormatted 2\nDimension 3\nVertices\n5\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n"
    "1 1 1 0\nRequiredVertices\n1\n2\nNormals\n1\n0 0 -1\nTetrahedra 2\n1 2 3 4 7\n2 5 3 4 8\n"
    "RequiredEdges\n1\n1\nEnd\n";
/// One tetrahedron for a .feb file.
constexpr const char* febio_tetrahedron =
    "<?xml version=\"1.0\"?>\n<febio_spec version=\"4.0\"><Mesh><Nodes><node id=\"1\">0,0,0</node>"
    "<node id=\"2\">1,0,0</node><node id=\"3\">0,1,0</node><node id=\"4\">0,0,1</node></Nodes>"
    "<Elements type=\"tet4\" name=\"Part\"><elem id=\"7\">1,2,3,4</elem></Elements></Mesh>"
    "</febio_spec>\n";

TEST_F(MeshConversion, ReadsMeditAndIgnoresMarkings) {
  create("marked.mesh") << medit_tetrahedra;
  const Mesh mesh = convert("marked.mesh");
  EXPECT_EQ(mesh.tetrahedra.size(), 2u);
  EXPECT_EQ(mesh.element_groups.at("ref 8").size(), 1u);
  create("cut.mesh") << "MeshVersionFormatted 2\nDimension 3\nVertices\n4\n0 0 0 0\n1 0 0 0\n0 1";
  expectBadInput([&] { convert("cut.mesh"); }, {"cut.mesh:5: expected 16 numbers, found 10"});
}

TEST_F(MeshConversion, SkipsAByteOrderMarkInEveryTextFormat) {
  const TriangleSoup sphere = test::sphereSurface(40, 3);
  test::writeStl(sphere, directory / "a.stl");
  test::writeObj(sphere, directory / "c.obj");
  test::writeOff(sphere, directory / "d.off");
  test::writePly(sphere, directory / "e.ply");
  create("f.inp") << one_tetrahedron;
  test::writeGmsh22(test::tetrahedronMesh(), directory / "g.msh");
  create("h.mesh") << medit_tetrahedra;
  create("i.feb") << febio_tetrahedron;
  create("k.su2") << su2_tetrahedron;
  for (const char* name : {"l.vtk", "m.vtu"}) writeByMeshio(name, ", binary=False");
  writeByMeshio("n.bdf");
  for (const std::string name : {"a.stl", "c.obj", "d.off", "e.ply", "f.inp", "g.msh", "h.mesh",
                                 "i.feb", "k.su2", "l.vtk", "m.vtu", "n.bdf"}) {
    SCOPED_TRACE(name);
    const std::string plain = readText(directory / name, "mesh");
    create(name) << "\xEF\xBB\xBF" << plain;
    EXPECT_NO_THROW(converted(name));
    if (name >= "k") continue;  // meshio and the XML parser refuse it in their own words
    create(name) << "\xFF\xFE" << plain;
    expectBadInput([&] { converted(name); }, {name, "UTF-16"});
  }
}

TEST_F(MeshConversion, ReadsAbaqusRangesInBothDirections) {
  const auto fixed = [this](const char* range) {
    create("range.inp") << one_tetrahedron << "*NSET, NSET=FIX,\nGENERATE\n" << range << "\n";
    return convert("range.inp").node_groups.at("FIX").size();
  };
  EXPECT_EQ(fixed("1, 4"), 4u);
  EXPECT_EQ(fixed("5, 1, -1"), 5u);
  EXPECT_EQ(fixed("5, 1, -2"), 3u);
  create("comma.inp") << one_tetrahedron << "*NSET, NSET=FIX,\n1, 2, 3\n";
  EXPECT_EQ(convert("comma.inp").node_groups.at("FIX").size(), 3u) << "an extra comma";
  expectBadInput([&] { fixed("4, 1, 1"); }, {"range.inp:12: GENERATE from 4 to 1 by 1"});
}

TEST_F(MeshConversion, LeavesOutAbaqusElementsWithoutAContinuumWithANote) {
  create("more.inp") << one_tetrahedron << "*ELEMENT, TYPE=MASS, ELSET=M\n99, 1\n"
                     << "*ELEMENT, TYPE=CONN3D2\n98, 1, 2\n*ELEMENT, TYPE=SPRING1\n97, 1\n";
  EXPECT_EQ(convert("more.inp").tetrahedra.size(), 2u);
  EXPECT_THAT(notes, Contains(HasSubstr("type CONN3D2 are omitted")));
  for (const std::string type : {"C3D27", "SC8R", "COH3D8"}) {
    create("worse.inp") << one_tetrahedron << "*ELEMENT, TYPE=" << type << "\n99, 1\n";
    expectBadInput([&] { convert("worse.inp"); }, {"elements of type " + type + " are not read"});
  }
}

TEST_F(MeshConversion, FollowsFebioFilesAndRanges) {
  const auto spec = [this](const char* name, const std::string& inside) {
    create(name) << "<?xml version=\"1.0\"?>\n<febio_spec version=\"4.0\">" << inside
                 << "</febio_spec>\n";
  };
  spec("mesh.feb",
       "<Mesh><Nodes><node id=\"1\">0,0,0</node><node id=\"2\">1,0,0</node>"
       "<node id=\"3\">0,1,0</node><node id=\"4\">0,0,1</node></Nodes>"
       "<Elements type=\"tet4\" name=\"Part\"><elem id=\"7\">1,2,3,4</elem></Elements>"
       "<NodeSet name=\"Fix\">1:3</NodeSet><NodeSet name=\"Odd\">1:4:2</NodeSet>"
       "<ElementSet name=\"Tumour\">7:7</ElementSet></Mesh>");
  spec("from.feb", "<Mesh from=\"mesh.feb\"/>");
  spec("include.feb", "<Include>mesh.feb</Include>");
  for (const char* name : {"mesh.feb", "from.feb", "include.feb"}) {
    const Mesh mesh = convert(name);
    EXPECT_EQ(mesh.node_groups.at("Fix").size(), 3u) << name;
    EXPECT_EQ(mesh.node_groups.at("Odd").size(), 2u) << name;
    EXPECT_EQ(mesh.element_groups.at("Tumour").size(), 1u) << name;
  }
  spec("gone.feb", "<Include>nowhere.feb</Include>");
  expectBadInput([&] { convert("gone.feb"); }, {"gone.feb:2: there is no file", "nowhere.feb"});
  spec("round.feb", "<Include>round.feb</Include>");
  expectBadInput([&] { convert("round.feb"); }, {"round.feb:2", "includes itself"});
}

TEST_F(MeshConversion, SplitsPlyStripsIntoTriangles) {
  create("strips.ply") << "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\n"
                          "property float y\nproperty float z\nelement tristrips 1\n"
                          "property list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n"
                          "0 0 1\n7 0 2 1 3 0 2 -1\n";
  const ClosedSurface surface = surfaceOf(directory / "strips.ply");
  EXPECT_EQ(surface.triangles.size(), 4u);
  EXPECT_NEAR(surface.volume, 1.0 / 6, 1e-12);
}

/// Meshes from reports, and the expected result of reading each.
struct Reported {
  std::size_t tetrahedra;
  const char* group;
  std::size_t of_group;  ///< nodes
  std::vector<const char*> names;
};

TEST_F(MeshConversion, ReadsSoundFilesFromReports) {
  PALPATE_NEEDS(test::hasProgram("gmsh"), "gmsh");
  PALPATE_REFERENCE_FILE(reports, "cases/reports");
  const std::vector<Reported> sound = {
      {1, nullptr, 0, {"k24_mmg.mesh", "k25_avs.inp"}},
      {2, nullptr, 0, {"k05_alike.msh", "k05_mixed.msh"}},
      {6,
       nullptr,
       0,
       {"k06_string.vtu", "k06_string_ascii.vtk", "k06_string_bin.vtk", "k14_lz4.vtu",
        "k23_lagrange1.vtu", "K25.NODE", "K25.ELE", "k11_bom.ele", "k11_bom.inp", "k11_bom.msh",
        "k11_bom.node", "k22_mass.inp"}},
      {6,
       "label 1",
       7,
       {"k06_double.vtu", "k06_double_ascii.vtk", "k06_double_bin.vtk", "k06_idtype.vtu",
        "k06_idtype_ascii.vtk", "k06_idtype_bin.vtk", "k06_int.vtu", "k06_int_ascii.vtk",
        "k06_int_bin.vtk", "k06_uchar.vtu", "k06_uchar_ascii.vtk", "k06_uchar_bin.vtk"}},
      {6, "FIX", 4, {"k08_down.inp", "k08_up.inp", "k13_nset.inp"}},
      {6, "Fix", 4, {"k12_range.feb", "k22_qualified.inp"}},
      {6, "Part", 8, {"k12_from.feb", "k12_include.feb"}},
      {6, "Tumour", 6, {"k12_range_elements.feb"}},
      {6, "LIVER", 8, {"k13_goes_on.inp"}},
      {24, "CellEntityIds 1", 14, {"k07_gmsh_bin.vtk"}},
      {24, "fixed", 5, {"k10_parametric.msh", "k18_v40.msh"}}};
  for (const Reported& report : sound)
    for (const char* name : report.names) {
      SCOPED_TRACE(name);
      const ConvertedMesh made = convertMesh(reports / name, directory.path());
      ASSERT_TRUE(made.is_volume);
      const Mesh mesh = readGmsh(made.file);
      EXPECT_EQ(mesh.tetrahedra.size(), report.tetrahedra);
      if (!report.group) continue;
      ASSERT_THAT(mesh.node_groups, Contains(::testing::Key(report.group)));
      EXPECT_EQ(mesh.node_groups.at(report.group).size(), report.of_group);
    }
  for (const char* name : {"k11_bom.obj", "k11_bom.off", "k11_bom.stl", "k19_strips.ply"})
    EXPECT_FALSE(convertMesh(reports / name, directory.path()).is_volume) << name;
  EXPECT_THAT(surfaceOf(reports / "k16_specks.stl").cavities, IsEmpty());
  EXPECT_EQ(surfaceOf(reports / "k16_specks.stl").triangles.size(), 512u);
  EXPECT_EQ(surfaceOf(reports / "k20_gaps.stl").points.size(), 66u);
  EXPECT_EQ(surfaceOf(reports / "k15_flat.stl").triangles.size(), 14u);
  for (const char* name : {"k09_names.msh", "k09_saveall.msh"})
    EXPECT_THAT(convertMesh(reports / name, directory.path()).notes,
                Contains(HasSubstr("\"fixed\"")));
  expectBadInput([&] { convertMesh(reports / "k08_none.inp", directory.path()); },
                 {"k08_none.inp:18", "makes no member"});
  expectBadInput([&] { convertMesh(reports / "k25_empty.obj", directory.path()); },
                 {"k25_empty.obj: there is no vertex"});
  for (const char* name : {"k02_voxel.vtu", "k02_voxel.vtk"})
    expectBadInput([&] { convertMesh(reports / name, directory.path()); },
                   {name, "1 of kind voxel"});
  for (const char* name : {"k05_folded.msh", "k05_folded2.msh"})
    expectBadInput([&] { readGmsh(reports / name); }, {name, "same side"});
}

TEST_F(MeshConversion, JoinsReportedLayersByWelding) {
  PALPATE_REFERENCE_FILE(reports, "cases/reports");
  EXPECT_EQ(measure(readGmsh(reports / "k01_layers.msh")).pieces, 2);
  const Mesh welded =
      readGmsh(convertMesh(reports / "k01_layers.msh", directory.path(), {.weld = true}).file);
  const Mesh sound = readGmsh(reports / "k01_welded.msh");
  EXPECT_EQ(measure(welded).pieces, 1);
  EXPECT_EQ(welded.nodes.size(), sound.nodes.size());
  EXPECT_EQ(welded.surface.size(), sound.surface.size());
}

}  // namespace
}  // namespace palpate
