#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "common/base/error.hpp"
#include "viewer/devices/hand_path.hpp"
#include "viewer/haptics/haptic_model.hpp"

namespace palpate {
namespace {

constexpr double approach_seconds = 0.5, press_seconds = 0.6, hold_seconds = 0.2,
                 circle_seconds = 2.4;
constexpr double shortest_move = 0.2;  ///< s
constexpr int circle_pieces = 16;
constexpr int depth_steps = 64;
constexpr double arc_step = std::numbers::pi / 9;

/// Appends waypoints in the order of time.
class PathWriter {
 public:
  void goTo(const Eigen::Vector3d& position, double seconds) {
    if (!waypoints_.empty()) time_ += seconds;
    waypoints_.push_back({time_, position, 0});
  }
  void goAtSpeed(const Eigen::Vector3d& position, double speed) {
    goTo(position, std::max(shortest_move, (position - waypoints_.back().position).norm() / speed));
  }
  std::vector<HandWaypoint> take() { return std::move(waypoints_); }

 private:
  double time_ = 0;
  std::vector<HandWaypoint> waypoints_;
};

/// Where a hand touches one active node.
struct Site {
  Eigen::Vector3d point, normal;  ///< on the surface at rest, m; outward
  double depth;                   ///< m
  double radius;                  ///< m, of the circle
};

/// The largest depth up to `wanted` at which the force, and at all smaller depths, is bearable.
double bearableDepth(const ForceField& field, const Eigen::Vector3d& normal, double wanted,
                     double largest_force) {
  for (int step = 1; step <= depth_steps; ++step) {
    const double depth = wanted * step / depth_steps;
    if (field.evaluate(-depth * normal).force.norm() > largest_force)
      return wanted * (step - 1) / depth_steps;
  }
  return wanted;
}

std::vector<Site> sitesOf(const HapticModel& model, const TouchPathOptions& options) {
  std::vector<Site> sites;
  const TouchSurface& surface = model.surface();
  for (std::size_t s = 0; s < model.spaces().size(); ++s) {
    const std::int32_t vertex = surface.activeVertex(s);
    if (vertex < 0) continue;
    const auto v = static_cast<std::size_t>(vertex);
    const double reach = model.spaces()[s].lattice.radius();
    const Eigen::Vector3d& normal = surface.vertexNormals()[v];
    sites.push_back(
        {surface.vertices()[v], normal,
         bearableDepth(model.field(0, s), normal, options.depth * reach, options.largest_force),
         options.slide * reach});
  }
  if (sites.empty())
    throw badInput("{}: no active node lies on the surface that a hand can touch", model.file());
  return sites;
}

/// Ways outside of a body.
class Surroundings {
 public:
  Surroundings(const TouchSurface& surface, double clearance)
      : surface_(surface), clearance_(clearance) {
    for (const Eigen::Vector3d& vertex : surface.vertices()) middle_ += vertex;
    middle_ /= static_cast<double>(surface.vertices().size());
    for (const Eigen::Vector3d& vertex : surface.vertices())
      radius_ = std::max(radius_, (vertex - middle_).norm());
    radius_ += clearance;
  }

  Eigen::Vector3d before(const Site& site) const { return site.point + clearance_ * site.normal; }

  /// From before one site to before another: straight, where that keeps off the body, else around
  /// it.
  void walk(const Site& from, const Site& to, double speed, PathWriter& path) const {
    if (!keepsOff(before(from), before(to))) {
      const Eigen::Vector3d leave = onSphere(from), arrive = onSphere(to);
      const Eigen::Quaterniond turn =
          Eigen::Quaterniond::FromTwoVectors(leave - middle_, arrive - middle_);
      const double angle = Eigen::AngleAxisd(turn).angle();
      const int pieces = std::max(1, static_cast<int>(std::ceil(angle / arc_step)));
      for (int i = 0; i <= pieces; ++i) {
        const auto part =
            Eigen::Quaterniond::Identity().slerp(static_cast<double>(i) / pieces, turn);
        path.goAtSpeed(middle_ + part * (leave - middle_), speed);
      }
    }
    path.goAtSpeed(before(to), speed);
  }

 private:
  bool keepsOff(const Eigen::Vector3d& from, const Eigen::Vector3d& to) const {
    constexpr int samples = 16;
    for (int i = 1; i < samples; ++i) {
      const NearestPoint nearest = surface_.tree().nearest(from + (to - from) * i / samples);
      if (!nearest.outside || nearest.distance < clearance_ / 2) return false;
    }
    return true;
  }

  /// Where the normal of a site leaves the sphere around the body.
  Eigen::Vector3d onSphere(const Site& site) const {
    const Eigen::Vector3d offset = site.point - middle_;
    const double along = offset.dot(site.normal);
    const double distance =
        -along + std::sqrt(along * along - offset.squaredNorm() + radius_ * radius_);
    return site.point + distance * site.normal;
  }

  const TouchSurface& surface_;
  double clearance_;
  Eigen::Vector3d middle_ = Eigen::Vector3d::Zero();
  double radius_ = 0;
};

/// From before the site into the body, once around in it, and back.
void explore(const TouchSurface& surface, const Site& site, const Eigen::Vector3d& before,
             PathWriter& path) {
  const Eigen::Vector3d inward = -site.depth * site.normal;
  const Eigen::Vector3d across = site.normal.unitOrthogonal(), along = site.normal.cross(across);
  path.goTo(site.point, approach_seconds);
  path.goTo(site.point + inward, press_seconds);
  path.goTo(site.point + inward, hold_seconds);
  for (int i = 0; i <= circle_pieces; ++i) {
    const double angle = 2 * std::numbers::pi * i / circle_pieces;
    const Eigen::Vector3d beside =
        site.point + site.radius * (std::cos(angle) * across + std::sin(angle) * along);
    path.goTo(surface.tree().nearest(beside).position + inward,
              i == 0 ? press_seconds : circle_seconds / circle_pieces);
  }
  path.goTo(site.point + inward, press_seconds);
  path.goTo(before, approach_seconds + press_seconds);
}

}  // namespace

HandPath touchPath(const HapticModel& model, const TouchPathOptions& options) {
  const std::vector<Site> sites = sitesOf(model, options);
  const Surroundings around(model.surface(), options.clearance);
  PathWriter path;
  path.goTo(around.before(sites.front()), 0);
  for (std::size_t i = 0; i < sites.size(); ++i) {
    explore(model.surface(), sites[i], around.before(sites[i]), path);
    if (sites.size() > 1) around.walk(sites[i], sites[(i + 1) % sites.size()], options.speed, path);
  }
  return HandPath(path.take(), HandPath::AtEnd::repeats, "path around " + model.name());
}

}  // namespace palpate
