#include "viewer/haptics/live_touch.hpp"

#include <algorithm>
#include <utility>

#include "common/base/error.hpp"
#include "viewer/haptics/haptic_model.hpp"

namespace palpate {
namespace {

/// Largest change of the force per tick of a fade, N and relative to the force.
constexpr double largest_fade_step = 0.005, largest_fade_share = 0.01;
/// Longest fade, s. A hand should not feel a wrong force for longer.
constexpr double longest_fade = 0.3;
/// Time without an answer after which the last ones are not used any longer: in seconds, and as a
/// multiple of the usual time. A hand at 5 cm/s moves by 7.5 mm meanwhile.
constexpr double least_silence = 0.15, silence_factor = 4;
/// Weight of the newest in the usual time between answers.
constexpr double newest_share = 0.3;
/// Duration of the fade to the area alone after such a silence, s.
constexpr double silent_fade = 0.1;

}  // namespace

double followedRadius(const HapticModel& model, ContentId build) {
  if (build != model.buildId())
    throw badInput("the scene is not that of {}: give the scene from which it was built",
                   model.file());
  const std::vector<TouchArea>& areas = model.surface().areas();
  if (areas.empty())
    throw badInput("live solving needs a finger, but no finger touches {}", model.file());
  for (const TouchArea& area : areas)
    if (area.radius != areas.front().radius)
      throw badInput("live solving needs fingers of one radius; {} has several radii",
                     model.file());
  return areas.front().radius;
}

bool hasFibers(const HapticModel& model) {
  return std::ranges::any_of(model.spaces(), &SpaceTable::has_fibers);
}

void LiveTouch::begin(double period) noexcept {
  const double before = waited_;
  waited_ = last_.touching ? waited_ + period : 0;
  const double longest = std::max(least_silence, silence_factor * usual_);
  if (before < longest && waited_ >= longest) correction_.release(silent_fade);
  if (const Answer& answer = answers_.read(); answer.number != taken_) {
    taken_ = answer.number;
    usual_ += newest_share * (std::exchange(waited_, 0) - usual_);
    // If the hand has left the body meanwhile, the answer is of no use.
    if (last_.touching) correction_.add(answer.expansion, fadeOf(answer.expansion, period));
  }
  correction_.setHold(holds_.read());
  correction_.advance(period);
}

/// Returns the duration of the fade to an expansion, s.
double LiveTouch::fadeOf(const Expansion& expansion, double period) const noexcept {
  const std::optional<Hold> hold = correction_.isForHold(expansion) ? last_.hold : std::nullopt;
  const double change =
      (expansion.at(last_.place, last_.displacement, hold).force - last_.force).norm();
  const double allowed = std::max(largest_fade_step, largest_fade_share * last_.force.norm());
  // A smooth step is 1.5 times as steep in its middle as a linear one.
  return std::min(1.5 * period * change / allowed, longest_fade);
}

void LiveTouch::publish(LiveHand hand) noexcept {
  if (last_.touching && !hand.touching) correction_.release();
  hand.hold = holds_.read();
  hold_forces_.write(hand.touching ? correction_.holdForce(hand.place, hand.displacement)
                                   : HoldForce());
  last_ = hand;
  hands_.write(hand);
}

}  // namespace palpate
