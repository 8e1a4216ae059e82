#include "viewer/picture/outline.hpp"

#include <array>

#include "common/base/assertion.hpp"

namespace palpate {
namespace {

constexpr float least_share = 0.02F;  // less would not be seen

struct OutlineVertex {
  OutlinePoint point;
  float facing = 0;  ///< > 0: toward the eye
};

/// Where the surface turns between two vertices that face differently.
OutlinePoint crossing(const OutlineVertex& a, const OutlineVertex& b) {
  const float t = a.facing / (a.facing - b.facing);
  return {a.point.place + t * (b.point.place - a.point.place),
          a.point.share + t * (b.point.share - a.point.share)};
}

}  // namespace

void findOutline(const Eigen::Matrix3Xf& positions, const Eigen::Matrix3Xf& normals,
                 std::span<const std::uint32_t> corners, std::span<const float> shares,
                 const Eigen::Vector3f& eye, std::vector<OutlinePoint>& out) {
  PALPATE_ASSERT(std::ssize(shares) == positions.cols(), "every vertex has its share");
  out.clear();
  for (std::size_t t = 0; t < corners.size(); t += 3) {
    std::array<OutlineVertex, 3> vertices;
    float most = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t v = corners[t + c];
      vertices[c].point = {positions.col(v), shares[v]};
      vertices[c].facing = normals.col(v).dot(eye - positions.col(v));
      most = std::max(most, shares[v]);
    }
    if (most < least_share) continue;
    for (std::size_t c = 0; c < 3; ++c) {
      const OutlineVertex& a = vertices[c];
      const OutlineVertex& b = vertices[(c + 1) % 3];
      if ((a.facing > 0) != (b.facing > 0)) out.push_back(crossing(a, b));
    }
  }
  PALPATE_ASSERT(out.size() % 2 == 0, "a triangle is crossed twice, or not at all");
}

}  // namespace palpate
