#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

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

}  // namespace palpate
