#include "viewer/report/loop_work.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

namespace palpate {
namespace {

constexpr int candidates = 256, most_circles = 64, points_per_circle = 4096;

struct Circle {
  Eigen::Vector3d center, first, second;  ///< metres; the radii along two orthogonal directions

  Eigen::Vector3d at(double angle) const {
    return center + std::cos(angle) * first + std::sin(angle) * second;
  }
  Eigen::Vector3d tangent(double angle) const {
    return -std::sin(angle) * first + std::cos(angle) * second;
  }
};

class RandomCircles {
 public:
  explicit RandomCircles(double radius) : radius_(radius) {}
  Circle next() {
    const Eigen::Vector3d first = direction(), other = direction(), outwards = direction();
    const double distance = 0.75 * radius_ * std::cbrt(uniform());
    return {distance * outwards, 0.25 * radius_ * first,
            0.25 * radius_ * first.cross(other).normalized()};
  }

 private:
  double uniform() { return (static_cast<double>(random_()) + 0.5) / 4294967296.0; }
  Eigen::Vector3d direction() {
    const double z = 2 * uniform() - 1, angle = 2 * M_PI * uniform(), r = std::sqrt(1 - z * z);
    return {r * std::cos(angle), r * std::sin(angle), z};
  }
  double radius_;
  std::mt19937 random_{20};
};

/// Nothing when the coverage is too low somewhere.
std::optional<double> relativeWork(const ForceField& field, const Circle& circle,
                                   double least_coverage) {
  double work = 0, effort = 0;
  for (int n = 0; n < points_per_circle; ++n) {
    const double angle = 2 * M_PI * (n + 0.5) / points_per_circle;
    const ForceSample sample = field.evaluate(circle.at(angle));
    if (!sample.inside || sample.coverage < least_coverage) return std::nullopt;
    const Eigen::Vector3d tangent = circle.tangent(angle);
    work += sample.force.dot(tangent);
    effort += sample.force.norm() * tangent.norm();
  }
  return effort > 0 ? std::abs(work) / effort : 0;
}

}  // namespace

double loopWork(const ForceField& field, double radius, double least_coverage) {
  RandomCircles circles(radius);
  double largest = std::nan("");
  for (int candidate = 0, used = 0; candidate < candidates && used < most_circles; ++candidate) {
    const auto work = relativeWork(field, circles.next(), least_coverage);
    if (!work) continue;
    ++used;
    largest = std::fmax(largest, *work);
  }
  return largest;
}

}  // namespace palpate
