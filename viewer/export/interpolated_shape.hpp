#pragma once

#include <map>
#include <memory>
#include <optional>

#include "common/dataset/dataset.hpp"
#include "common/scene/active_choice.hpp"
#include "viewer/fields/point_blend.hpp"
#include "viewer/haptics/touch_surface.hpp"

namespace palpate {

/// Interpolates displacements and pressures of all stored nodes between the configurations of a
/// dataset. The interpolation is tri-linear in the leaf around a displacement (PointBlend). For a
/// finger, the result is the weighted mean of up to nine sites around its place, with the weights
/// that pictures use (TouchSurface). Forces are not computed here.
///
/// Reads only the configurations that contribute to a result. One thread at a time.
class InterpolatedShape {
 public:
  /// The dataset must outlive this object.
  InterpolatedShape(const Dataset& dataset, const ActiveChoice& choice);

  /// Returns the fields at a displacement, metres. With a single space, the fields at a solved
  /// lattice point are exactly the stored values. place: the finger's place on the surface at rest,
  /// metres; used only if the choice has several spaces. Error if a configuration cannot be read.
  NodalFields at(const std::optional<Eigen::Vector3d>& place, const Eigen::Vector3d& displacement);

 private:
  /// Key of a configuration: index of the space and of the lattice point.
  using Key = std::pair<std::size_t, std::int32_t>;
  std::vector<std::pair<std::size_t, double>> spacesAt(const std::optional<Eigen::Vector3d>& place);

  const Dataset& dataset_;
  const ActiveChoice choice_;
  std::unique_ptr<TouchSurface> surface_;  ///< for a finger with several sites
  std::map<std::size_t, PointBlend> blends_;
  /// configurations read for the last result; the next result often needs them again
  std::map<Key, NodalFields> read_;
};

}  // namespace palpate
