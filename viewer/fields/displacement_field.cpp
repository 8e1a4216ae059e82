#include "viewer/fields/displacement_field.hpp"

#include <algorithm>

#include "common/base/cpu_family.hpp"
#include "common/base/error.hpp"
#include "viewer/fields/slot_terms.hpp"

namespace palpate {
namespace {

/// Rows that are added at once: few passes over `out`, and no more pointers than registers.
constexpr std::size_t rows_at_once = 4;

/// out += sum of factors[n] * rows[n].
PALPATE_PER_CPU_FAMILY void addRows(const std::array<const float*, rows_at_once>& rows,
                                    const std::array<float, rows_at_once>& factors, float* out,
                                    std::size_t size) noexcept {
  for (std::size_t i = 0; i < size; ++i)
    out[i] += factors[0] * rows[0][i] + factors[1] * rows[1][i] + factors[2] * rows[2][i] +
              factors[3] * rows[3][i];
}

}  // namespace

DisplacementField::DisplacementField(const SpaceTable& space, std::span<const float> displacements)
    : DisplacementField(CellBranches(space), space.points.size(), displacements) {}

DisplacementField::DisplacementField(const CellBranches& data, std::size_t points,
                                     std::span<const float> displacements)
    : tree_(data.tree) {
  const std::size_t row = displacements.size() / points;
  if (row == 0 || row % 3 != 0 || displacements.size() != row * points)
    throw failure("{} displacement values do not make three per node for {} lattice points",
                  displacements.size(), points);
  const std::vector<CellSlot>& slots = tree_.slots();
  std::vector<std::int32_t> solved;
  for (std::int32_t s = 0; s < std::ssize(slots); ++s)
    if (slots[at(s)].kind == SlotKind::solved) solved.push_back(s);
  if (solved.empty())
    throw failure("no corner of a cell was solved, so there is no shape to continue");
  const auto width = static_cast<Eigen::Index>(row);
  ShapeRows shapes(std::ssize(solved), width);
  for (Eigen::Index n = 0; n < shapes.rows(); ++n) {
    const float* from = displacements.data() + at(slots[at(solved[at(n)])].number) * row;
    shapes.row(n) = Eigen::Map<const Eigen::RowVectorXf>(from, width);
  }
  modes_ = modesOf(shapes, static_cast<float>(largest_shape_error * tree_.radius()));
  if (modeCount() == 0) return;  // nothing moves, and rows without columns lie nowhere
  // Solved slots first, then what is continued from them, then what hangs between both.
  Eigen::MatrixXd shares = Eigen::MatrixXd::Zero(std::ssize(slots), modes_.rows());
  const ShapeRows of_solved = shapes * modes_.transpose();
  for (Eigen::Index n = 0; n < shapes.rows(); ++n)
    shares.row(solved[at(n)]) = of_solved.row(n).cast<double>();
  for (std::int32_t s = 0; s < std::ssize(slots); ++s)
    if (slots[at(s)].kind == SlotKind::ghost)
      for (const SlotTerm& term : continuedFrom(solved, data, s))
        shares.row(s) += term.factor * shares.row(term.slot);
  for (const std::int32_t s : tree_.hangingSlots()) {
    const CellSlot& slot = slots[at(s)];
    const std::array<double, 8> weights = trilinearWeights(slot.local);
    for (std::size_t c = 0; c < 8; ++c)
      shares.row(s) += weights[c] * shares.row(tree_.corners(slot.leaf)[c]);
  }
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
  // The last few are filled up with the first mode, times nothing.
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
