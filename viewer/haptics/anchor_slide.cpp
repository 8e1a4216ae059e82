#include "viewer/haptics/anchor_slide.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/index.hpp"

namespace palpate {
namespace {

constexpr int most_pieces = 3;
/// Excess of |T| over the friction limit, relative to the force, below which one Newton step is
/// enough. The step makes the excess about a hundred times smaller, and the next tick slides the
/// rest. Most ticks therefore need two evaluations of the spaces instead of four.
constexpr double small_excess = 0.02;
/// Smaller barycentric coordinates (about 1e-14 m) are set to zero, so the point lies on an edge.
constexpr double on_edge = 1e-12;

/// Direction of steepest descent of W from a point of a triangle.
struct Descent {
  SurfacePoint from;
  double slope = 0;                                     ///< N, >= 0; 0 if W does not fall in any
                                                        ///< direction
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();  ///< unit
  Eigen::Vector3d rate = Eigen::Vector3d::Zero();       ///< 1/m, change of the barycentric
                                                        ///< coordinates per metre
  AnchorSlope energy;
};

/// Stores the direction from one corner to another in `best` if W falls more steeply in this
/// direction than in the direction that `best` holds.
void alongEdge(const TouchSurface& surface, Eigen::Index from, Eigen::Index to,
               const Eigen::Vector3d& drive, Descent& best) noexcept {
  const Triangle& t = surface.triangles()[at(best.from.triangle)];
  const Eigen::Vector3d edge =
      surface.vertices()[at(t[at(to)])] - surface.vertices()[at(t[at(from)])];
  const double length = edge.norm(), slope = drive.dot(edge) / length;
  if (slope <= best.slope) return;
  best.slope = slope;
  best.direction = edge / length;
  best.rate.setZero();
  best.rate[to] = 1 / length;
  best.rate[from] = -1 / length;
}

/// Returns the steepest descent within the triangle. If the direction of steepest descent leaves
/// the triangle, returns the descent along an edge.
Descent descentWithin(const TouchSurface& surface, const SurfacePoint& from,
                      BlendedForce& force) noexcept {
  Descent descent;
  descent.from = from;
  descent.energy = force.slopeAlong(from.triangle);
  const Eigen::Vector3d drive = -descent.energy.tangent;
  const Eigen::Vector3d rate = surface.barycentricGradients(from.triangle).transpose() * drive;
  bool blocked = false;
  for (Eigen::Index c = 0; c < 3; ++c)
    blocked = blocked || (from.barycentric[c] == 0 && rate[c] < 0);
  if (!blocked) {
    descent.slope = drive.norm();
    if (descent.slope > 0) {
      descent.direction = drive / descent.slope;
      descent.rate = rate / descent.slope;
    }
    return descent;
  }
  for (Eigen::Index c = 0; c < 3; ++c) {
    const Eigen::Index a = (c + 1) % 3, b = (c + 2) % 3;
    if (from.barycentric[c] != 0) continue;  // the point is not on the edge opposite to c
    if (from.barycentric[a] > 0) alongEdge(surface, a, b, drive, descent);
    if (from.barycentric[b] > 0) alongEdge(surface, b, a, drive, descent);
  }
  return descent;
}

Descent steepestDescent(const TouchSurface& surface, const SurfacePoint& anchor,
                        BlendedForce& force) noexcept {
  Descent best = descentWithin(surface, anchor, force);
  const auto consider = [&](std::int32_t triangle) {
    if (triangle < 0 || triangle == anchor.triangle || !surface.touchable(triangle)) return;
    if (surface.areaOf(triangle) != surface.areaOf(anchor.triangle)) return;
    const Descent other = descentWithin(surface, surface.seenFrom(triangle, anchor), force);
    if (other.slope > best.slope) best = other;
  };
  const auto zeros = (anchor.barycentric.array() == 0).count();
  for (Eigen::Index c = 0; c < 3; ++c) {
    if (zeros == 1 && anchor.barycentric[c] == 0)
      consider(surface.neighbor(anchor.triangle, static_cast<int>(c)));
    if (zeros == 2 && anchor.barycentric[c] != 0)
      for (const std::int32_t triangle :
           surface.trianglesAt(surface.triangles()[at(anchor.triangle)][at(c)]))
        consider(triangle);
  }
  return best;
}

/// Returns the point that lies `length` along the descent, but no further than the edge of the
/// triangle. Sets `length` to the distance moved.
SurfacePoint moved(const Descent& descent, double& length) noexcept {
  const Eigen::Vector3d &from = descent.from.barycentric, &rate = descent.rate;
  Eigen::Index last = -1;
  for (Eigen::Index c = 0; c < 3; ++c)
    if (rate[c] < 0 && from[c] + length * rate[c] <= 0) {
      length = from[c] / -rate[c];
      last = c;
    }
  SurfacePoint to{descent.from.triangle, from + length * rate};
  if (last >= 0) to.barycentric[last] = 0;
  for (Eigen::Index c = 0; c < 3; ++c)
    if (to.barycentric[c] < on_edge) to.barycentric[c] = 0;
  to.barycentric /= to.barycentric.sum();
  return to;
}

/// Returns the distance that the anchor may slide in this tick, m: min(most_slide, 2 motion +
/// most_relaxation |F| / |dF/dX|).
double wayAllowed(const ContactOptions& options, double motion, const Eigen::Vector3d& force,
                  const Eigen::Matrix3d& change) {
  const double stiffness = change.norm();
  const double relaxed = stiffness > 0 ? options.most_relaxation * force.norm() / stiffness : 0;
  return std::min(options.most_slide, 2 * motion + relaxed);
}

}  // namespace

void slideAnchor(const HapticModel& model, std::size_t method, const ContactOptions& options,
                 const Eigen::Vector3d& tool, double motion, SurfacePoint& anchor,
                 BlendedForce& force) noexcept {
  const TouchSurface& surface = model.surface();
  const auto evaluateAt = [&](const SurfacePoint& point) {
    force.evaluateUnjudged(model, method, point, tool - surface.position(point));
  };
  double gone = 0, allowed = 0, shorter = 1;
  for (int piece = 0; piece < most_pieces; ++piece) {
    const Descent descent = steepestDescent(surface, anchor, force);
    if (piece == 0) allowed = wayAllowed(options, motion, force.force(), descent.energy.change);
    const Eigen::Vector3d normal = surface.normal(anchor);
    const double excess =
        descent.slope - options.friction * std::max(0.0, force.force().dot(normal));
    if (!(excess > 1e-9 * force.force().norm() && gone < allowed)) break;

    // Decrease of the excess per metre of sliding. If it is small or negative, a tenth of the
    // stiffness is used instead, which bounds the length of the step.
    const Eigen::Vector3d& direction = descent.direction;
    const double falls = direction.dot(descent.energy.hessian * direction) +
                         options.friction * normal.dot(descent.energy.change * direction);
    const double stiffness = std::max(falls, 0.1 * force.stiffness().norm());
    const double wanted = shorter * excess / stiffness;
    double length = std::min(wanted, allowed - gone);
    const SurfacePoint next = moved(descent, length);
    const bool was_enough = length == wanted && excess < small_excess * force.force().norm();
    const double energy = force.sum().energy;
    evaluateAt(next);
    if (force.sum().energy > energy + 1e-12 * std::abs(energy)) {
      evaluateAt(anchor);
      shorter /= 4;
      continue;
    }
    anchor = next;
    gone += length;
    if (was_enough) break;
  }
}

}  // namespace palpate
