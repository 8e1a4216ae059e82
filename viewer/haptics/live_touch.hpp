#pragma once

#include "common/base/bytes32.hpp"
#include "viewer/fields/live_correction.hpp"
#include "viewer/haptics/triple_buffer.hpp"

namespace palpate {

class HapticModel;

/// State of the finger in one tick of the haptic thread.
struct LiveHand {
  double time = 0;  ///< time of the tick, s
  bool touching = false;
  Eigen::Vector3d place = Eigen::Vector3d::Zero();         ///< rest position of the anchor, m
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  ///< m
  Eigen::Vector3d force = Eigen::Vector3d::Zero();         ///< force of the tissue, N
  std::optional<Hold> hold = {};                           ///< set by LiveTouch
};

/// Returns the radius of the fingers that touch a model, m. Error (bad input) if the build id of
/// the model is not `build` (problemId of a scene), if no finger touches the model, or if its
/// fingers have several radii.
double followedRadius(const HapticModel& model, ContentId build);
/// Returns whether the body has fibres (SpaceTable::has_fibers).
bool hasFibers(const HapticModel& model);

/// Statistics of a live solver: how well it keeps up with the hand.
struct LiveStatistics {
  std::uint64_t answers = 0;   ///< number of equilibria received
  std::uint64_t failures = 0;  ///< number of hand positions without an equilibrium
  std::uint64_t restarts = 0;  ///< number of restarts and reconnections of the live solver
  double seconds = 0;  ///< s, time from question to answer, summed over answers and failures
  double largest_seconds = 0;  ///< s, largest time from question to answer

  double meanSeconds() const {  ///< mean time from question to answer, s; 0 before the first answer
    const std::uint64_t count = answers + failures;
    return count > 0 ? seconds / static_cast<double>(count) : 0;
  }
};

/// Passes the state of the hand from the haptic thread to the thread that asks the live solver
/// (LiveLink), and equilibria back. Wait-free on both sides; only the newest value of each is kept.
/// Belongs to the areas of one model, whose fingers have the same radius.
///
/// A second finger of this radius can hold the body while the hand touches it. It sticks to its
/// place, which may slide, and also pulls. It has no effect on the hand until the live solver has
/// answered.
class LiveTouch {
 public:
  /// As for LiveCorrection.
  explicit LiveTouch(double finger_radius, bool has_fibers = false)
      : radius_(finger_radius), correction_(finger_radius, has_fibers) {}

  double fingerRadius() const { return radius_; }  ///< m

  // The haptic thread; real time.
  /// Takes a new equilibrium, if there is one, and advances the fade to it by `period` seconds. If
  /// none has come for four times as long as usual, and 0.15 s, fades to the area alone. A
  /// fade changes the force per tick by at most 1 % or 5 mN, whichever is more. It is faster only
  /// if it would otherwise take longer than 0.3 s, or if a different equilibrium arrives during the
  /// fade.
  void begin(double period) noexcept;
  void publish(LiveHand hand) noexcept;
  /// Corrects a sample of the area and returns the share of the expansions, as
  /// LiveCorrection::correct() does.
  double correct(const Eigen::Vector3d& s, const Eigen::Vector3d& p,
                 AreaSample& sample) const noexcept {
    return correction_.correct(s, p, sample);
  }

  // The thread that moves the hold; real time.
  /// Moves the hold; nullopt ends it. A jump is a new hold (LiveCorrection::setHold).
  void setHold(const std::optional<Hold>& hold) noexcept { holds_.write(hold); }
  /// Returns the force on the hold in the last tick; NaN without a hold, while the hand does not
  /// touch, and before the live solver has answered.
  const HoldForce& holdForce() noexcept { return hold_forces_.read(); }

  // The thread that asks the live solver.
  const LiveHand& hand() noexcept { return hands_.read(); }
  void answer(const Expansion& expansion) noexcept { answers_.write({++answered_, expansion}); }

 private:
  struct Answer {
    std::uint64_t number = 0;  ///< number of the answer, from 1
    Expansion expansion;
  };
  double fadeOf(const Expansion& expansion, double period) const noexcept;

  const double radius_;
  TripleBuffer<LiveHand> hands_;
  TripleBuffer<std::optional<Hold>> holds_;
  TripleBuffer<HoldForce> hold_forces_;
  TripleBuffer<Answer> answers_;
  std::uint64_t answered_ = 0;  ///< number of answers; used by the asking thread

  // Used by the haptic thread.
  LiveCorrection correction_;
  std::uint64_t taken_ = 0;
  double waited_ = 0;  ///< s, since the last answer or the beginning of the contact
  double usual_ = 0;   ///< s, mean of such times
  LiveHand last_;      ///< the hand that was published last
};

}  // namespace palpate
