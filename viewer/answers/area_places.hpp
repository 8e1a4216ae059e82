#pragma once

#include "common/mesh/free_share.hpp"
#include "common/mesh/near_points.hpp"
#include "viewer/fields/area_field.hpp"
#include "viewer/haptics/surface_tree.hpp"

namespace palpate {

/// Place of a finger on the surface, and whether a dataset can answer there.
struct FingerPlace {
  enum class Fault : std::uint8_t {
    none,
    away,     ///< farther from the surface than mostPlaceDistance()
    no_site,  ///< no site of the finger is within answered_distance
    fixed     ///< the finger rests on fixed nodes, where `solve` refuses it
  };
  Eigen::Vector3d at = Eigen::Vector3d::Zero();  ///< m, the nearest point of the surface at rest
  /// m, from the requested place to `at`; NaN if an input was not finite.
  double distance = std::numeric_limits<double>::quiet_NaN();
  std::int32_t triangle = -1;  ///< surface triangle of `at`; -1 if an input was not finite
  Fault fault = Fault::away;
  Eigen::Vector3d drive = Eigen::Vector3d::Zero();  ///< N, tangential part of -dE/ds
};

/// Answer of a dataset to one touch.
struct ForceAnswer {
  /// For a finger, `inside` is also false if its place has a fault.
  ForceSample sample;
  std::optional<FingerPlace> finger;  ///< set if the touch has a place
};

/// Finds the places of a finger's area and evaluates the area's energy there. Commands, C and
/// Python all query areas through this class. Copies the data that it needs. Immutable: any thread
/// may use it. Real time, except the constructor.
class AreaPlaces {
 public:
  /// sites: centres of the solved fingers, metres, at least one; fixed: sorted.
  AreaPlaces(const Mesh& mesh, const NodeSet& fixed, const std::vector<Eigen::Vector3d>& sites,
             double finger_radius);

  /// Returns the place on the surface nearest to `near`, and its fault. near, p (displacement):
  /// metres, any value.
  FingerPlace placeOf(const Eigen::Vector3d& near, const Eigen::Vector3d& p) const noexcept;
  /// Evaluates `area` at placeOf(near, p), where it must be prepared. Numbers that are not finite
  /// give no force.
  ForceAnswer answer(const AreaField& area, const Eigen::Vector3d& near,
                     const Eigen::Vector3d& p) const noexcept;

 private:
  FingerPlace::Fault faultOf(const FingerPlace& place) const noexcept;

  SurfaceTree surface_;
  std::vector<Eigen::Vector3d> normals_;  ///< of the surface's triangles
  NearPoints sites_;
  FreeShare free_share_;
  double most_distance_;  ///< m, largest distance of a place from the surface
};

}  // namespace palpate
