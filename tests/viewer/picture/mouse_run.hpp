#pragma once

#include "tests/viewer/haptics/touched_model.hpp"
#include "viewer/devices/mouse_device.hpp"
#include "viewer/haptics/haptic_tick.hpp"
#include "viewer/picture/framed_sphere.hpp"
#include "viewer/picture/hand_control.hpp"

namespace palpate::test {

/// A person's mouse, the hand that it moves, and the haptic loop of this hand, at 60 frames and
/// 1000 ticks per second of simulated time.
class MouseRun {
 public:
  explicit MouseRun(const HapticModel& model, ContactMode contact = ContactMode::unilateral)
      : model_(model), tick_({&model}, device_, options(contact)) {
    look({0.3, 0.2, 1});
  }

  /// Looks from the direction `from`, with the whole body in view.
  void look(const Eigen::Vector3d& from) {
    const FramedSphere sphere = sphereAround(model_.surface().vertices());
    camera.frame(sphere.centre, sphere.radius, from, Eigen::Vector3d::UnitY(), 1.5);
  }
  Eigen::Vector2d onScreen(const Eigen::Vector3d& point) const {
    return camera.project(point).head<2>();
  }
  /// Repeats the input for some frames; strokes, wheel and keys only act in the first.
  const HapticState& act(HandInput input, int pictures = 1) {
    input.seconds = 1.0 / 60;
    for (int picture = 0; picture < pictures; ++picture) {
      hand.update(model_, tick_.options().contact.mode, camera, input);
      device_.moveTo(hand.target());
      for (int n = 0; n < 16; ++n) touched = tick_.run().touch.touching || touched;
      input.take = input.out = false;
      input.deeper = 0;
      input.strokes.setZero();
    }
    return state();
  }
  /// One frame in which `control` receives mouse and keys, without `hand`.
  const HapticState& act(HandControl& control, const PersonsInput& input) {
    const PictureStatus status{.mouse = true, .contact = tick_.options().contact.mode};
    device_.moveTo(*control.apply(input, model_, state(), status, camera));
    for (int n = 0; n < 16; ++n) touched = tick_.run().touch.touching || touched;
    return state();
  }
  const HapticState& state() const { return tick_.state(); }
  const HapticModel& model() const { return model_; }

  OrbitCamera camera;
  MouseHand hand;
  bool touched = false;  ///< in any tick so far

 private:
  static TickOptions options(ContactMode contact) {
    TickOptions options;
    options.contact.mode = contact;
    options.guard = guardFor(device_profiles.front(), options.period);
    return options;
  }

  const HapticModel& model_;
  MouseDevice device_{1e-3, device_profiles.front()};
  HapticTick tick_;
};

}  // namespace palpate::test
