#pragma once

#include <optional>

#include "viewer/export/configuration_grid.hpp"
#include "viewer/export/interpolated_shape.hpp"
#include "viewer/export/touch_way.hpp"

namespace palpate {

/// Creates configurations for export: interpolated at any displacement, or solved at a lattice
/// point. One thread at a time.
class ConfigurationSource {
 public:
  /// The dataset must outlive this object.
  explicit ConfigurationSource(const Dataset& dataset) : dataset_(dataset) {}

  /// Returns the configuration at a step of a path; does not set `way`. `answers`: the object that
  /// answered the step. It must use this dataset and be the same in every call.
  ExportedConfiguration interpolated(const ForceAnswers& answers, const WayStep& step);

  /// Returns the solved configuration at a lattice point, given by its coordinates in spacings.
  /// `active`: name of an active node or of a finger's area. In an area, the point belongs to the
  /// site nearest to `place` (metres). Error (bad input) for an unknown name, a place without a
  /// finger, an area without a place, and an unsolved point, whose tag and cause the message gives.
  ExportedConfiguration solved(const std::string& active,
                               const std::optional<Eigen::Vector3d>& place,
                               const Eigen::Vector3d& point) const;

 private:
  std::size_t spaceOf(const std::string& active, const std::optional<Eigen::Vector3d>& place) const;
  /// Returns a configuration with the data of the tool that its space determines: rest position and
  /// touched nodes.
  ExportedConfiguration touchedBy(const ActivePatch& patch) const;
  [[noreturn]] void refuseUnsolved(const SpaceTable& space, std::int32_t number,
                                   const Eigen::Vector3d& point) const;

  const Dataset& dataset_;
  std::optional<InterpolatedShape> shape_;
};

}  // namespace palpate
