#include "viewer/picture/surface_shape.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "common/base/assertion.hpp"
#include "common/base/index.hpp"
#include "viewer/plot/viridis.hpp"

namespace palpate {
namespace {

constexpr int levels = 256;
/// A surface is rounded as long as the result has at most this many triangles. More triangles cost
/// time in software rendering, and a surface with so many triangles already looks smooth.
constexpr std::size_t most_rounded = 16000;
/// Number of smoothing passes at the border of the touchable part. Each pass replaces a vertex's
/// value by the mean of the values around it, so the transition is about this many vertices wide.
constexpr int border_rounds = 2;
/// Wetness of tissue under a colour with a meaning. It is low, because highlights would change the
/// colour.
constexpr double wetness_of_colour = 0.3;

/// A colour over tissue. The result is `seen` times the bytes of the tissue, plus `added`.
struct Cover {
  float seen = 1;
  std::array<float, 4> added = {0.5F, 0.5F, 0.5F, 0.5F};  ///< contains 0.5 for rounding
};

Cover coverOf(const Rgb& colour, double share) {
  Cover cover{static_cast<float>(1 - share)};
  for (std::size_t i = 0; i < 3; ++i) cover.added[i] += static_cast<float>(share * colour[i]);
  cover.added[3] += static_cast<float>(share * 255 * wetness_of_colour);
  return cover;
}

using Covers = std::array<Cover, levels>;

template <class CoverOf>
Covers coversBy(const CoverOf& cover) {
  Covers covers;
  for (int level = 0; level < levels; ++level)
    covers[at(level)] = cover(static_cast<double>(level) / (levels - 1));
  return covers;
}

std::uint32_t packed(const std::array<float, 4>& tissue, const Cover& cover) {
  std::array<std::uint8_t, 4> bytes;
  for (std::size_t i = 0; i < 4; ++i)
    bytes[i] = static_cast<std::uint8_t>(tissue[i] * cover.seen + cover.added[i]);
  return std::bit_cast<std::uint32_t>(bytes);
}

/// Returns the index in a colour table of `levels` entries; place is clamped to 0 to 1.
std::size_t levelAt(float place) {
  return static_cast<std::size_t>(std::clamp(place, 0.0F, 1.0F) * (levels - 1));
}

/// Colours every vertex according to its place; NaN shows the tissue.
void cover(const Covers& covers, std::span<const float> places,
           std::span<const std::array<float, 4>> tissue, std::span<std::uint32_t> colours) {
  for (std::size_t v = 0; v < places.size(); ++v)
    colours[v] = packed(tissue[v], std::isnan(places[v]) ? Cover{} : covers[levelAt(places[v])]);
}

}  // namespace

SurfaceShape::SurfaceShape(const std::vector<Eigen::Vector3d>& vertices,
                           const std::vector<Triangle>& triangles,
                           const std::vector<bool>& touchable)
    : given_(vertices.size()) {
  PALPATE_ASSERT(touchable.size() == triangles.size(), "each triangle must have a touchable flag");
  for (const Triangle& triangle : triangles)
    for (const std::int32_t corner : triangle) {
      PALPATE_ASSERT(corner >= 0 && at(corner) < given_, "triangles must have existing vertices");
      coarse_.push_back(static_cast<std::uint32_t>(corner));
    }
  corners_ = coarse_;
  std::size_t size = given_;
  for (; !corners_.empty() && 4 * corners_.size() <= 3 * most_rounded;
       size = roundings_.back().vertices()) {
    roundings_.emplace_back(corners_, size);
    corners_.assign(roundings_.back().corners().begin(), roundings_.back().corners().end());
  }
  positions_.resize(3, static_cast<Eigen::Index>(size));
  normals_.resizeLike(positions_);
  lengths_.resize(size);
  felt_.resize(size);
  places_.resize(size);
  tissue_.resize(size);
  colours_.resize(size);
  for (std::size_t v = 0; v < given_; ++v)
    positions_.col(static_cast<Eigen::Index>(v)) = vertices[v].cast<float>();
  setNormals();
  rest_ = positions_;
  setFelt(triangles, touchable);
  setTissue();
  colourTissue();
}

void SurfaceShape::round(std::vector<float>& values) const {
  for (const SurfaceRounding& rounding : roundings_) rounding.fill(values);
}

void SurfaceShape::setFelt(const std::vector<Triangle>& triangles,
                           const std::vector<bool>& touchable) {
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (const std::int32_t corner : triangles[t])
      if (touchable[t]) felt_[at(corner)] = 1;
  std::vector<float> sums, counts;
  for (int round = 0; round < border_rounds; ++round) {
    sums.assign(given_, 0);
    counts.assign(given_, 0);
    for (const Triangle& t : triangles) {
      const float mean = (felt_[at(t[0])] + felt_[at(t[1])] + felt_[at(t[2])]) / 3;
      for (const std::int32_t corner : t) {
        sums[at(corner)] += mean;
        ++counts[at(corner)];
      }
    }
    for (std::size_t v = 0; v < given_; ++v)
      if (counts[v] > 0) felt_[v] = sums[v] / counts[v];
  }
  round(felt_);
}

void SurfaceShape::setTissue() {
  if (size() == 0) return;
  const Eigen::Vector3f middle = rest_.rowwise().mean();
  const float radius = (rest_.colwise() - middle).colwise().norm().maxCoeff();
  for (std::size_t v = 0; v < size(); ++v) {
    const Eigen::Vector3f place =
        (rest_.col(static_cast<Eigen::Index>(v)) - middle) / std::max(radius, 1e-9F);
    const Rgb colour = tissueColour(felt_[v], blotchAt(place.cast<double>()));
    for (std::size_t i = 0; i < 3; ++i) tissue_[v][i] = static_cast<float>(colour[i]);
    tissue_[v][3] = 255 * felt_[v];
  }
}

void SurfaceShape::setDisplacements(std::span<const float> displacements) {
  PALPATE_ASSERT(displacements.size() == 3 * given_, "every vertex must have a displacement");
  largest_ = 0;
  for (std::size_t v = 0; v < given_; ++v) {
    const auto column = static_cast<Eigen::Index>(v);
    Eigen::Vector3f u(displacements.data() + 3 * v);
    if (!std::isfinite(u.squaredNorm())) u.setZero();
    positions_.col(column) = rest_.col(column) + u;
    lengths_[v] = u.norm();
    largest_ = std::max(largest_, double{lengths_[v]});
  }
  round(lengths_);
  setNormals();
}

void SurfaceShape::colourTissue() {
  for (std::size_t v = 0; v < size(); ++v) colours_[v] = packed(tissue_[v], {});
}

void SurfaceShape::colourDisplacements(double full) {
  const float scale = full > 0 ? static_cast<float>(1 / full) : 0;
  static const Covers covers = coversBy(
      [](double place) { return coverOf(displacementHue(place), displacementCover(place)); });
  for (std::size_t v = 0; v < size(); ++v)
    colours_[v] = packed(tissue_[v], covers[levelAt(lengths_[v] * scale)]);
}

void SurfaceShape::colourPlaces(std::span<const float> places) {
  PALPATE_ASSERT(places.size() == given_, "every vertex must have a colour coordinate");
  std::ranges::copy(places, places_.begin());
  round(places_);
  static const Covers covers = coversBy([](double place) { return coverOf(viridis(place), 1); });
  cover(covers, places_, tissue_, colours_);
}

void SurfaceShape::colourPressures(std::span<const float> pressures, double full) {
  PALPATE_ASSERT(pressures.size() == given_ && full > 0, "each vertex needs a pressure, or NaN");
  const auto scale = static_cast<float>(0.5 / full);
  std::ranges::transform(pressures, places_.begin(), [=](float p) { return 0.5F + scale * p; });
  round(places_);
  static const Covers covers =
      coversBy([](double place) { return coverOf(pressureColour(2 * place - 1), 1); });
  cover(covers, places_, tissue_, colours_);
}

void SurfaceShape::setNormals() {
  const auto given = static_cast<Eigen::Index>(given_);
  normals_.leftCols(given).setZero();
  for (std::size_t t = 0; t < coarse_.size(); t += 3) {
    const Eigen::Vector3f a = positions_.col(coarse_[t]);
    const Eigen::Vector3f ab = positions_.col(coarse_[t + 1]) - a,
                          ac = positions_.col(coarse_[t + 2]) - a;
    // The length of this vector is twice the area of the triangle, so each normal is weighted by
    // area.
    const Eigen::Vector3f cross = ab.cross(ac);
    for (std::size_t corner = t; corner < t + 3; ++corner) normals_.col(coarse_[corner]) += cross;
  }
  for (auto normal : normals_.leftCols(given).colwise()) normal.normalize();
  for (const SurfaceRounding& rounding : roundings_) rounding.fill(positions_, normals_);
}

}  // namespace palpate
