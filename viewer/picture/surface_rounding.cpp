#include "viewer/picture/surface_rounding.hpp"

#include <algorithm>
#include <array>
#include <map>

#include "common/base/assertion.hpp"

namespace palpate {
namespace {

constexpr float sharp = 0.75F;  // cosine of 41 degrees: a larger angle between the normals at the
                                // ends of an edge makes the edge sharp

}  // namespace

SurfaceRounding::SurfaceRounding(std::span<const std::uint32_t> corners, std::size_t vertices)
    : vertices_(vertices) {
  std::map<std::array<std::uint32_t, 2>, std::uint32_t> middles;
  const auto middle = [&](std::uint32_t a, std::uint32_t b) {
    const auto [found, added] = middles.try_emplace(
        {std::min(a, b), std::max(a, b)}, static_cast<std::uint32_t>(vertices_ + middles.size()));
    if (added) ends_.insert(ends_.end(), {std::min(a, b), std::max(a, b)});
    return found->second;
  };
  for (std::size_t t = 0; t < corners.size(); t += 3) {
    const std::uint32_t a = corners[t], b = corners[t + 1], c = corners[t + 2];
    const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    corners_.insert(corners_.end(), {a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca});
  }
}

void SurfaceRounding::fill(Eigen::Matrix3Xf& positions, Eigen::Matrix3Xf& normals) const {
  PALPATE_ASSERT(positions.cols() >= static_cast<Eigen::Index>(vertices()) &&
                     normals.cols() == positions.cols(),
                 "the output must have room for the midpoints of edges");
  for (std::size_t edge = 0; 2 * edge < ends_.size(); ++edge) {
    const std::uint32_t a = ends_[2 * edge], b = ends_[2 * edge + 1];
    const auto middle = static_cast<Eigen::Index>(vertices_ + edge);
    const Eigen::Vector3f across = positions.col(b) - positions.col(a);
    Eigen::Vector3f place = 0.5F * (positions.col(a) + positions.col(b));
    if (normals.col(a).dot(normals.col(b)) > sharp)
      place -= (across.dot(normals.col(a)) * normals.col(a) -
                across.dot(normals.col(b)) * normals.col(b)) /
               8;
    positions.col(middle) = place;
    normals.col(middle) = (normals.col(a) + normals.col(b)).normalized();
  }
}

void SurfaceRounding::fill(std::vector<float>& values) const {
  PALPATE_ASSERT(values.size() >= vertices(), "the output must have room for edge midpoints");
  for (std::size_t edge = 0; 2 * edge < ends_.size(); ++edge)
    values[vertices_ + edge] = 0.5F * (values[ends_[2 * edge]] + values[ends_[2 * edge + 1]]);
}

}  // namespace palpate
