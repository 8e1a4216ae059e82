#pragma once

#include <optional>

#include "common/dataset/dataset.hpp"
#include "viewer/export/vtu.hpp"
#include "viewer/fields/force_field.hpp"

namespace palpate {

/// One configuration of a body, with the data about tool and force that are exported with it.
struct ExportedConfiguration {
  NodalFields fields = {};                 ///< fields of the stored nodes, as in Dataset::fields
  std::vector<std::int32_t> touched = {};  ///< nodes under the tool, sorted
  /// Rest position of the active node or of the finger's centre, and displacement of the tool, m.
  Eigen::Vector3d place = Eigen::Vector3d::Zero(), displacement = Eigen::Vector3d::Zero();
  ForceSample sample = {};
  std::optional<Eigen::Vector3d> drive = {};          ///< N; only for a finger
  std::optional<double> way = {};                     ///< length of the tool's path up to here, m
  std::optional<Eigen::Vector3d> lattice_point = {};  ///< in spacings; only for a solved point
  std::optional<double> min_det_F = {};               ///< from the solver; only for a solved point
  std::string active = {}, method = {};               ///< names
};

/// Makes grids of a dataset's body at rest, with displacements by which other programs can warp
/// them.
///
/// If all nodes are stored, the cells are the tetrahedra, with displacement, pressure where the
/// dataset has one, and det_F (det_f.hpp). Otherwise they are the triangles of the surface, with
/// the displacement.
///
/// If a quadratic body stores its pressure only at vertices, each mid-edge node gets the mean of
/// the pressures at the ends of its edge. This is exact, because the pressure is linear there.
class ConfigurationGrid {
 public:
  /// The dataset must outlive this object.
  explicit ConfigurationGrid(const Dataset& dataset);

  bool isVolume() const { return rest_.kind != CellKind::triangle; }
  const Grid& rest() const { return rest_; }  ///< points, cells and `fixed`
  Grid of(const ExportedConfiguration& configuration) const;

 private:
  void addTetrahedra();
  void addTriangles();
  /// Returns 1 for each stored node that is in `nodes` (sorted), 0 for the others.
  std::vector<std::uint8_t> marked(const std::vector<std::int32_t>& nodes) const;
  std::vector<float> pressuresOf(const NodalFields& fields) const;

  const Dataset& dataset_;
  Grid rest_;
};

}  // namespace palpate
