#pragma once

#include "common/mesh/free_share.hpp"
#include "common/mesh/near_points.hpp"
#include "viewer/fields/area_field.hpp"
#include "viewer/haptics/surface_tree.hpp"

namespace palpate {

/// Where a finger was asked for, and whether a dataset can answer there.
struct FingerPlace {
  enum class Fault : std::uint8_t {
    none,
    away,     ///< farther from the surface than mostPlaceDistance()
    no_site,  ///< no site of the finger is near
    fixed     ///< the finger rests on what is fixed, where `solve` refuses it
  };
  Eigen::Vector3d at = Eigen::Vector3d::Zero();  ///< m, the nearest point of the surface at rest
  /// m, between `at` and what was asked; NaN for what is not finite.
  double distance = std::numeric_limits<double>::quiet_NaN();
  std::int32_t triangle = -1;  ///< of the surface, that `at` lies in; -1: what is not finite
  Fault fault = Fault::away;
  Eigen::Vector3d drive = Eigen::Vector3d::Zero();  ///< N, what of it lies in the surface
};

/// What a dataset says about one touch.
struct ForceAnswer {
  /// Of a finger `inside` is false too where its place has a fault.
  ForceSample sample;
  std::optional<FingerPlace> finger;  ///< where a place was given
};

/// The places of a finger's area: the one door through which programs, C and Python ask it.
/// Immutable, and copies what it needs: any thread may ask. Real time.
class AreaPlaces {
 public:
  /// `sites`: where the finger was solved, metres, at least one; `fixed` sorted.
  AreaPlaces(const Mesh& mesh, const NodeSet& fixed, const std::vector<Eigen::Vector3d>& sites,
             double finger_radius);

  /// For any `near` and displacement p, metres.
  FingerPlace placeOf(const Eigen::Vector3d& near, const Eigen::Vector3d& p) const noexcept;
  /// The same place, by the energy of the area, which is prepared there. Numbers that are not
  /// finite give no force.
  ForceAnswer answer(const AreaField& area, const Eigen::Vector3d& near,
                     const Eigen::Vector3d& p) const noexcept;

 private:
  FingerPlace::Fault faultOf(const FingerPlace& place) const noexcept;

  SurfaceTree surface_;
  std::vector<Eigen::Vector3d> normals_;  ///< of its triangles
  NearPoints sites_;
  FreeShare free_share_;
  double most_distance_;  ///< m, from the surface
};

}  // namespace palpate
