#include "viewer/haptics/live_touch.hpp"

#include <algorithm>

namespace palpate {

void LiveTouch::begin(double period) noexcept {
  if (const Answer& answer = answers_.read(); answer.number != taken_) {
    taken_ = answer.number;
    // An answer to a hand that has left the body meanwhile is of no use.
    if (touched_) correction_.add(answer.expansion);
  }
  correction_.advance(period);
}

void LiveTouch::publish(const LiveHand& hand) noexcept {
  if (touched_ && !hand.touching) correction_.release();
  touched_ = hand.touching;
  hands_.write(hand);
}

double LiveTouch::correct(const Eigen::Vector3d& s, const Eigen::Vector3d& p,
                          AreaSample& sample) const noexcept {
  if (guessed_) {
    sample.error_bound = std::max(sample.error_bound, sample.force.norm());
    sample.inside = false;
    sample.coverage = 0;
  }
  return correction_.correct(s, p, sample);
}

}  // namespace palpate
