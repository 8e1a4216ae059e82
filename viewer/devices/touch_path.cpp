#include "viewer/devices/touch_path.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "viewer/haptics/haptic_model.hpp"

namespace palpate {
namespace {

constexpr double approach_seconds = 0.5, press_seconds = 0.6, hold_seconds = 0.2,
                 circle_seconds = 2.4;
constexpr double shortest_move = 0.2;  ///< s
/// Distance outside the surface at which the hand approaches and retreats, m.
constexpr double clearance = 0.025;
constexpr double pressed_share = 0.35, circle_share = 0.12;  ///< fraction of the workspace radius
constexpr double largest_force = 1.5;                        ///< N; limits the depth of pressing
constexpr double travel_speed = 0.15;                        ///< speed between active nodes, m/s
constexpr double slide_step = 0.005;                         ///< m between waypoints of a slide
/// Largest number of sites in one slide. The hand then lifts off: if the tool has lost contact at a
/// rim, it can touch the body again only from outside.
constexpr std::size_t most_slid = 12;
/// Two sites are joined by a slide only within these limits: their distance in finger radii, and
/// the cosine of the angle between their normals.
constexpr double longest_slide = 2, least_slide_cosine = 0.6;
constexpr int circle_pieces = 16;
constexpr int depth_steps = 64;
constexpr double arc_step = std::numbers::pi / 9;

/// Appends waypoints in order of time.
class PathWriter {
 public:
  void goTo(const Eigen::Vector3d& position, double seconds) {
    if (!waypoints_.empty()) time_ += seconds;
    waypoints_.push_back({time_, position, 0});
  }
  void travelTo(const Eigen::Vector3d& position) {
    const double way = (position - waypoints_.back().position).norm();
    goTo(position, std::max(shortest_move, way / travel_speed));
  }
  std::vector<HandWaypoint> take() { return std::move(waypoints_); }

 private:
  double time_ = 0;
  std::vector<HandWaypoint> waypoints_;
};

/// A place that the hand touches: one active node, or one site of a finger.
struct Site {
  Eigen::Vector3d point, normal;  ///< point on the surface at rest, m; outward normal
  double depth;                   ///< m
  double radius;                  ///< radius of the circle, m; 0: slide on without a circle
};
/// Sites that are touched without lifting off: one active node, or several sites of a finger, in
/// order.
using Stroke = std::vector<Site>;

/// Returns the largest depth, up to `wanted`, to which the hand can press. At this depth and at all
/// smaller depths the force is known and at most largest_force.
double bearableDepth(const ForceField& field, const Eigen::Vector3d& normal, double wanted) {
  for (int step = 1; step <= depth_steps; ++step) {
    const double depth = wanted * step / depth_steps;
    const ForceSample sample = field.evaluate(-depth * normal);
    if (!sample.inside || sample.force.norm() > largest_force)
      return wanted * (step - 1) / depth_steps;
  }
  return wanted;
}

Site siteAt(const HapticModel& model, std::size_t space, const Eigen::Vector3d& point,
            const Eigen::Vector3d& normal, double radius) {
  const double reach = model.spaces()[space].lattice.radius();
  return {point, normal, bearableDepth(model.field(0, space), normal, pressed_share * reach),
          radius};
}

/// Removes and returns the nearest site. A difference between the normals increases its distance.
Site takeNext(std::vector<Site>& left, const Site& from) {
  const auto next = std::ranges::min_element(left, {}, [&](const Site& site) {
    return (site.point - from.point).norm() * (2 - site.normal.dot(from.normal));
  });
  Site taken = *next;
  left.erase(next);
  return taken;
}

/// Returns strokes that together touch each site of an area once.
std::vector<Stroke> strokesOver(const HapticModel& model, const TouchArea& area) {
  const TouchSurface& surface = model.surface();
  std::vector<Site> left;
  for (const std::size_t space : area.spaces) {
    const NearestPoint at =
        surface.nearestTouchable(model.spaces()[space].patch.finger.value().center);
    left.push_back(siteAt(model, space, at.position, surface.normal(at), 0));
  }
  std::vector<Stroke> strokes;
  for (Site at = takeNext(left, left.front());; at = takeNext(left, at)) {
    const Site* const last = strokes.empty() ? nullptr : &strokes.back().back();
    if (last && strokes.back().size() < most_slid &&
        (last->point - at.point).norm() <= longest_slide * area.radius &&
        last->normal.dot(at.normal) >= least_slide_cosine)
      strokes.back().push_back(at);
    else
      strokes.push_back({at});
    if (left.empty()) return strokes;
  }
}

std::vector<Stroke> strokesOf(const HapticModel& model) {
  PALPATE_ASSERT(model.isPrepared(0), "a path needs forces, which limit its depth");
  std::vector<Stroke> strokes;
  const TouchSurface& surface = model.surface();
  for (std::size_t s = 0; s < model.spaces().size(); ++s) {
    const std::int32_t vertex = surface.activeVertex(s);
    if (vertex < 0 || surface.areaOfSpace(s) >= 0) continue;
    strokes.push_back(
        {siteAt(model, s, surface.vertices()[at(vertex)], surface.vertexNormals()[at(vertex)],
                circle_share * model.spaces()[s].lattice.radius())});
  }
  for (const TouchArea& area : surface.areas())
    for (Stroke& stroke : strokesOver(model, area)) strokes.push_back(std::move(stroke));
  if (strokes.empty())
    throw badInput("{}: no active node lies on the touchable surface", model.file());
  return strokes;
}

/// Plans paths outside a body.
class Surroundings {
 public:
  explicit Surroundings(const TouchSurface& surface) : surface_(surface) {
    const Eigen::Map<const Eigen::Matrix3Xd> vertices(surface.vertices().front().data(), 3,
                                                      std::ssize(surface.vertices()));
    middle_ = vertices.rowwise().mean();
    radius_ = clearance + (vertices.colwise() - middle_).colwise().norm().maxCoeff();
  }

  Eigen::Vector3d before(const Site& site) const { return site.point + clearance * site.normal; }

  /// Moves the hand from the point in front of one site to the point in front of another. It moves
  /// on a straight line if that stays clear of the body, and otherwise around the body.
  void walk(const Site& from, const Site& to, PathWriter& path) const {
    if (!keepsOff(before(from), before(to))) {
      // Go along a great circle of the sphere that encloses the body.
      const Eigen::Vector3d leave = onSphere(from), arrive = onSphere(to);
      const Eigen::Quaterniond turn =
          Eigen::Quaterniond::FromTwoVectors(leave - middle_, arrive - middle_);
      const double angle = Eigen::AngleAxisd(turn).angle();
      const int pieces = std::max(1, static_cast<int>(std::ceil(angle / arc_step)));
      for (int i = 0; i <= pieces; ++i) {
        const auto part =
            Eigen::Quaterniond::Identity().slerp(static_cast<double>(i) / pieces, turn);
        path.travelTo(middle_ + part * (leave - middle_));
      }
    }
    path.travelTo(before(to));
  }

 private:
  bool keepsOff(const Eigen::Vector3d& from, const Eigen::Vector3d& to) const {
    constexpr int samples = 16;
    for (int i = 1; i < samples; ++i) {
      const NearestPoint nearest = surface_.tree().nearest(from + (to - from) * i / samples);
      if (!nearest.outside || nearest.distance < clearance / 2) return false;
    }
    return true;
  }

  /// Returns the point where the line along the normal of a site leaves the sphere around the body.
  Eigen::Vector3d onSphere(const Site& site) const {
    const Eigen::Vector3d offset = site.point - middle_;
    PALPATE_ASSERT(offset.norm() <= radius_, "the sphere must contain the whole body");
    const double along = offset.dot(site.normal);
    const double distance =
        -along + std::sqrt(along * along - offset.squaredNorm() + radius_ * radius_);
    return site.point + distance * site.normal;
  }

  const TouchSurface& surface_;
  Eigen::Vector3d middle_ = Eigen::Vector3d::Zero();
  double radius_ = 0;
};

/// Presses in at a site, slides once in a circle, and retreats.
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
    // Follow the surface, so that the depth stays constant where the surface is curved.
    path.goTo(surface.tree().nearest(beside).position + inward,
              i == 0 ? press_seconds : circle_seconds / circle_pieces);
  }
  path.goTo(site.point + inward, press_seconds);
  path.goTo(before, approach_seconds + press_seconds);
}

/// Presses in at the first site, slides along the surface from site to site, and retreats at the
/// last.
void slide(const TouchSurface& surface, const Stroke& stroke, const Eigen::Vector3d& after,
           double speed, PathWriter& path) {
  path.goTo(stroke.front().point, approach_seconds);
  path.goTo(stroke.front().point - stroke.front().depth * stroke.front().normal, press_seconds);
  for (std::size_t n = 1; n < stroke.size(); ++n) {
    const Site &from = stroke[n - 1], &to = stroke[n];
    const double way = (to.point - from.point).norm();
    const int pieces = std::max(1, static_cast<int>(std::ceil(way / slide_step)));
    for (int i = 1; i <= pieces; ++i) {
      const double share = static_cast<double>(i) / pieces;
      const NearestPoint at = surface.tree().nearest(from.point + share * (to.point - from.point));
      path.goTo(at.position - std::lerp(from.depth, to.depth, share) * surface.normal(at),
                way / pieces / speed);
    }
  }
  path.goTo(after, approach_seconds + press_seconds);
}

}  // namespace

HandPath touchPath(const HapticModel& model, double slide_speed) {
  PALPATE_ASSERT(slide_speed > 0, "the sliding speed must be positive");
  const std::vector<Stroke> strokes = strokesOf(model);
  const Surroundings around(model.surface());
  PathWriter path;
  path.goTo(around.before(strokes.front().front()), 0);
  for (std::size_t i = 0; i < strokes.size(); ++i) {
    const Site &first = strokes[i].front(), &last = strokes[i].back();
    if (first.radius > 0)
      explore(model.surface(), first, around.before(first), path);
    else
      slide(model.surface(), strokes[i], around.before(last), slide_speed, path);
    const Site& next = strokes[(i + 1) % strokes.size()].front();
    if (strokes.size() > 1 || strokes[i].size() > 1) around.walk(last, next, path);
  }
  return HandPath(path.take(), HandPath::AtEnd::repeats, "path around " + model.name());
}

}  // namespace palpate
