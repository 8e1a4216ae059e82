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
/// dataset. Tri-linear in the leaf around a displacement (PointBlend). Between the sites of a
/// finger it takes the mean of up to nine sites around, with the weights of the picture
/// (TouchSurface). Forces are not computed here.
///
/// Only the configurations with a share in a result are read. One thread at a time.
class InterpolatedShape {
 public:
  /// The dataset must outlive this object.
  InterpolatedShape(const Dataset& dataset, const ActiveChoice& choice);

  /// place: a point of the surface at rest, metres, where the finger is; none for other tools. At a
  /// solved lattice point it returns the stored values to the last bit. Error if a configuration
  /// cannot be read.
  NodalFields at(const std::optional<Eigen::Vector3d>& place, const Eigen::Vector3d& displacement);

 private:
  /// Key of a configuration: space and lattice number.
  using Key = std::pair<std::size_t, std::int32_t>;
  std::vector<std::pair<std::size_t, double>> spacesAt(const std::optional<Eigen::Vector3d>& place);

  const Dataset& dataset_;
  const ActiveChoice choice_;
  std::unique_ptr<TouchSurface> surface_;  ///< for a finger with several sites
  std::map<std::size_t, PointBlend> blends_;
  /// read for the last result; the next one often needs them again
  std::map<Key, NodalFields> read_;
};

/// Returns the one of `spaces` with the finger nearest to a place, metres.
std::size_t nearestSite(const Dataset& dataset, const std::vector<std::size_t>& spaces,
                        const Eigen::Vector3d& place);

}  // namespace palpate
