#include "viewer/fields/pressure_field.hpp"

#include <algorithm>

#include "common/base/error.hpp"
#include "viewer/fields/slot_terms.hpp"

namespace palpate {

PressureField::PressureField(const SpaceTable& space, std::span<const float> pressures)
    : PressureField(CellBranches(space), space.points.size(), pressures) {}

PressureField::PressureField(const CellBranches& data, std::size_t points,
                             std::span<const float> pressures)
    : tree_(data.tree) {
  const std::size_t row = pressures.size() / points;
  if (row == 0 || pressures.size() != row * points)
    throw failure("{} pressures are not one per node for {} lattice points", pressures.size(),
                  points);
  const std::vector<std::vector<SlotTerm>> terms = solvedTerms(data);
  const std::vector<CellSlot>& slots = tree_.slots();
  const auto width = static_cast<Eigen::Index>(row);
  rows_.resize(std::ranges::count(slots, SlotKind::solved, &CellSlot::kind), width);
  std::vector<std::int32_t> row_of(slots.size(), -1);
  std::int32_t rows = 0;
  for (std::size_t s = 0; s < slots.size(); ++s) {
    if (slots[s].kind != SlotKind::solved) continue;
    const float* from = pressures.data() + at(slots[s].number) * row;
    rows_.row(rows) = Eigen::Map<const Eigen::RowVectorXf>(from, width);
    row_of[s] = rows++;
  }
  for (const std::vector<SlotTerm>& of_slot : terms) {
    first_terms_.push_back(terms_.size());
    for (const SlotTerm& term : of_slot)
      terms_.push_back({row_of[at(term.slot)], static_cast<float>(term.factor)});
  }
  first_terms_.push_back(terms_.size());
}

void PressureField::add(const Eigen::Vector3d& displacement, double weight,
                        std::span<float> out) const noexcept {
  LeafPlace place = tree_.find(displacement);
  if (place.leaf < 0) place = tree_.find(nearestInBall(displacement, tree_.radius()));
  if (place.leaf < 0) return;
  Eigen::Map<Eigen::RowVectorXf> sum(out.data(), std::ssize(out));
  const std::array<double, 8> weights = trilinearWeights(place.local);
  for (std::size_t c = 0; c < 8; ++c) {
    if (weights[c] == 0) continue;
    const std::size_t slot = at(tree_.corners(place.leaf)[c]);
    const auto share = static_cast<float>(weight * weights[c]);
    for (std::size_t t = first_terms_[slot]; t < first_terms_[slot + 1]; ++t)
      sum += share * terms_[t].factor * rows_.row(terms_[t].row);
  }
}

}  // namespace palpate
