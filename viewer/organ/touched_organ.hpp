#pragma once

#include <memory>
#include <optional>
#include <span>

#include "common/mesh/surface_point.hpp"
#include "viewer/fields/area_field.hpp"
#include "viewer/fields/displacement_field.hpp"
#include "viewer/fields/potential_field.hpp"
#include "viewer/organ/carried_organ.hpp"

namespace palpate {

/// Answers from a carried organ, prepared piece by piece where it is touched, so that one thread
/// can do something else in between. Forces, bounds and all else are those of `palpate query`.
///
/// One thread.
class TouchedOrgan {
 public:
  explicit TouchedOrgan(CarriedOrgan organ);

  const CarriedOrgan& organ() const { return organ_; }
  /// Where a point of the surface is at rest, m.
  Eigen::Vector3d positionOf(const SurfacePoint& point) const;
  /// Makes one piece of what a touch there needs; false when nothing is lacking. `touch`: into
  /// CarriedOrgan::touches.
  bool prepare(std::size_t touch, const Eigen::Vector3d& s);
  /// One piece of what is needed elsewhere, the nearest first; false when nothing is lacking.
  bool prepareAhead(std::size_t touch, const Eigen::Vector3d& s);
  /// p: displacement of the finger from s, or of the active node from its rest, m. Once prepare()
  /// has nothing to do.
  AreaSample evaluate(std::size_t touch, const Eigen::Vector3d& s, const Eigen::Vector3d& p) const;
  /// Displacements of all vertices, [vertex][axis], m: the blend of the solved shapes around, and a
  /// smooth bump about the anchor, so that the surface meets the tool. After evaluate().
  void shapeAt(std::size_t touch, const SurfacePoint& anchor, const Eigen::Vector3d& p,
               std::span<float> out);

 private:
  struct Touched {
    std::optional<AreaField> area;
    std::unique_ptr<PotentialField> field;  ///< of an active node
  };
  const DisplacementField& sharesOf(std::int32_t space);
  void addShares(std::int32_t space, const Eigen::Vector3d& p, float weight);
  void passThroughTool(const SurfacePoint& anchor, const Eigen::Vector3d& p, std::span<float> out);

  CarriedOrgan organ_;
  std::vector<Touched> touched_;
  std::vector<std::unique_ptr<DisplacementField>> share_fields_;  ///< per space
  std::vector<float> one_, sum_;                                  ///< per mode
};

}  // namespace palpate
