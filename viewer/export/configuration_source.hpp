#pragma once

#include <optional>

#include "viewer/export/configuration_grid.hpp"
#include "viewer/export/interpolated_shape.hpp"
#include "viewer/export/touch_way.hpp"

namespace palpate {

/// The configurations of a dataset with what is told of them: between its lattice points, and in
/// them as they were solved. One thread at a time.
class ConfigurationSource {
 public:
  /// The dataset must outlive this object.
  explicit ConfigurationSource(const Dataset& dataset) : dataset_(dataset) {}

  /// Shape and force at a step of a way, but not how far that is. `answers`: of this dataset, which
  /// the step has its own from; the same ones every time.
  ExportedConfiguration interpolated(const ForceAnswers& answers, const WayStep& step);

  /// The lattice point of an active node, or of the site of a finger's area that is nearest to a
  /// place (metres), with these coordinates in spacings. Error (bad input) for an unknown name, a
  /// place of what is no finger or none for an area, and for a point that was not solved, with its
  /// tag and cause.
  ExportedConfiguration solved(const std::string& active,
                               const std::optional<Eigen::Vector3d>& place,
                               const Eigen::Vector3d& point) const;

 private:
  std::size_t spaceOf(const std::string& active, const std::optional<Eigen::Vector3d>& place) const;
  /// What of the tool is known from its space alone.
  ExportedConfiguration touchedBy(const ActivePatch& patch) const;
  [[noreturn]] void refuseUnsolved(const SpaceTable& space, std::int32_t number,
                                   const Eigen::Vector3d& point) const;

  const Dataset& dataset_;
  std::optional<InterpolatedShape> shape_;
};

}  // namespace palpate
