#include "viewer/picture/contour.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <map>

#include "common/base/assertion.hpp"

namespace palpate {

Contour::Contour(std::span<const std::uint32_t> corners)
    : corners_(corners.begin(), corners.end()), faces_eye_(corners.size() / 3) {
  PALPATE_ASSERT(corners.size() % 3 == 0, "each triangle must have three corners");
  std::map<std::array<std::uint32_t, 2>, std::uint32_t> open;  // first triangle of each edge whose
                                                               // second triangle is not found yet
  for (std::uint32_t t = 0; t < faces_eye_.size(); ++t)
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t a = corners[3 * t + c], b = corners[3 * t + (c + 1) % 3];
      const auto [found, added] = open.try_emplace({std::min(a, b), std::max(a, b)}, t);
      if (added) continue;
      sides_.push_back({a, b, found->second, t});
      open.erase(found);
    }
  found_.reserve(2 * sides_.size());
}

std::span<const std::uint32_t> Contour::edges(const Eigen::Matrix3Xf& positions,
                                              const Eigen::Vector3f& eye) {
  for (std::size_t t = 0; t < faces_eye_.size(); ++t) {
    const Eigen::Vector3f a = positions.col(corners_[3 * t]);
    const Eigen::Vector3f ab = positions.col(corners_[3 * t + 1]) - a,
                          ac = positions.col(corners_[3 * t + 2]) - a;
    faces_eye_[t] = ab.cross(ac).dot(eye - a) > 0 ? 1 : 0;
  }
  found_.clear();
  for (const Side& side : sides_)
    if (faces_eye_[side.triangle] != faces_eye_[side.neighbour])
      found_.insert(found_.end(), {side.from, side.to});
  return found_;
}

}  // namespace palpate
