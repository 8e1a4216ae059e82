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

/// Evaluates a carried organ. The organ is prepared in small steps around the touch, so that a
/// single thread can do other work in between. Forces and error bounds equal the results of
/// `palpate query`.
///
/// One thread.
class TouchedOrgan {
 public:
  explicit TouchedOrgan(CarriedOrgan organ);

  const CarriedOrgan& organ() const { return organ_; }
  /// Returns the position of a surface point at rest, m.
  Eigen::Vector3d positionOf(const SurfacePoint& point) const;
  /// Does one step of the preparation for a touch at s. Returns false if nothing is left to do.
  /// touch: index in CarriedOrgan::touches; s: m, place on the surface at rest.
  bool prepare(std::size_t touch, const Eigen::Vector3d& s);
  /// Does one step of the preparation of the other sites of the touch, the nearest to s first.
  /// Returns false if nothing is left to do.
  bool prepareAhead(std::size_t touch, const Eigen::Vector3d& s);
  /// Evaluates force and energy. p: displacement of the finger from s, or of the active node from
  /// its rest position, m. The force is zero if prepare() has not finished at s.
  AreaSample evaluate(std::size_t touch, const Eigen::Vector3d& s, const Eigen::Vector3d& p) const;
  /// Fills `out` with the displacements of all vertices, [vertex][axis], m. The shape is a blend of
  /// the shapes of the sites around the anchor, plus a smooth bump that makes the surface pass
  /// through the tool. Shapes that prepare() has not made yet are made here, which takes longer.
  void shapeAt(std::size_t touch, const SurfacePoint& anchor, const Eigen::Vector3d& p,
               std::span<float> out);

 private:
  struct Touched {
    std::optional<AreaField> area;
    std::unique_ptr<PotentialField> field;  ///< for an active node
  };
  const DisplacementField& sharesOf(std::int32_t space);
  void addShares(std::int32_t space, const Eigen::Vector3d& p, float weight);
  void passThroughTool(const SurfacePoint& anchor, const Eigen::Vector3d& p, std::span<float> out);

  CarriedOrgan organ_;
  std::vector<Touched> touched_;
  std::vector<std::unique_ptr<DisplacementField>> share_fields_;  ///< per space
  std::vector<float> one_, sum_;  ///< per mode: shares of one space, weighted sum of shares
};

}  // namespace palpate
