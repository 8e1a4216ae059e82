#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "common/mesh/mesh_reader.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/reference_data.hpp"
#include "tests/support/temporary_directory.hpp"

namespace palpate {
namespace {

using test::expectBadInput;
using ::testing::ElementsAre;
using ::testing::Key;

constexpr const char* tetrahedron_22 = R"($MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
2
2 7 "the base"
3 7 "body"
$EndPhysicalNames
$Nodes
5
10 0 0 0
20 1e-1 0 0
7 0 +0.1 0
1000000007 0 0 .1
3 9 9 9
$EndNodes
$Elements
3
1 15 2 0 1 10
2 2 2 7 1 10 20 7
3 4 2 7 1 10 20 7 1000000007
$EndElements
)";

constexpr const char* tetrahedron_41 = R"($MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
2
2 7 "the base"
3 7 "body"
$EndPhysicalNames
$Entities
1 1 1 1
5 0 0 0 0
6 0 0 0 1 0 0 0 2 5 -5
2 0 0 0 1 1 0 2 7 -8 1 6
9 0 0 0 1 1 1 1 7 1 2
$EndEntities
$Nodes
3 4 7 1000000007
0 5 0 1
10
0 0 0
2 2 1 2
20
7
0.1 0 0 0.5 0.25
0 0.1 0 0.5 0.75
3 9 0 1
1000000007
0 0 0.1
$EndNodes
$Elements
2 2 1 2
2 2 2 1
1 10 20 7
3 9 4 1
2 10 20 7 1000000007
$EndElements
)";

class GmshReader : public ::testing::Test {
 protected:
  static Mesh read(const std::string& text, double metres_per_unit = 1) {
    return parseGmsh(text, "body.msh", metres_per_unit);
  }

  void refuses(std::string text, const std::string& what, const std::string& instead,
               std::initializer_list<std::string> words) {
    text.replace(text.find(what), what.size(), instead);
    expectBadInput([&] { read(text); }, words);
  }

  /// A file that is cut anywhere is refused or, if only its last line end is missing, read as
  /// before.
  void survivesEveryCut(const std::string& text) {
    for (std::size_t length = 0; length < text.size(); ++length) {
      const bool is_whole = length + 1 == text.size();
      if (is_whole)
        EXPECT_EQ(read(text.substr(0, length)).tetrahedra.size(), 1u);
      else
        expectBadInput([&] { read(text.substr(0, length)); }, {"body.msh"});
    }
  }

  /// A file with any byte changed is refused with its name, or is still a mesh.
  void survivesEveryByte(const std::string& original, const std::string& others) {
    for (std::size_t at = 0; at < original.size(); ++at)
      for (const char wrong : others) {
        std::string text = original;
        text[at] = wrong;
        try {
          EXPECT_GE(read(text).tetrahedra.size(), 1u) << at;
        } catch (const Error& error) {
          EXPECT_NE(std::string(error.what()).find("body.msh"), std::string::npos) << error.what();
        }
      }
  }

  test::TemporaryDirectory directory;
};

void expectSameMesh(const Mesh& a, const Mesh& b) {
  EXPECT_EQ(a.nodes, b.nodes);
  EXPECT_EQ(a.tetrahedra, b.tetrahedra);
  EXPECT_EQ(a.surface, b.surface);
}

TEST_F(GmshReader, ReadsBothVersionsToTheSameMesh) {
  for (const char* text : {tetrahedron_22, tetrahedron_41}) {
    const Mesh mesh = read(text);
    EXPECT_THAT(mesh.nodes, ElementsAre(Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0.1, 0, 0),
                                        Eigen::Vector3d(0, 0.1, 0), Eigen::Vector3d(0, 0, 0.1)));
    EXPECT_THAT(mesh.tetrahedra, ElementsAre(Tetrahedron{0, 1, 2, 3}));
    EXPECT_THAT(mesh.node_groups.at("the base"), ElementsAre(0, 1, 2));
    EXPECT_THAT(mesh.node_groups.at("body"), ElementsAre(0, 1, 2, 3));
  }
}

TEST_F(GmshReader, DropsOrphanNodesAndCountsThem) {
  EXPECT_EQ(read(tetrahedron_22).dropped_nodes, 1);
}

TEST_F(GmshReader, GivesAnEntityAllItsPhysicalGroupsAndNamesTheNamelessByDimension) {
  EXPECT_THAT(read(tetrahedron_41).node_groups,
              ElementsAre(Key("body"), Key("surface 8"), Key("the base")));
}

TEST_F(GmshReader, ReadsWhatItWroteBitForBit) {
  const Mesh mesh = test::distortedBoxMesh({0.1, 0.2, 0.3}, {2, 3, 4});
  test::writeGmsh22(mesh, directory / "22.msh");
  test::writeGmsh41(mesh, directory / "41.msh");
  for (const char* file : {"22.msh", "41.msh"}) {
    const Mesh again = readGmsh(directory / file);
    expectSameMesh(again, mesh);
    EXPECT_EQ(again.node_groups.at("xmin"), mesh.node_groups.at("xmin"));
    EXPECT_EQ(again.node_groups.at("body").size(), mesh.nodes.size());
  }
}

TEST_F(GmshReader, ReadsWindowsLineEnds) {
  for (const std::string text : {tetrahedron_22, tetrahedron_41}) {
    std::string windows;
    for (const char c : text) windows += c == '\n' ? std::string("\r\n") : std::string(1, c);
    expectSameMesh(read(windows), read(text));
  }
}

TEST_F(GmshReader, DoesNotDependOnTheLocale) {
  const char* used = std::setlocale(LC_ALL, "de_DE.UTF-8");
  expectSameMesh(read(tetrahedron_22), read(tetrahedron_41));
  EXPECT_EQ(read(tetrahedron_22).nodes[1][0], 0.1)
      << "locale " << (used ? used : "C: de_DE.UTF-8 is not installed");
  std::setlocale(LC_ALL, "C");
}

TEST_F(GmshReader, MillimetresBecomeTheSameDoublesAsMetres) {
  std::string text = tetrahedron_22;
  for (const auto& [metres, millimetres] :
       {std::pair{"1e-1", "100"}, {"+0.1", "100"}, {" .1", " 100"}})
    text.replace(text.find(metres), std::string(metres).size(), millimetres);
  expectSameMesh(read(text, 0.001), read(tetrahedron_22));
}

TEST_F(GmshReader, ReadsAnElementOfTwoPhysicalGroupsOnce) {
  std::string text = tetrahedron_22;
  text.replace(text.find("$Elements\n3"), 11, "$Elements\n4");
  text.insert(text.find("$EndElements"), "4 4 2 9 1 10 20 7 1000000007\n");
  const Mesh mesh = read(text);
  EXPECT_EQ(mesh.tetrahedra.size(), 1u);
  EXPECT_EQ(mesh.node_groups.at("volume 9").size(), 4u);
}

TEST_F(GmshReader, SkipsSectionsItDoesNotNeed) {
  std::string text = tetrahedron_41;
  text.insert(text.find("$Nodes"), "$Periodic\n0\n$EndPeriodic\n");
  text += "$NodeData\nanything\n$EndNodeData\n";
  EXPECT_EQ(read(text).tetrahedra.size(), 1u);
}

TEST_F(GmshReader, SurvivesACutAtEveryByte) {
  survivesEveryCut(tetrahedron_22);
  survivesEveryCut(tetrahedron_41);
}

TEST_F(GmshReader, RefusesATruncatedFileNamingTheLine) {
  const std::string text = tetrahedron_22;
  expectBadInput([&] { read(text.substr(0, text.find("7 0 +0.1"))); },
                 {"body.msh:12", "truncated", "$Nodes"});
}

TEST_F(GmshReader, RefusesAMissingFileOrADirectory) {
  expectBadInput([&] { readGmsh(directory / "nothing.msh"); }, {"nothing.msh", "No such file"});
  expectBadInput([&] { readGmsh(directory.path()); }, {"directory"});
}

TEST_F(GmshReader, RefusesOtherFormatsSayingHowToConvert) {
  refuses(tetrahedron_22, "2.2 0 8", "4.0 0 8",
          {"body.msh:2", "version 4", "palpate mesh body.msh -o "});
  refuses(tetrahedron_22, "2.2 0 8", "2.2 1 8",
          {"body.msh:2", "binary", "palpate mesh body.msh -o "});
  expectBadInput([&] { read("solid cube\n"); }, {"body.msh:1", "not a Gmsh", "palpate mesh"});
  expectBadInput([&] { read(""); }, {"empty"});
}

TEST_F(GmshReader, RefusesInconsistentFilesNamingTheLine) {
  refuses(tetrahedron_22, "1 10 20 7 1000000007", "1 10 20 7 8",
          {"body.msh:21", "node 8", "not in $Nodes"});
  refuses(tetrahedron_22, "7 0 +0.1", "10 0 +0.1", {"node 10 is defined twice"});
  refuses(tetrahedron_22, "1e-1", "1,5", {"body.msh:12", "\"1,5\"", "a coordinate"});
  refuses(tetrahedron_22, "1e-1", "nan", {"body.msh:12", "not finite"});
  refuses(tetrahedron_22, "$Nodes\n5", "$Nodes\n4", {"body.msh:15", "$EndNodes"});
  refuses(tetrahedron_22, "$Nodes\n5", "$Nodes\n99999999999", {"body.msh:10", "99999999999"});
  refuses(tetrahedron_22, "3 4 2 7", "3 77 2 7", {"body.msh:21", "type 77"});
  refuses(tetrahedron_22, "3 4 2 7", "3 4 2 -9223372036854775808",
          {"body.msh:21", "-9223372036854775808", "physical group"});
  refuses(tetrahedron_41, "3 4 7 1000000007", "3 5 7 1000000007", {"5 nodes were announced", "4"});
}

TEST_F(GmshReader, RefusesVolumeElementsThatAreNotTetrahedra) {
  refuses(tetrahedron_22, "3 4 2 7", "3 29 2 7",
          {"body.msh:21", "20 nodes", "tetrahedra with 4 or 10 nodes", "-order 1 or 2"});
}

/// Two ten-node tetrahedra in Gmsh's order, the second in the group "vessel", and a six-node
/// triangle.
constexpr const char* quadratic_22 = R"($MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
2
2 7 "the base"
3 9 "vessel"
$EndPhysicalNames
$Nodes
14
1 0 0 0
2 2 0 0
3 0 2 0
4 0 0 2
5 1 0 0
6 1 1 0
7 0 1 0
8 0 0 1
9 0 1 1
10 1 0 1
11 2 2 2
12 2 1 1
13 1 2 1
14 1 1 2
$EndNodes
$Elements
3
1 9 2 7 1 1 2 3 5 6 7
5 11 2 8 1 1 2 3 4 5 6 7 8 9 10
7 11 2 9 1 2 3 4 11 6 9 10 12 14 13
$EndElements
$ElementData
1
"direction"
1
0.5
3
0
3
2
7 0 0 -2
5 1 2 +3
$EndElementData
)";

/// The same in version 4.1, which lists the numbers of all nodes before their positions.
std::string quadraticOf41() {
  const std::string older = quadratic_22;
  std::istringstream nodes(older.substr(older.find("1 0 0 0")));
  std::string numbers, places, place;
  for (int n = 1; n <= 14; ++n) {
    numbers += std::to_string(n) + "\n";
    nodes >> place >> std::ws;
    std::getline(nodes, place);
    places += place + "\n";
  }
  return R"($MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
2
2 7 "the base"
3 9 "vessel"
$EndPhysicalNames
$Entities
0 0 1 2
2 0 0 0 1 1 0 1 7 0
1 0 0 0 1 1 1 0 0
2 0 0 0 1 1 1 1 9 0
$EndEntities
$Nodes
1 14 1 14
3 1 0 14
)" + numbers +
         places + R"($EndNodes
$Elements
3 3 1 7
2 2 9 1
1 1 2 3 5 6 7
3 1 11 1
5 1 2 3 4 5 6 7 8 9 10
3 2 11 1
7 2 3 4 11 6 9 10 12 14 13
$EndElements
)" + older.substr(older.find("$ElementData"));
}

TEST_F(GmshReader, GivesPositionsOfErrorsInTheUnitOfTheFile) {
  const std::string begin =
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n8\n1 0 0 0\n2 30 0 0\n3 0 30 0\n4 0 0 30\n"
      "5 1 1 -1\n6 31 1 -1\n7 1 31 -1\n8 1 1 29\n$EndNodes\n$Elements\n2\n1 4 0 1 2 3 4\n";
  for (const auto& [second, what, place] :
       {std::tuple("2 4 0 1 2 3 8", "same side", "centre at (7.5, 7.5, 7.5))"),
        std::tuple("2 4 0 5 6 7 8", "overlap", "at (10, 10, 0):")})
    expectBadInput([&] { read(begin + second + "\n$EndElements\n", 0.001); }, {what, place});
}

TEST_F(GmshReader, ReadsTenNodeTetrahedraAsLinearWithGroupsAndVectors) {
  for (const std::string& text : {std::string(quadratic_22), quadraticOf41()}) {
    const Mesh mesh = read(text, 0.001);
    EXPECT_EQ(mesh.nodes.size(), 5u);
    EXPECT_EQ(mesh.nodes[4], Eigen::Vector3d(0.002, 0.002, 0.002));
    EXPECT_THAT(mesh.tetrahedra, ElementsAre(Tetrahedron{0, 1, 2, 3}, Tetrahedron{1, 2, 3, 4}));
    EXPECT_THAT(mesh.node_groups.at("the base"), ElementsAre(0, 1, 2));
    EXPECT_THAT(mesh.node_groups.at("vessel"), ElementsAre(1, 2, 3, 4));
    EXPECT_THAT(mesh.element_groups.at("vessel"), ElementsAre(1));
    EXPECT_FALSE(mesh.element_groups.contains("the base"));
    EXPECT_THAT(mesh.element_vectors.at("direction"),
                ElementsAre(Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(0, 0, -2)));
  }
}

TEST_F(GmshReader, RefusesCurvedEdgesNamingTheElement) {
  refuses(quadratic_22, "9 0 1 1", "9 0.001 1 1",
          {"body.msh:29", "element 5", "curved", "not supported"});
  refuses(quadraticOf41(), "1 2 1\n", "1 2.5 1\n", {"element 7", "curved", "not supported"});
  std::string text = quadratic_22;
  EXPECT_NO_THROW(read(text.replace(text.find("9 0 1 1"), 7, "9 0 1.000001 1")));
}

TEST_F(GmshReader, UnitesTheGroupsAndVectorsOfARepeatedTetrahedron) {
  std::string text = quadratic_22;
  text.replace(text.find("$Elements\n3"), 11, "$Elements\n4");
  text.insert(text.find("$EndElements"), "6 11 2 9 1 1 2 3 4 5 6 7 8 9 10\n");
  text.replace(text.find("5 1 2 +3"), 8, "6 1 2 +3");
  const Mesh mesh = read(text);
  EXPECT_THAT(mesh.element_groups.at("volume 8"), ElementsAre(0));
  EXPECT_THAT(mesh.element_groups.at("vessel"), ElementsAre(0, 1));
  EXPECT_THAT(mesh.element_vectors.at("direction"),
              ElementsAre(Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(0, 0, -2)));
}

TEST_F(GmshReader, IgnoresElementDataThatAreNotVectorsOrOfLaterTimes) {
  std::string text = quadratic_22;
  const std::string data = text.substr(text.find("$ElementData"));
  std::string scalars = data, later = data;
  scalars.replace(scalars.find("0\n3\n2"), 5, "0\n1\n2");
  later.replace(later.find("0.5"), 3, "1.5").replace(later.find("+3"), 2, "30");
  text.insert(text.find("$ElementData"), scalars);
  EXPECT_EQ(read(text + later).element_vectors.at("direction")[0], Eigen::Vector3d(1, 2, 3));
}

TEST_F(GmshReader, RefusesBrokenElementDataNamingTheLine) {
  refuses(quadratic_22, "5 1 2 +3", "5 1 2", {"body.msh:42", "a component"});
  refuses(quadratic_22, "5 1 2 +3", "5 1 2 inf", {"body.msh:42", "not finite"});
  refuses(quadratic_22, "5 1 2 +3\n", "", {"$EndElementData"});
  refuses(quadratic_22, "7 11 2 9", "5 11 2 9", {"two tetrahedra have the number 5"});
}

TEST_F(GmshReader, SurvivesEveryByteReplaced) {
  using std::string_literals::operator""s;
  for (const char* text : {tetrahedron_22, tetrahedron_41}) survivesEveryByte(text, "9- \n\0"s);
  for (const std::string& text : {std::string(quadratic_22), quadraticOf41()})
    survivesEveryByte(text, "9-\n");
}

TEST_F(GmshReader, ReadsTheShippedLiver) {
  const Mesh mesh = readGmsh(PALPATE_SOURCE_DIR "/deploy/scenes/liver/liver-500.msh");
  EXPECT_EQ(mesh.nodes.size(), 492u);
  EXPECT_EQ(measure(mesh).pieces, 1);
}

TEST_F(GmshReader, ReadsTheRealLivers) {
  PALPATE_REFERENCE_FILE(small, "meshes/liver-493.msh");
  PALPATE_REFERENCE_FILE(large, "meshes/liver-5984.msh");
  const Mesh mesh = readGmsh(small);
  EXPECT_EQ(mesh.nodes.size(), 493u);
  EXPECT_EQ(mesh.tetrahedra.size(), 1535u);
  EXPECT_NEAR(measure(mesh).volume, 1.27e-3, 5e-6);
  EXPECT_EQ(measure(mesh).pieces, 1);
  EXPECT_EQ(readGmsh(large).tetrahedra.size(), 26732u);
}

}  // namespace
}  // namespace palpate
