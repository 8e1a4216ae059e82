#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <random>

#include "viewer/fields/force_field.hpp"

namespace palpate::test {

/// A closed, piecewise smooth path p(t) inside a ball, t from 0 to 1: a sum of waves until t = 0.5,
/// then a straight line back to the start.
class RandomLoop {
 public:
  RandomLoop(std::mt19937& random, double radius) {
    const auto uniform = [&random] { return (static_cast<double>(random()) + 0.5) / 4294967296.0; };
    double sum = 0;
    for (std::size_t w = 0; w < waves; ++w)
      for (Eigen::Index axis = 0; axis < 3; ++axis) {
        sine_[w][axis] = (2 * uniform() - 1) / static_cast<double>(w + 1);
        cosine_[w][axis] = (2 * uniform() - 1) / static_cast<double>(w + 1);
      }
    for (std::size_t w = 0; w < waves; ++w) sum += std::hypot(sine_[w].norm(), cosine_[w].norm());
    // |p| is at most the sum of the amplitudes.
    scale_ = radius / sum;
    turns_ = 0.3 + 0.7 * uniform();
  }
  Eigen::Vector3d at(double t) const {
    if (t <= 0.5) return wave(2 * t * turns_);
    return (2 - 2 * t) * wave(turns_) + (2 * t - 1) * wave(0);
  }
  Eigen::Vector3d slope(double t) const {
    if (t > 0.5) return 2 * (wave(0) - wave(turns_));
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t w = 0; w < waves; ++w) {
      const double rate = 2 * M_PI * static_cast<double>(w + 1), angle = rate * 2 * t * turns_;
      sum += rate * (std::cos(angle) * sine_[w] - std::sin(angle) * cosine_[w]);
    }
    return 2 * turns_ * scale_ * sum;
  }

 private:
  static constexpr std::size_t waves = 3;
  Eigen::Vector3d wave(double s) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t w = 0; w < waves; ++w) {
      const double angle = 2 * M_PI * static_cast<double>(w + 1) * s;
      sum += std::sin(angle) * sine_[w] + std::cos(angle) * cosine_[w];
    }
    return scale_ * sum;
  }
  std::array<Eigen::Vector3d, waves> sine_, cosine_;
  double scale_ = 1, turns_ = 1;
};

/// Work of a force field around a loop, J.
struct LoopEnergy {
  double net = 0;        ///< net work done on the mover; 0 for a conservative field
  double exchanged = 0;  ///< sum of the absolute work over all intervals
  double error = 0;      ///< estimated error of the quadrature
  bool covered = true;   ///< coverage was 1 and inside true at all evaluated points
};

/// Adaptive Gauss-Legendre quadrature that halves intervals around kinks at the faces of cells.
class LoopQuadrature {
 public:
  LoopQuadrature(const ForceField& field, const RandomLoop& loop) : field_(field), loop_(loop) {
    constexpr int pieces = 64;  // even, so that one piece ends at the corner of the loop
    for (int n = 0; n < pieces; ++n) {
      const double a = static_cast<double>(n) / pieces, b = static_cast<double>(n + 1) / pieces;
      integrate(a, b, rule(a, b), 0);
    }
  }
  const LoopEnergy& energy() const { return energy_; }

 private:
  static constexpr double tolerance = 1e-13;  // J, for each piece
  static constexpr int most_halvings = 14;

  double power(double t) {
    const ForceSample sample = field_.evaluate(loop_.at(t));
    energy_.covered = energy_.covered && sample.inside && sample.coverage > 1 - 1e-9;
    return sample.force.dot(loop_.slope(t));
  }
  double rule(double a, double b) {
    const double middle = (a + b) / 2, half = (b - a) / 2, x = std::sqrt(0.6) * half;
    return half / 9 * (5 * power(middle - x) + 8 * power(middle) + 5 * power(middle + x));
  }
  void integrate(double a, double b, double coarse, int halvings) {
    const double middle = (a + b) / 2, left = rule(a, middle), right = rule(middle, b);
    const double error = std::abs(left + right - coarse);
    if (error < tolerance || halvings == most_halvings) {
      energy_.net += left + right;
      energy_.exchanged += std::abs(left) + std::abs(right);
      energy_.error += error;
      return;
    }
    integrate(a, middle, left, halvings + 1);
    integrate(middle, b, right, halvings + 1);
  }

  const ForceField& field_;
  const RandomLoop& loop_;
  LoopEnergy energy_;
};

inline LoopEnergy loopEnergy(const ForceField& field, const RandomLoop& loop) {
  return LoopQuadrature(field, loop).energy();
}

}  // namespace palpate::test
