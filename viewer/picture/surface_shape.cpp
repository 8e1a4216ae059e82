#include "viewer/picture/surface_shape.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>

#include "common/base/assertion.hpp"
#include "common/base/index.hpp"
#include "viewer/plot/viridis.hpp"

namespace palpate {
namespace {

constexpr int levels = 256;
/// What cannot be touched is drawn in a light warm grey with a trace of its colour.
constexpr std::array<double, 3> tissue_grey = {196, 190, 186};
constexpr double trace = 0.3;

std::uint32_t packed(const std::array<double, 3>& colour) {
  const auto byte = [](double value) { return static_cast<std::uint8_t>(std::lround(value)); };
  return std::bit_cast<std::uint32_t>(
      std::array<std::uint8_t, 4>{byte(colour[0]), byte(colour[1]), byte(colour[2]), 255});
}

std::array<double, 3> greyed(const std::array<double, 3>& colour) {
  std::array<double, 3> mixed{};
  for (std::size_t i = 0; i < 3; ++i) mixed[i] = std::lerp(tissue_grey[i], colour[i], trace);
  return mixed;
}

}  // namespace

SurfaceShape::SurfaceShape(const std::vector<Eigen::Vector3d>& vertices,
                           const std::vector<Triangle>& triangles,
                           const std::vector<bool>& touchable)
    : rest_(3, std::ssize(vertices)),
      lengths_(vertices.size()),
      colours_(vertices.size()),
      touchable_(vertices.size(), false) {
  PALPATE_ASSERT(touchable.size() == triangles.size(), "each triangle can be touched, or not");
  for (Eigen::Index v = 0; v < rest_.cols(); ++v) rest_.col(v) = vertices[at(v)].cast<float>();
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (const std::int32_t corner : triangles[t]) {
      PALPATE_ASSERT(corner >= 0 && at(corner) < size(), "triangles are of these vertices");
      corners_.push_back(static_cast<std::uint32_t>(corner));
      if (touchable[t]) touchable_[at(corner)] = true;
    }
  for (int level = 0; level < levels; ++level) {
    const std::array<double, 3> colour = viridis(static_cast<double>(level) / (levels - 1));
    vivid_.push_back(packed(colour));
    grey_.push_back(packed(greyed(colour)));
  }
  setEdges(triangles, touchable);
  positions_ = rest_;
  setNormals();
  setColours(1);
}

void SurfaceShape::setEdges(const std::vector<Triangle>& triangles,
                            const std::vector<bool>& touchable) {
  std::map<Edge, int> touchable_sides;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::size_t side = 0; side < 3; ++side) {
      const std::int32_t a = triangles[t][side], b = triangles[t][(side + 1) % 3];
      touchable_sides[{std::min(a, b), std::max(a, b)}] += touchable[t] ? 1 : 0;
    }
  for (const auto& [edge, sides] : touchable_sides)
    for (const std::int32_t end : edge) {
      edges_.push_back(static_cast<std::uint32_t>(end));
      if (sides == 1) rim_.push_back(static_cast<std::uint32_t>(end));
    }
}

void SurfaceShape::setDisplacements(std::span<const float> displacements) {
  PALPATE_ASSERT(std::ssize(displacements) == rest_.size(), "every vertex has a displacement");
  largest_ = 0;
  for (Eigen::Index vertex = 0; vertex < rest_.cols(); ++vertex) {
    Eigen::Vector3f u(displacements.data() + 3 * vertex);
    if (!std::isfinite(u.squaredNorm())) u.setZero();
    positions_.col(vertex) = rest_.col(vertex) + u;
    lengths_[at(vertex)] = u.norm();
    largest_ = std::max(largest_, double{lengths_[at(vertex)]});
  }
  setNormals();
}

void SurfaceShape::setColours(double full) {
  const float scale = full > 0 ? static_cast<float>((levels - 1) / full) : 0;
  for (std::size_t vertex = 0; vertex < lengths_.size(); ++vertex) {
    const auto level = static_cast<std::size_t>(
        std::min(lengths_[vertex] * scale, static_cast<float>(levels - 1)));
    colours_[vertex] = touchable_[vertex] ? vivid_[level] : grey_[level];
  }
}

void SurfaceShape::setNormals() {
  normals_.setZero(3, positions_.cols());
  for (std::size_t t = 0; t < corners_.size(); t += 3) {
    const Eigen::Vector3f a = positions_.col(corners_[t]);
    const Eigen::Vector3f ab = positions_.col(corners_[t + 1]) - a,
                          ac = positions_.col(corners_[t + 2]) - a;
    // Twice the area long, which weights the sum.
    const Eigen::Vector3f cross = ab.cross(ac);
    for (std::size_t corner = t; corner < t + 3; ++corner) normals_.col(corners_[corner]) += cross;
  }
  for (auto normal : normals_.colwise()) normal.normalize();
}

}  // namespace palpate
