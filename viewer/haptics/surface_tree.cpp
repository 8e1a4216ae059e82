#include "viewer/haptics/surface_tree.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "common/base/assertion.hpp"
#include "common/base/index.hpp"

namespace palpate {
namespace {

constexpr std::int32_t leaf_size = 4;
/// Large enough for any tree: halving 2^31 triangles down to a leaf takes 30 levels, and each level
/// leaves one entry on the stack.
constexpr std::size_t stack_size = 64;

double angleAt(const Eigen::Vector3d& corner, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d u = a - corner, v = b - corner;
  return std::atan2(u.cross(v).norm(), u.dot(v));
}

double squaredDistance(const Eigen::Vector3d& center, const Eigen::Vector3d& half,
                       const Eigen::Vector3d& point) noexcept {
  return ((point - center).cwiseAbs() - half).cwiseMax(0.0).squaredNorm();
}

/// A segment in the coordinates of the watertight test of Woop, Benthin and Wald (2013), sheared so
/// that it lies on the third axis. The coordinates of a vertex do not depend on the triangle, so
/// two triangles agree on which side of their common edge the segment passes.
class ShearedSegment {
 public:
  ShearedSegment(const Eigen::Vector3d& from, const Eigen::Vector3d& to) noexcept
      : from_(from), half_((to - from) / 2), middle_((to + from) / 2) {
    const Eigen::Vector3d direction = to - from;
    direction.cwiseAbs().maxCoeff(&z_);
    x_ = (z_ + 1) % 3;
    y_ = (z_ + 2) % 3;
    if (direction[z_] < 0) std::swap(x_, y_);
    length_ = direction[z_];
    shear_x_ = direction[x_] / length_;
    shear_y_ = direction[y_] / length_;
    // Allows for the rounding errors of the box test.
    reach_ = half_.cwiseAbs().array() + 1e-13 * (middle_.cwiseAbs() + half_.cwiseAbs()).sum();
  }

  /// Returns whether the segment may meet a box, by the separating-axis test with three axes and
  /// three cross products.
  bool mayMeet(const Eigen::Vector3d& center, const Eigen::Vector3d& half) const noexcept {
    const Eigen::Vector3d m = middle_ - center, room = half + reach_;
    if ((m.cwiseAbs().array() > room.array()).any()) return false;
    const Eigen::Vector3d cross = m.cross(half_).cwiseAbs();
    return cross[0] <= half[1] * reach_[2] + half[2] * reach_[1] + slack(half) &&
           cross[1] <= half[0] * reach_[2] + half[2] * reach_[0] + slack(half) &&
           cross[2] <= half[0] * reach_[1] + half[1] * reach_[0] + slack(half);
  }

  /// Stores the triangle in `best` if the segment enters it from its outer side, and before it
  /// enters the previous `best`.
  void meet(const std::array<Eigen::Vector3d, 3>& corners, std::int32_t triangle,
            Crossing& best) const noexcept {
    const Eigen::Vector3d a = corners[0] - from_, b = corners[1] - from_, c = corners[2] - from_;
    const double ax = a[x_] - shear_x_ * a[z_], ay = a[y_] - shear_y_ * a[z_];
    const double bx = b[x_] - shear_x_ * b[z_], by = b[y_] - shear_y_ * b[z_];
    const double cx = c[x_] - shear_x_ * c[z_], cy = c[y_] - shear_y_ * c[z_];
    const double u = cx * by - cy * bx, v = ax * cy - ay * cx, w = bx * ay - by * ax;
    if (u < 0 || v < 0 || w < 0) return;  // the segment misses the triangle, or comes from inside
    const double sum = u + v + w;
    if (sum <= 0) return;
    const double fraction = (u * a[z_] + v * b[z_] + w * c[z_]) / (sum * length_);
    if (!(fraction >= 0 && fraction <= 1)) return;
    if (best.triangle >= 0 &&
        std::pair(best.fraction, best.triangle) <= std::pair(fraction, triangle))
      return;
    best = {{triangle, Eigen::Vector3d(u, v, w) / sum}, fraction};
  }

 private:
  double slack(const Eigen::Vector3d& half) const noexcept {
    return 1e-13 * half.sum() * reach_.sum();
  }

  Eigen::Vector3d from_, half_, middle_, reach_;
  Eigen::Index x_ = 0, y_ = 0, z_ = 0;
  double length_ = 0, shear_x_ = 0, shear_y_ = 0;
};

}  // namespace

SurfaceTree::SurfaceTree(const std::vector<Eigen::Vector3d>& vertices,
                         const std::vector<Triangle>& triangles) {
  setFaces(vertices, triangles);
  order_ = countUp(triangles.size());
  if (!order_.empty()) build(0, static_cast<std::int32_t>(order_.size()));
}

void SurfaceTree::setFaces(const std::vector<Eigen::Vector3d>& vertices,
                           const std::vector<Triangle>& triangles) {
  std::map<std::pair<std::int32_t, std::int32_t>, Eigen::Vector3d> edge_normals;
  std::vector<Eigen::Vector3d> vertex_normals(vertices.size(), Eigen::Vector3d::Zero());
  const auto edgeOf = [](const Triangle& t, std::size_t c) {
    return std::minmax(t[(c + 1) % 3], t[(c + 2) % 3]);
  };
  faces_.resize(triangles.size());
  for (std::size_t n = 0; n < triangles.size(); ++n) {
    const Triangle& t = triangles[n];
    Face& face = faces_[n];
    for (const std::int32_t corner : t)
      PALPATE_ASSERT(corner >= 0 && at(corner) < vertices.size(),
                     "triangles must refer to existing vertices");
    face.corners = cornersOf(vertices, t);
    face.normal =
        (face.corners[1] - face.corners[0]).cross(face.corners[2] - face.corners[0]).normalized();
    for (std::size_t c = 0; c < 3; ++c) {
      edge_normals.try_emplace(edgeOf(t, c), Eigen::Vector3d::Zero()).first->second += face.normal;
      vertex_normals[at(t[c])] +=
          angleAt(face.corners[c], face.corners[(c + 1) % 3], face.corners[(c + 2) % 3]) *
          face.normal;
    }
  }
  for (std::size_t n = 0; n < triangles.size(); ++n)
    for (std::size_t c = 0; c < 3; ++c) {
      faces_[n].edge_normals[c] = edge_normals.at(edgeOf(triangles[n], c));
      faces_[n].vertex_normals[c] = vertex_normals[at(triangles[n][c])];
    }
}

/// Builds the subtree of `count` triangles and returns its node. Splits at the median of the
/// centroids, along the longest side of their box.
std::int32_t SurfaceTree::build(std::int32_t first, std::int32_t count) {
  PALPATE_ASSERT(count > 0, "no half of a split may be empty");
  Eigen::AlignedBox3d box, centroids;
  const auto centroidOf = [this](std::int32_t triangle) {
    const std::array<Eigen::Vector3d, 3>& corners = faces_[at(triangle)].corners;
    return Eigen::Vector3d((corners[0] + corners[1] + corners[2]) / 3);
  };
  for (std::int32_t n = first; n < first + count; ++n) {
    for (const Eigen::Vector3d& corner : faces_[at(order_[at(n)])].corners) box.extend(corner);
    centroids.extend(centroidOf(order_[at(n)]));
  }
  const auto index = static_cast<std::int32_t>(nodes_.size());
  Node node;
  node.center = box.center();
  // Enlarge the box, so that it contains the corners although its centre is rounded.
  node.half =
      box.sizes() / 2 + Eigen::Vector3d::Constant(1e-15 * (1 + box.max().cwiseAbs().maxCoeff()));
  if (count <= leaf_size) {
    node.first = first;
    node.count = count;
    nodes_.push_back(node);
    return index;
  }
  nodes_.push_back(node);
  Eigen::Index axis = 0;
  centroids.sizes().maxCoeff(&axis);
  const std::int32_t left = count / 2;
  std::nth_element(order_.begin() + first, order_.begin() + first + left,
                   order_.begin() + first + count, [&](std::int32_t a, std::int32_t b) {
                     return std::pair(centroidOf(a)[axis], a) < std::pair(centroidOf(b)[axis], b);
                   });
  build(first, left);
  const std::int32_t right = build(first + left, count - left);
  nodes_[at(index)].first = right;
  return index;
}

NearestPoint SurfaceTree::nearest(const Eigen::Vector3d& point, std::int32_t hint) const noexcept {
  NearestPoint best;
  if (nodes_.empty()) return best;
  double best_squared = std::numeric_limits<double>::infinity();
  const auto consider = [&](std::int32_t triangle) {
    const std::array<Eigen::Vector3d, 3>& corners = faces_[at(triangle)].corners;
    const Eigen::Vector3d barycentric = nearestInTriangle(corners, point);
    const Eigen::Vector3d position = combined(corners, barycentric);
    const double squared = (point - position).squaredNorm();
    if (!(squared < best_squared)) return;
    best_squared = squared;
    best = {{triangle, barycentric}, position};
  };
  if (hint >= 0 && at(hint) < faces_.size()) consider(hint);

  struct Entry {
    std::int32_t node;
    double squared;
  };
  std::array<Entry, stack_size> stack;
  std::size_t size = 0;
  stack[size++] = {0, squaredDistance(nodes_[0].center, nodes_[0].half, point)};
  while (size > 0) {
    const Entry entry = stack[--size];
    if (entry.squared >= best_squared) continue;
    const Node& node = nodes_[at(entry.node)];
    if (node.count > 0) {
      for (std::int32_t n = node.first; n < node.first + node.count; ++n) consider(order_[at(n)]);
      continue;
    }
    const auto entryOf = [&](std::int32_t child) {
      return Entry{child, squaredDistance(nodes_[at(child)].center, nodes_[at(child)].half, point)};
    };
    Entry near = entryOf(entry.node + 1), far = entryOf(node.first);
    if (far.squared < near.squared) std::swap(near, far);
    if (far.squared < best_squared) stack[size++] = far;
    if (near.squared < best_squared) stack[size++] = near;
  }
  if (best.triangle < 0) return best;  // the point is not finite

  best.distance = std::sqrt(best_squared);
  const Face& face = faces_[at(best.triangle)];
  const auto zeros = (best.barycentric.array() == 0).count();
  Eigen::Index edge = 0, vertex = 0;  // the feature that the point lies on, if any
  best.barycentric.minCoeff(&edge);
  best.barycentric.maxCoeff(&vertex);
  const Eigen::Vector3d& normal = zeros == 0   ? face.normal
                                  : zeros == 1 ? face.edge_normals[at(edge)]
                                               : face.vertex_normals[at(vertex)];
  best.outside = (point - best.position).dot(normal) >= 0;
  return best;
}

Crossing SurfaceTree::entry(const Eigen::Vector3d& from, const Eigen::Vector3d& to) const noexcept {
  Crossing best;
  if (nodes_.empty() || from == to || !from.allFinite() || !to.allFinite()) return best;
  const ShearedSegment segment(from, to);
  std::array<std::int32_t, stack_size> stack;
  std::size_t size = 0;
  stack[size++] = 0;
  while (size > 0) {
    const std::int32_t index = stack[--size];
    const Node& node = nodes_[at(index)];
    if (!segment.mayMeet(node.center, node.half)) continue;
    if (node.count == 0) {
      stack[size++] = node.first;
      stack[size++] = index + 1;
      continue;
    }
    for (std::int32_t n = node.first; n < node.first + node.count; ++n) {
      const std::int32_t triangle = order_[at(n)];
      segment.meet(faces_[at(triangle)].corners, triangle, best);
    }
  }
  return best;
}

}  // namespace palpate
