#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/base/error.hpp"
#include "common/mesh/mesh_reader.hpp"
#include "tests/support/expect_error.hpp"

namespace palpate {
namespace {

using test::expectBadInput;
using ::testing::ElementsAre;

/// Two tetrahedra, the second with ten nodes, and a triangle between them in the file.
constexpr const char* grid_3 = R"(# vtk DataFile Version 3.0
two tetrahedra
ASCII
DATASET UNSTRUCTURED_GRID
POINTS 11 double
0 0 0 2 0 0
0 2 0 0 0 2 2 2 2
1 1 0  0 1 1  1 0 1  2 1 1  1 2 1  1 1 2
CELLS 3 20
4 0 1 2 3
3 0 1 2
10 1 2 3 4 5 6 7 8 9 10
CELL_TYPES 3
10
5
24
CELL_DATA 3
SCALARS region int 1
LOOKUP_TABLE default
7 8 -3
VECTORS direction float
1 2 3
9 9 9
0 0 -2
FIELD FieldData 2
quality 1 3 double
1 2 3
other 3 3 double
1 0 0 9 9 9
0 1 0
POINT_DATA 11
SCALARS region int
LOOKUP_TABLE default
0 0 0 0 0 0 0 0 0 0 0
)";

constexpr const char* grid_5 = R"(# vtk DataFile Version 5.1
written by VTK
ASCII
DATASET UNSTRUCTURED_GRID
POINTS 5 double
0 0 0 2 0 0
0 2 0 0 0 2 2 2 2
METADATA
INFORMATION 1
NAME L2_NORM_RANGE LOCATION vtkDataArray
DATA 2 0 1

CELLS 3 8
OFFSETS vtktypeint64
0 4 8
CONNECTIVITY vtktypeint64
0 1 2 3
1 2 3 4
CELL_TYPES 2
10
10

CELL_DATA 2
FIELD FieldData 2
region 1 2 int
7 -3
METADATA
COMPONENT_NAMES
one

direction 3 2 double
1 2 3 0 0 -2
)";

class VtkReader : public ::testing::Test {
 protected:
  static Mesh read(const std::string& text, double metres_per_unit = 1) {
    return parseVtk(text, "body.vtk", metres_per_unit);
  }
  static void refuses(std::string text, const std::string& what, const std::string& instead,
                      std::initializer_list<std::string> words) {
    text.replace(text.find(what), what.size(), instead);
    expectBadInput([&] { read(text); }, words);
  }
};

TEST_F(VtkReader, ReadsOldAndNewFilesToTheSameMesh) {
  for (const char* text : {grid_3, grid_5}) {
    const Mesh mesh = read(text, 0.001);
    EXPECT_THAT(mesh.nodes, ElementsAre(Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0.002, 0, 0),
                                        Eigen::Vector3d(0, 0.002, 0), Eigen::Vector3d(0, 0, 0.002),
                                        Eigen::Vector3d(0.002, 0.002, 0.002)));
    EXPECT_THAT(mesh.tetrahedra, ElementsAre(Tetrahedron{0, 1, 2, 3}, Tetrahedron{1, 2, 3, 4}));
    EXPECT_THAT(mesh.element_groups.at("7"), ElementsAre(0));
    EXPECT_THAT(mesh.element_groups.at("-3"), ElementsAre(1));
    EXPECT_EQ(mesh.element_groups.size(), 2u);
    EXPECT_THAT(mesh.element_vectors.at("direction"),
                ElementsAre(Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(0, 0, -2)));
  }
}

TEST_F(VtkReader, ReadsVectorsFromFieldsToo) {
  EXPECT_THAT(read(grid_3).element_vectors.at("other"),
              ElementsAre(Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 1, 0)));
}

TEST_F(VtkReader, RefusesCurvedEdgesNamingTheCell) {
  refuses(grid_3, "1 1 2\n", "1 1 2.1\n", {"body.vtk", "cell 2", "curved edges are not supported"});
}

TEST_F(VtkReader, RefusesWhatItCannotReadNamingTheLine) {
  refuses(grid_3, "# vtk", "# stl", {"body.vtk:1", "not a legacy VTK file"});
  refuses(grid_3, "ASCII", "BINARY", {"body.vtk:", "binary"});
  refuses(grid_3, "UNSTRUCTURED_GRID", "POLYDATA", {"body.vtk:4", "POLYDATA"});
  refuses(grid_3, "0 2 0 0 0 2", "0 2 0 0 a 2", {"body.vtk:7", "\"a\"", "a coordinate"});
  refuses(grid_3, "4 0 1 2 3", "4 0 1 2 11", {"point 11", "has 11"});
  refuses(grid_3, "CELLS 3 20", "CELLS 3 21", {"announced with 21", "have 20"});
  refuses(grid_3, "\n24\n", "\n12\n", {"cell 2", "type 12", "tetrahedra"});
  refuses(grid_3, "\n24\n", "\n10\n", {"cell 2", "10 nodes"});
  refuses(grid_3, "CELL_DATA 3", "CELL_DATA 4",
          {"body.vtk:17", "data of 4 cells where there are 3"});
  refuses(grid_3, "VECTORS", "ARROWS", {"body.vtk:21", "ARROWS"});
  refuses(grid_3, "0 0 -2", "0 0 nan", {"body.vtk:24", "not finite"});
  refuses(grid_5, "0 4 8", "0 5 4", {"offsets"});
  expectBadInput([] { readVtk("nothing.vtk"); }, {"nothing.vtk", "No such file"});
}

TEST_F(VtkReader, RefusesDataOfCellsThatItDoesNotKnowYet) {
  refuses(grid_3, "CELLS 3 20", "CELL_DATA 0\nVECTORS early float\nCELLS 3 20",
          {"body.vtk:9", "CELL_DATA before CELL_TYPES"});
}

TEST_F(VtkReader, SurvivesACutAndAnyByteReplaced) {
  for (const std::string original : {grid_3, grid_5})
    for (std::size_t at = 0; at < original.size(); ++at)
      for (const char wrong : {'9', '-', '\n', '\0'}) {
        std::string damaged = original;
        damaged[at] = wrong;
        for (const std::string& text : {damaged, original.substr(0, at)}) try {
            EXPECT_GE(read(text).tetrahedra.size(), 1u);
          } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find("body.vtk"), std::string::npos)
                << error.what();
          }
      }
}

}  // namespace
}  // namespace palpate
