#include "viewer/picture/shown_lattice.hpp"

#include <optional>

#include "common/base/assertion.hpp"

namespace palpate {
namespace {

constexpr double dot_size = 4, dot_size_in_a_cut = 7;  // px

}  // namespace

void ShownLattice::show(const ShownModel& shown, const HapticState& state,
                        const ViewChoices& choices, LatticeView& view) {
  if (state.model != model_) space_ = 0;
  model_ = state.model;
  double most = 0;
  for (std::int32_t n = 0; state.touch.touching && n < state.touch.blend.size; ++n) {
    const SpaceWeight& share = state.touch.blend.shares[static_cast<std::size_t>(n)];
    if (share.weight > most) space_ = static_cast<std::size_t>(share.space);
    most = std::max(most, share.weight);
  }
  PALPATE_ASSERT(space_ < shown.model().spaces().size(), "the touch is of the model shown");
  view.show(choices.lattice);
  if (!choices.lattice) return;
  const Key wanted{model_,
                   choices.errors ? state.method : -1,
                   space_,
                   choices.cut,
                   choices.plane.axis,
                   choices.plane.offset};
  if (wanted == filled_) return;
  filled_ = wanted;
  view.setDots(dotsOf(shown.model(), state, choices), shown.originOf(space_),
               choices.cut ? dot_size_in_a_cut : dot_size);
}

std::vector<LatticeDot> ShownLattice::dotsOf(const HapticModel& model, const HapticState& state,
                                             const ViewChoices& choices) {
  const SpaceTable& table = model.spaces()[space_];
  const std::optional<LatticeCut> cut = choices.cut ? std::optional(choices.plane) : std::nullopt;
  if (!choices.errors) return tagDots(table, cut);
  const auto method = static_cast<std::size_t>(state.method);
  auto [found, added] = errors_.try_emplace({static_cast<std::size_t>(model_), method, space_});
  if (added) found->second = cellErrors(table, model.field(method, space_));
  return errorDots(found->second, table.lattice.spacing(), cut);
}

}  // namespace palpate
