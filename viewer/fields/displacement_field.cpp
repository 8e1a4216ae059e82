#include "viewer/fields/displacement_field.hpp"

#include <algorithm>

#include "common/base/assertion.hpp"
#include "common/base/cpu_family.hpp"

namespace palpate {
namespace {

/// Number of rows added in one pass over `out`. More rows make fewer passes, but need more pointers
/// than there are registers.
constexpr std::size_t rows_at_once = 4;

/// Adds the sum of factors[n] * rows[n] to `out`.
PALPATE_PER_CPU_FAMILY void addRows(const std::array<const float*, rows_at_once>& rows,
                                    const std::array<float, rows_at_once>& factors, float* out,
                                    std::size_t size) noexcept {
  for (std::size_t i = 0; i < size; ++i)
    out[i] += factors[0] * rows[0][i] + factors[1] * rows[1][i] + factors[2] * rows[2][i] +
              factors[3] * rows[3][i];
}

}  // namespace

DisplacementField::DisplacementField(const SpaceTable& space, std::span<const float> displacements)
    : DisplacementField(PointBlend(space), displacements) {}

DisplacementField::DisplacementField(const PointBlend& blend, std::span<const float> displacements)
    : tree_(blend.tree()) {
  const ShapeRows shapes = blend.rowsOf(displacements, 3);
  PALPATE_ASSERT(shapes.rows() == std::ssize(blend.points()), "each point must have values");
  modes_ = modesOf(shapes, static_cast<float>(largest_shape_error * tree_.radius()));
  if (modeCount() == 0) return;  // no node moves in any shape, and there are no rows to multiply
  const Eigen::MatrixXd of_points = (shapes * modes_.transpose()).cast<double>();
  Eigen::MatrixXd shares = Eigen::MatrixXd::Zero(std::ssize(tree_.slots()), modes_.rows());
  for (Eigen::Index s = 0; s < shares.rows(); ++s)
    for (const PointShare& share : blend.ofSlot(static_cast<std::int32_t>(s)))
      shares.row(s) += share.factor * of_points.row(share.row);
  shares_ = shares.cast<float>();
}

bool DisplacementField::evaluate(const Eigen::Vector3d& displacement,
                                 std::span<float> out) const noexcept {
  LeafPlace place = tree_.find(displacement);
  const bool in_ball = place.leaf >= 0;
  if (!in_ball) place = tree_.find(nearestInBall(displacement, tree_.radius()));
  if (displacement.array().isNaN().any() || place.leaf < 0) {
    std::ranges::fill(out, 0.0f);
    return false;
  }
  evaluateIn(place, out);
  return in_ball && !tree_.unsupported(place.leaf);
}

void DisplacementField::evaluateIn(const LeafPlace& place, std::span<float> out) const noexcept {
  const std::array<double, 8> weights = trilinearWeights(place.local);
  std::ranges::fill(out, 0.0f);
  // Each pass adds rows_at_once modes. Unused entries of the last pass hold the first mode with
  // factor 0.
  for (std::size_t first = 0; first < modeCount(); first += rows_at_once) {
    std::array<const float*, rows_at_once> rows;
    std::array<float, rows_at_once> factors{};
    rows.fill(modes_.data());
    for (std::size_t n = 0; n < rows_at_once && first + n < modeCount(); ++n) {
      const auto mode = static_cast<Eigen::Index>(first + n);
      rows[n] = modes_.row(mode).data();
      for (std::size_t c = 0; c < 8; ++c)
        factors[n] += static_cast<float>(weights[c]) * shares_(tree_.corners(place.leaf)[c], mode);
    }
    addRows(rows, factors, out.data(), out.size());
  }
}

}  // namespace palpate
