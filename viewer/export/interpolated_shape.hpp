#pragma once

#include <map>
#include <memory>
#include <optional>

#include "common/dataset/dataset.hpp"
#include "common/scene/active_choice.hpp"
#include "viewer/fields/point_blend.hpp"
#include "viewer/haptics/touch_surface.hpp"

namespace palpate {

/// Displacements and pressures of all nodes that a dataset stores, between its configurations:
/// tri-linear in the leaf around a displacement (PointBlend), and, of a finger between its sites,
/// the mean of the up to nine sites around by the weights that the picture blends them with
/// (TouchSurface). Forces do not come from here.
///
/// Only the configurations that an answer stands on are read. One thread at a time.
class InterpolatedShape {
 public:
  /// The dataset must outlive this object.
  InterpolatedShape(const Dataset& dataset, const ActiveChoice& choice);

  /// at: a point of the surface at rest, metres, where the finger is; nothing of other tools. In a
  /// solved lattice point the stored values to the last bit. Error when a configuration cannot be
  /// read.
  NodalFields at(const std::optional<Eigen::Vector3d>& place, const Eigen::Vector3d& displacement);

 private:
  /// A configuration: space, and its lattice number.
  using Key = std::pair<std::size_t, std::int32_t>;
  std::vector<std::pair<std::size_t, double>> spacesAt(const std::optional<Eigen::Vector3d>& place);

  const Dataset& dataset_;
  const ActiveChoice choice_;
  std::unique_ptr<TouchSurface> surface_;  ///< of a finger with several sites
  std::map<std::size_t, PointBlend> blends_;
  std::map<Key, NodalFields> read_;  ///< of the last answer: the next one often needs them again
};

/// Of some spaces the one whose finger is nearest to a place, metres.
std::size_t nearestSite(const Dataset& dataset, const std::vector<std::size_t>& spaces,
                        const Eigen::Vector3d& place);

}  // namespace palpate
