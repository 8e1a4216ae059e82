#pragma once

#include "common/mesh/free_share.hpp"
#include "common/mesh/near_points.hpp"
#include "viewer/fields/area_field.hpp"
#include "viewer/haptics/surface_tree.hpp"

namespace palpate {

/// Place of a finger on the surface, and, if a dataset has no reliable answer there, the reason.
struct FingerPlace {
  enum class Fault : std::uint8_t {
    none,
    away,     ///< the requested place is farther from the surface than mostPlaceDistance()
    no_site,  ///< no site of the finger is within answered_distance
    fixed     ///< too much of the finger rests on fixed nodes; `palpate solve` refuses such a place
  };
  Eigen::Vector3d at = Eigen::Vector3d::Zero();  ///< m, nearest point of the surface at rest
  /// m, from the requested place to `at`; NaN if an input was not finite.
  double distance = std::numeric_limits<double>::quiet_NaN();
  std::int32_t triangle = -1;  ///< surface triangle of `at`; -1 if an input was not finite
  Fault fault = Fault::away;
  Eigen::Vector3d drive = Eigen::Vector3d::Zero();  ///< N, tangential part of -dE/ds
};

/// Answer of a dataset for one touch.
struct ForceAnswer {
  /// For a finger, `inside` is false also if `finger` has a fault.
  ForceSample sample;
  std::optional<FingerPlace> finger;  ///< the finger's place; set if the touch has one
};

/// Finds places on a finger's area and evaluates the area's energy at them. The commands, the C API
/// and the Python package all query areas through this class. Copies the data that it needs.
/// Immutable, so any thread may use it. Real time, except the constructor.
class AreaPlaces {
 public:
  /// sites: centres of the fingers that were solved, metres, at least one. fixed: the fixed nodes,
  /// sorted.
  AreaPlaces(const Mesh& mesh, const NodeSet& fixed, const std::vector<Eigen::Vector3d>& sites,
             double finger_radius);

  /// Returns the place on the surface nearest to `near`, and its fault. near, p (displacement):
  /// metres, any value. If one is not finite, the place has no triangle. Does not set `drive`.
  FingerPlace placeOf(const Eigen::Vector3d& near, const Eigen::Vector3d& p) const noexcept;
  /// Evaluates `area` at the displacement p of a finger at placeOf(near, p), and sets `drive`. The
  /// area must already be prepared for that place. If `near` or p is not finite, the force is zero.
  ForceAnswer answer(const AreaField& area, const Eigen::Vector3d& near,
                     const Eigen::Vector3d& p) const noexcept;

 private:
  FingerPlace::Fault faultOf(const FingerPlace& place) const noexcept;

  SurfaceTree surface_;
  std::vector<Eigen::Vector3d> normals_;  ///< outward unit normal of each surface triangle
  NearPoints sites_;
  FreeShare free_share_;
  double most_distance_;  ///< m, from a requested place to the surface
};

}  // namespace palpate
