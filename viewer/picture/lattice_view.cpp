#include "viewer/picture/lattice_view.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "common/base/assertion.hpp"
#include "common/base/index.hpp"
#include "viewer/picture/open_gl.hpp"

namespace palpate {
namespace {

// px of a picture that is 800 pixels high
constexpr double dot_size = 4, dot_size_in_a_cut = 7;
constexpr float dot_rim = 1;

}  // namespace

void LatticeView::setDots(std::span<const LatticeDot> dots, const Eigen::Vector3d& origin,
                          double size) {
  places_.clear();
  colours_.clear();
  for (const LatticeDot& dot : dots) {
    const Eigen::Vector3f place = (origin + dot.displacement).cast<float>();
    places_.insert(places_.end(), place.begin(), place.end());
    for (const double channel : dot.colour)
      colours_.push_back(static_cast<std::uint8_t>(std::lround(channel)));
  }
  size_ = static_cast<float>(size);
}

void LatticeView::show(const BodyView& body, const HapticState& state, const ViewChoices& choices) {
  if (state.model != model_) space_ = 0;
  model_ = state.model;
  const std::span<const SpaceWeight> shares = state.touch.blend.used();
  if (state.touch.touching && !shares.empty())
    space_ = std::ranges::max_element(shares, {}, &SpaceWeight::weight)->space;
  PALPATE_ASSERT(at(space_) < body.model().spaces().size(), "the touch must be on the shown model");
  show(choices.lattice);
  if (!choices.lattice) return;
  const bool errors = choices.errors && body.model().isPrepared(at(state.method));
  const Key wanted{model_, errors ? state.method : -1, space_,
                   choices.cut ? std::optional(choices.plane) : std::nullopt};
  // Do nothing if the dots stay the same, because there are thousands of them.
  if (wanted == filled_) return;
  filled_ = wanted;
  setDots(dotsOf(body.model()), body.originOf(at(space_)),
          choices.cut ? dot_size_in_a_cut : dot_size);
}

std::vector<LatticeDot> LatticeView::dotsOf(const HapticModel& model) {
  const SpaceTable& table = model.spaces()[at(space_)];
  const std::int32_t method = filled_.method;
  if (method < 0) return tagDots(table, filled_.cut);
  auto [found, added] = errors_.try_emplace({model_, method, space_});
  if (added) found->second = cellErrors(table, model.field(at(method), at(space_)));
  return errorDots(found->second, table.lattice.spacing(), filled_.cut);
}

void LatticeView::draw() const {
  if (!shown_) return;
  // Draw in front of the body at any depth, because most points of a space are inside it.
  glClear(GL_DEPTH_BUFFER_BIT);
  glEnable(GL_DEPTH_TEST);
  // A dot has the same depth as its rim, and must be drawn over it.
  glDepthFunc(GL_LEQUAL);
  const auto count = static_cast<GLsizei>(places_.size() / 3);
  glEnableClientState(GL_VERTEX_ARRAY);
  glVertexPointer(3, GL_FLOAT, 0, places_.data());
  // Draw white rims first: without them, dots of the colour of the surface would be invisible.
  glDisableClientState(GL_COLOR_ARRAY);
  glColor3f(1, 1, 1);
  setPointSize(size_ + 2 * dot_rim);
  glDrawArrays(GL_POINTS, 0, count);
  glEnableClientState(GL_COLOR_ARRAY);
  glColorPointer(3, GL_UNSIGNED_BYTE, 0, colours_.data());
  setPointSize(size_);
  glDrawArrays(GL_POINTS, 0, count);
}

}  // namespace palpate
