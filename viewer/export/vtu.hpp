#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

// VTK's XML formats. Numbers are written in base64 ("binary"), not compressed, so that each file is
// well-formed XML. Raw bytes after the text would be a quarter smaller, but VTK 9.1 cannot read
// them with Expat 2.5.0-1+deb12u5.

namespace palpate {

/// A named array of numbers, as in VTK: one tuple after the other.
struct GridArray {
  std::string name;
  const char* unit;    ///< "m"; "1" if dimensionless
  int components = 1;  ///< per tuple
  std::variant<std::vector<float>, std::vector<double>, std::vector<std::uint8_t>> values = {};
};

/// VTK's numbers of cell types (vtkCellType.h). Quadratic tetrahedra list their mid-edge nodes in
/// the order of tetrahedron_edges (common/mesh/mesh.hpp).
enum class CellKind : std::uint8_t { triangle = 5, tetrahedron = 10, quadratic_tetrahedron = 24 };
constexpr int pointsOf(CellKind kind) {
  return kind == CellKind::triangle ? 3 : kind == CellKind::tetrahedron ? 4 : 10;
}

/// An unstructured grid with cells of a single kind.
struct Grid {
  CellKind kind = CellKind::tetrahedron;
  std::vector<double> points = {};       ///< x y z of each point, metres
  std::vector<std::int32_t> cells = {};  ///< indices of points, pointsOf(kind) for each cell
  std::vector<GridArray> point_data = {}, cell_data = {};
  std::vector<GridArray> field_data = {};  ///< of the whole grid
  /// Descriptions of the grid: pairs of a name (letters and `_`) and a UTF-8 text.
  std::vector<std::pair<std::string, std::string>> texts = {};

  std::size_t pointCount() const { return points.size() / 3; }
  std::size_t cellCount() const { return cells.size() / static_cast<std::size_t>(pointsOf(kind)); }
};

/// Returns the bytes of a .vtu file. The unit of each array is an attribute of its DataArray, and
/// the grid's texts are attributes of VTKFile. Programs that read the file ignore both.
std::string vtuBytes(const Grid& grid);

/// A file of a series, and the time at which ParaView shows it.
struct SeriesFile {
  double time = 0;
  std::string file;  ///< relative to the .pvd
};

/// Returns the text of a .pvd file, in which ParaView finds the files of a series.
std::string pvdText(const std::vector<SeriesFile>& series);

/// Escapes markup for an XML attribute, and replaces control characters, which XML cannot
/// represent, by ?.
std::string xmlText(std::string_view text);

}  // namespace palpate
