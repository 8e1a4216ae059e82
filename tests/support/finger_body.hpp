#pragma once

#include <filesystem>

#include "tests/support/sample_dataset.hpp"

namespace palpate::test {

/// A sealed dataset of a cube of 100 mm whose top is touched by a finger of 20 mm, made in code. It
/// has the sites of a resolved scene, each with the energy E(s, p) = g(s) f(p): g is a wave over
/// the top, f is convex and stiffening, about 60 N/m at rest. All points, and `probes` probes at
/// places of the top, are solved. One side of the cube is fixed.
struct FingerBody {
  /// touched: the part of the surface for the finger.
  explicit FingerBody(std::int32_t probes = 0, const std::string& fixed = "zmin",
                      const SurfaceSelection& touched = {.groups = {"zmax"}});

  static double energy(const Eigen::Vector3d& s, const Eigen::Vector3d& p);
  static Eigen::Vector3d force(const Eigen::Vector3d& s, const Eigen::Vector3d& p);
  static Eigen::Vector3d drive(const Eigen::Vector3d& s, const Eigen::Vector3d& p);

  Problem problem;
  std::vector<SpaceTable> spaces;

  /// The nodes around a site move by p; nodes farther away move less.
  NodalFields fields(std::size_t space, std::int32_t point) const;
  /// Throws if the file cannot be written.
  void seal(const std::filesystem::path& file) const;
};

}  // namespace palpate::test
