#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <span>

#include "viewer/devices/device_exchange.hpp"
#include "viewer/haptics/force_guard.hpp"

// A free mass is thrown at tissue, through the real guard and exchange: it may not leave with more
// energy than it had. Time is simulated.
namespace palpate {
namespace {

constexpr double period = 1e-3;
constexpr std::int64_t substeps = 100;  // steps of the mass per period
constexpr double substep = period / substeps;

/// Tissue in x > 0: force k x + h x^3 against x.
struct Tissue {
  double k, h = 0;
  Touch at(double x) const {
    Touch touch;
    touch.touching = x > 0;
    if (!touch.touching) return touch;
    touch.force.x() = -x * (k + h * x * x);
    touch.stiffness(0, 0) = -k - 3 * h * x * x;
    touch.energy = x * x * (0.5 * k + 0.25 * h * x * x);
    return touch;
  }
};

enum class Loop { guarded, raw, ideal };  // ideal: the force follows each substep

struct Throw {
  Tissue tissue;
  double mass, speed;
  Loop loop = Loop::guarded;
  double damping = 0;      ///< N s/m, damping of the device itself
  double phase = -1;       ///< of the device's thread, in periods; negative: read in the tick
  int lost_of = 1 << 20;   ///< one of this many readings is lost
  int first_lost = 0;      ///< index of the first lost reading
  double max_force = 3.3;  ///< N
  std::size_t late = 0;    ///< delay of the force in ticks, for a device that is read in the tick
};

class Bounce {
 public:
  explicit Bounce(const Throw& thrown)
      : thrown_(thrown),
        guard_(options(thrown)),
        position_(-3.3 * period * thrown.speed),
        speed_(thrown.speed) {}

  /// The mass's energy when it leaves, relative to its initial energy.
  double returned() {
    constexpr std::int64_t longest = 2000 * substeps;
    const auto turn = std::llround(thrown_.phase * substeps);
    for (std::int64_t n = 0; n < longest && !isGone(); ++n) {
      now_ = DeviceExchange::Clock::time_point(std::chrono::microseconds(1 + 10 * n));
      if (thrown_.phase >= 0 && n % substeps == turn) takeTurn();
      if (n % substeps == 0) tick();
      if (thrown_.loop == Loop::ideal) force_ = thrown_.tissue.at(position_).force.x();
      speed_ += substep / thrown_.mass * (force_ - thrown_.damping * speed_);
      position_ += substep * speed_;
    }
    return isGone() ? std::pow(speed_ / thrown_.speed, 2) : HUGE_VAL;
  }

 private:
  static GuardOptions options(const Throw& thrown) {
    GuardOptions options = guardFor({"any", thrown.max_force, 400, 0.1}, period);
    options.delay = static_cast<double>(thrown.late) * period;
    return options;
  }
  bool isGone() const {
    return force_ == 0 && position_ < 4 * period * std::min(speed_, 0.0) && speed_ < 0;
  }
  bool loses() {
    return (readings_++ + thrown_.first_lost) % thrown_.lost_of == thrown_.lost_of - 1;
  }
  DeviceReading reading() const { return {{position_, 0, 0}, 0, DeviceStatus::fresh, {}}; }

  /// A turn of the device's thread.
  void takeTurn() {
    if (!loses()) exchange_.deliver(reading(), now_);
    force_ = exchange_.force(now_).x();
  }

  void tick() {
    const bool direct = thrown_.phase < 0;
    if (!direct)
      read_ = exchange_.read(now_);
    else if (loses())
      read_.status = DeviceStatus::repeated;
    else
      read_ = reading();
    GuardInput input;
    input.tool = read_.position;
    input.held = read_.held;
    input.touch = thrown_.tissue.at(read_.position.x());
    input.fresh = read_.status == DeviceStatus::fresh;
    input.lost = read_.status == DeviceStatus::lost;
    const Eigen::Vector3d given = guard_.limit(input).force;
    const Eigen::Vector3d force = thrown_.loop == Loop::raw ? input.touch.force : given;
    if (!direct) return exchange_.write(force);
    under_way_.push_back(force.x());
    if (under_way_.size() <= thrown_.late) return;
    force_ = under_way_.front();
    under_way_.pop_front();
  }

  Throw thrown_;
  ForceGuard guard_;
  DeviceExchange exchange_;
  DeviceExchange::Clock::time_point now_;
  DeviceReading read_;
  std::deque<double> under_way_;
  int readings_ = 0;
  double position_, speed_, force_ = 0;
};

constexpr double masses[] = {0.02, 0.05, 0.15, 1}, speeds[] = {0.05, 0.2, 0.5};
constexpr Tissue soft[] = {{50}, {200}, {400}, {100, 2e6}};
constexpr Tissue hard[] = {{1100}, {2000}, {500, 3e7}};

/// Every combination of these tissues with each mass and speed.
template <class Each>
void forEachThrow(std::span<const Tissue> tissues, Each each) {
  for (const Tissue& tissue : tissues)
    for (const double mass : masses)
      for (const double speed : speeds) {
        SCOPED_TRACE(testing::Message() << "k " << tissue.k << ", h " << tissue.h << ", mass "
                                        << mass << ", speed " << speed);
        each(Throw{.tissue = tissue, .mass = mass, .speed = speed});
      }
}

class Passivity : public testing::TestWithParam<double> {};

TEST_P(Passivity, TheHandGetsBackNoMoreEnergyThanItPutIn) {
  for (const double max_force : {3.3, 12.0})
    for (const std::span<const Tissue> tissues : {std::span<const Tissue>(soft), {hard}})
      forEachThrow(tissues, [&](Throw thrown) {
        thrown.phase = GetParam();
        thrown.max_force = max_force;
        EXPECT_LE(Bounce(thrown).returned(), 1);
        thrown.lost_of = 50;
        for (thrown.first_lost = 0; thrown.first_lost < 50; thrown.first_lost += 7)
          EXPECT_LE(Bounce(thrown).returned(), 1) << thrown.first_lost;
      });
}

TEST(PassivityOfALateLoop, TheHandGetsBackNoMoreEnergyIfTheDelayIsKnown) {
  for (const std::size_t late : {1, 2, 3})
    forEachThrow(soft, [&](Throw thrown) {
      thrown.late = late;
      EXPECT_LE(Bounce(thrown).returned(), 1) << late;
    });
}

TEST_P(Passivity, SoftTissueIsNotDamped) {
  forEachThrow(soft, [&](Throw thrown) {
    thrown.phase = GetParam();
    // A device that is read in the tick is passive without a guard if its damping is at least K T /
    // 2.
    for (const double damping : {0.0, thrown.phase < 0 ? 0.5 * thrown.tissue.k * period : 0}) {
      thrown.damping = damping;
      Throw ideal = thrown;
      ideal.loop = Loop::ideal;
      ideal.max_force = thrown.max_force = 100;  // limit of the tissue, not of the device
      EXPECT_GE(Bounce(thrown).returned(), Bounce(ideal).returned() - 0.02) << damping;
    }
  });
}

TEST_P(Passivity, IsLostWithoutTheGuard) {
  Throw thrown{.tissue = {400}, .mass = 0.05, .speed = 0.2};
  thrown.loop = Loop::raw;
  thrown.phase = GetParam();
  EXPECT_GT(Bounce(thrown).returned(), thrown.phase < 0 ? 1.1 : 1.4);
}

INSTANTIATE_TEST_SUITE_P(DirectAndAtEachPhase, Passivity,
                         testing::Values(-1, 0, 0.25, 0.5, 0.75, 0.99));

}  // namespace
}  // namespace palpate
