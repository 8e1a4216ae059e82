#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <functional>
#include <vector>

#include "common/dataset/dataset.hpp"

namespace palpate::test {

/// Stored energy of an imaginary body as a function of the displacement, with its exact
/// derivatives.
class AnalyticEnergy {
 public:
  virtual ~AnalyticEnergy() = default;
  virtual double energy(const Eigen::Vector3d& p) const = 0;  ///< J
  virtual Eigen::Vector3d gradient(
      const Eigen::Vector3d& p) const = 0;  ///< N; the force is its negative
  virtual Eigen::Matrix3d hessian(
      const Eigen::Vector3d& p) const = 0;  ///< N/m; the stiffness is its negative
};

/// A smooth, stiffening, asymmetric energy, not a polynomial. The stiffness is about 50 N/m, and
/// the force at 20 mm about 1 N.
class StiffeningEnergy : public AnalyticEnergy {
 public:
  double energy(const Eigen::Vector3d& p) const override;
  Eigen::Vector3d gradient(const Eigen::Vector3d& p) const override;
  Eigen::Matrix3d hessian(const Eigen::Vector3d& p) const override;
};

/// The sum of f x^i y^j z^k over all monomials of total degree <= `degree`. The factors f come from
/// a fixed seed; lengths are scaled by `length`.
class PolynomialEnergy : public AnalyticEnergy {
 public:
  PolynomialEnergy(int degree, double length);
  double energy(const Eigen::Vector3d& p) const override;
  Eigen::Vector3d gradient(const Eigen::Vector3d& p) const override;
  Eigen::Matrix3d hessian(const Eigen::Vector3d& p) const override;

 private:
  struct Term {
    double factor;
    std::array<int, 3> powers;
  };
  double sum(const Eigen::Vector3d& p, std::array<int, 3> derivative) const;
  std::vector<Term> terms_;
  double length_;
};

/// Returns a configuration space, without nodal fields, in which all points are expandable and hold
/// the derivatives of `energy`.
SpaceTable solvedSpace(const Lattice& lattice, const AnalyticEnergy& energy);

/// All input of sealDataset, made in code: a cube of 27 nodes, active nodes "tip" and "edge-2", a
/// lattice of 33 points (radius 20 mm, spacing 10 mm), forces of StiffeningEnergy. In "tip" one
/// point is failed (with two failed attempts), one is unknown and one terminating; in "edge-2" all
/// are expandable. With P2 displacement the cube also has mid-edge nodes, and "edge-2" is a
/// weighted patch.
struct SampleDataset {
  /// small: 8 nodes and 7 points (radius 10 mm), also with one failed, one unknown and one
  /// terminating point. It is for fuzzers, because the time to load a dataset grows with its
  /// points.
  enum class Size { usual, small };

  explicit SampleDataset(PressureSpace pressure = PressureSpace::p1_stabilized,
                         DisplacementSpace displacement = DisplacementSpace::p1,
                         Size size = Size::usual);

  Problem problem;
  Lattice lattice;
  std::vector<SpaceTable> spaces;
  std::string kernel_family = "portable";

  /// Refines the dataset as an adaptive build would: divisions, two probes in each space (one
  /// failed), and in "edge-2" cells split twice with their points, one extra point outside the
  /// ball, and point 3 on another branch.
  void refine();

  NodalFields fields(std::size_t space, std::int32_t point) const;
  void seal(const std::filesystem::path& file) const;
};

}  // namespace palpate::test
