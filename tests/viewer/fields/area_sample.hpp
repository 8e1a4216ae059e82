#pragma once

#include <cmath>
#include <vector>

#include "common/space/space_table.hpp"
#include "tests/support/symmetric_slope.hpp"

/// Spaces of a finger's sites with an exact energy: E(s, p) = g(s) f(p).
namespace palpate::test {

struct PaperArea {
  static constexpr double radius = 0.02, reach = 0.03;

  static double wave(const Eigen::Vector3d& s) { return slope().dot(s); }
  static Eigen::Vector3d slope() { return {37, 21, -13}; }  ///< 1/m
  static double g(const Eigen::Vector3d& s) { return 1 + 0.3 * std::sin(wave(s)); }
  static Eigen::Vector3d gradG(const Eigen::Vector3d& s) {
    return 0.3 * std::cos(wave(s)) * slope();
  }
  static Eigen::Matrix3d hessianG(const Eigen::Vector3d& s) {
    return -0.3 * std::sin(wave(s)) * slope() * slope().transpose();
  }

  static Eigen::Matrix3d stiffness() {
    Eigen::Matrix3d k;
    k << 160, 10, -20, 10, 90, 5, -20, 5, 120;
    return k;
  }
  static Eigen::Vector3d cubed() { return {20, -30, 10}; }
  static double f(const Eigen::Vector3d& p) {
    return 0.5 * p.dot(stiffness() * p) + std::pow(cubed().dot(p), 3);
  }
  static Eigen::Vector3d gradF(const Eigen::Vector3d& p) {
    return stiffness() * p + 3 * std::pow(cubed().dot(p), 2) * cubed();
  }
  static Eigen::Matrix3d hessianF(const Eigen::Vector3d& p) {
    return stiffness() + 6 * cubed().dot(p) * cubed() * cubed().transpose();
  }

  static double energy(const Eigen::Vector3d& s, const Eigen::Vector3d& p) { return g(s) * f(p); }
  static Eigen::Vector3d force(const Eigen::Vector3d& s, const Eigen::Vector3d& p) {
    return -g(s) * gradF(p);
  }
  static Eigen::Vector3d drive(const Eigen::Vector3d& s, const Eigen::Vector3d& p) {
    return -f(p) * gradG(s);
  }

  /// A square of the plane z = 0, 12 cm wide.
  static std::vector<Eigen::Vector3d> plane(double pitch) {
    std::vector<Eigen::Vector3d> places;
    for (double x = -0.06; x <= 0.06; x += pitch)
      for (double y = -0.06; y <= 0.06; y += pitch) places.emplace_back(x, y, 0);
    return places;
  }

  static Equilibrium equilibrium(const Eigen::Vector3d& s, const Eigen::Vector3d& p) {
    return {{.force = force(s, p), .stiffness = -g(s) * hessianF(p), .energy = energy(s, p)},
            {.drive = drive(s, p),
             .drive_stiffness = -gradG(s) * gradF(p).transpose(),
             .drive_slope = -f(p) * hessianG(s),
             .stiffness_by_p = -g(s) * slopeOf(6 * cubed() * cubed().transpose(), cubed()),
             .stiffness_by_s = -slopeOf(hessianF(p), gradG(s)),
             .drive_slope_by_p = -slopeOf(hessianG(s), gradF(p))}};
  }

  /// `refined`: the eight cells around the origin are split.
  static SpaceTable space(const Eigen::Vector3d& s, bool refined = false) {
    constexpr std::int32_t divisions = 4;
    SpaceTable space;
    space.patch.name = "site";
    space.patch.finger = Finger{s, radius};
    space.lattice = Lattice(reach, reach / 3, divisions);
    if (refined) {
      for (const std::int32_t x : {-divisions, 0})
        for (const std::int32_t y : {-divisions, 0})
          for (const std::int32_t z : {-divisions, 0}) space.splits.push_back({{x, y, z}, 0});
      for (std::int32_t x = -divisions; x <= divisions; x += divisions / 2)
        for (std::int32_t y = -divisions; y <= divisions; y += divisions / 2)
          for (std::int32_t z = -divisions; z <= divisions; z += divisions / 2)
            if (!space.lattice.indexOf({x, y, z})) space.lattice.add({x, y, z});
    }
    for (std::int32_t n = 0; n < space.lattice.size(); ++n) {
      PointRecord& point = space.points.emplace_back();
      point.tag = Tag::expandable;
      point.parent = 0;
      point.equilibrium = equilibrium(s, space.lattice.displacement(n));
    }
    return space;
  }

  /// Sites at about the distance that sitesOn chooses.
  static std::vector<SpaceTable> sites(double pitch = 0.015) {
    std::vector<SpaceTable> spaces;
    for (const Eigen::Vector3d& s : plane(pitch)) spaces.push_back(space(s));
    return spaces;
  }
};

}  // namespace palpate::test
