#pragma once

#include <filesystem>

#include "tests/support/sample_dataset.hpp"

namespace palpate::test {

/// A sealed dataset of a cube of 100 mm whose top a finger of 20 mm touches, made in code: the
/// sites of a resolved scene, and in each the energy E(s, p) = g(s) f(p), g a wave over the top and
/// f convex and stiffening, some 60 N/m at rest. Every point is solved, and so many probes at
/// places of the top. One side of the cube is fixed.
struct FingerBody {
  explicit FingerBody(std::int32_t probes = 0, const std::string& fixed = "zmin");

  static double energy(const Eigen::Vector3d& s, const Eigen::Vector3d& p);
  static Eigen::Vector3d force(const Eigen::Vector3d& s, const Eigen::Vector3d& p);
  static Eigen::Vector3d drive(const Eigen::Vector3d& s, const Eigen::Vector3d& p);

  Problem problem;
  std::vector<SpaceTable> spaces;

  /// All nodes around a site move by p, others less with the distance.
  NodalFields fields(std::size_t space, std::int32_t point) const;
  /// Error when it cannot be written.
  void seal(const std::filesystem::path& file) const;
};

}  // namespace palpate::test
