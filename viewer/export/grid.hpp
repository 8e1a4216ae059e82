#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace palpate {

/// Numbers of one name, as VTK has them: tuple after tuple.
struct GridArray {
  std::string name;
  const char* unit;    ///< "m"; "1" where there is none
  int components = 1;  ///< of a tuple
  std::variant<std::vector<float>, std::vector<double>, std::vector<std::uint8_t>> values = {};
};

/// VTK's numbers of cells (vtkCellType.h). Quadratic tetrahedra have their mid-edge nodes in the
/// order of tetrahedron_edges (common/mesh/mesh.hpp).
enum class CellKind : std::uint8_t { triangle = 5, tetrahedron = 10, quadratic_tetrahedron = 24 };
constexpr int pointsOf(CellKind kind) {
  return kind == CellKind::triangle ? 3 : kind == CellKind::tetrahedron ? 4 : 10;
}

/// An unstructured grid of one kind of cells.
struct Grid {
  CellKind kind = CellKind::tetrahedron;
  std::vector<double> points = {};       ///< x y z, metres, point after point
  std::vector<std::int32_t> cells = {};  ///< numbers of points, pointsOf(kind) for each cell
  std::vector<GridArray> point_data = {}, cell_data = {};
  std::vector<GridArray> field_data = {};  ///< of the whole grid
  /// Words about it: names (letters and `_`) and texts, UTF-8.
  std::vector<std::pair<std::string, std::string>> texts = {};

  std::size_t pointCount() const { return points.size() / 3; }
  std::size_t cellCount() const { return cells.size() / static_cast<std::size_t>(pointsOf(kind)); }
};

}  // namespace palpate
