#pragma once

#include <optional>

#include "common/dataset/dataset.hpp"
#include "viewer/export/grid.hpp"
#include "viewer/fields/force_field.hpp"

namespace palpate {

/// One configuration of a body, and what is told of it.
struct ExportedConfiguration {
  NodalFields fields = {};                 ///< of the stored nodes, as Dataset::fields
  std::vector<std::int32_t> touched = {};  ///< nodes that the tool holds, sorted
  /// Where the active node or the middle of the finger is at rest, and how far it is moved: metres.
  Eigen::Vector3d place = Eigen::Vector3d::Zero(), displacement = Eigen::Vector3d::Zero();
  ForceSample sample = {};
  std::optional<Eigen::Vector3d> drive = {};          ///< N, of a finger
  std::optional<double> way = {};                     ///< m, along a path
  std::optional<Eigen::Vector3d> lattice_point = {};  ///< in spacings, where it was solved there
  std::optional<double> min_det_F = {};               ///< of the solver, where it was solved
  std::string active = {}, method = {};               ///< names
};

/// Grids of a dataset's body: at rest, with displacements to warp them by.
///
/// Where all nodes are stored these are the tetrahedra, with displacement, pressure where the
/// dataset has one, and det_F (det_f.hpp); else the triangles of the surface with the displacement.
/// Pressures of quadratic bodies that live on vertices have the mean of both ends in mid-edge
/// nodes, which is what such a pressure is there.
class ConfigurationGrid {
 public:
  /// The dataset must outlive this object.
  explicit ConfigurationGrid(const Dataset& dataset);

  bool isVolume() const { return rest_.kind != CellKind::triangle; }
  const Grid& rest() const { return rest_; }  ///< points, cells, `fixed`
  Grid of(const ExportedConfiguration& configuration) const;

 private:
  void addTetrahedra();
  void addTriangles();
  /// 1 at the stored ones of these nodes, sorted, 0 elsewhere.
  std::vector<std::uint8_t> marked(const std::vector<std::int32_t>& nodes) const;
  std::vector<float> pressuresOf(const NodalFields& fields) const;

  const Dataset& dataset_;
  Grid rest_;
};

}  // namespace palpate
