#include "viewer/picture/tutorial.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <vector>

#include "viewer/picture/pointed_place.hpp"

namespace palpate {
namespace {

enum class At : std::uint8_t { beside, first, second, turned };

/// What begins at a time and lasts until the next.
struct Step {
  double from;  ///< s
  At goes_to;   ///< where the pointer is at the end
  bool button;
  double wheel;  ///< notches, all along
  const char* caption;
};

constexpr std::array steps = {
    Step{0.0, At::first, false, 0, "Point at the organ: where a ring follows, it can be touched."},
    Step{1.6, At::first, true, 0, "Hold the left button: the tool presses along the normal."},
    Step{3.4, At::second, true, 0, "Move: it slides over the skin."},
    Step{5.4, At::second, true, 6, "Turn the wheel: deeper."},
    Step{7.0, At::second, false, 0, "Let go: it comes out."},
    Step{7.8, At::beside, false, 0, "Drag beside the organ, or with the right button: it turns."},
    Step{8.4, At::turned, true, 0, "Drag beside the organ, or with the right button: it turns."},
    Step{9.4, At::turned, false, 0, "Now you. H shows all keys."},
};

// Heights of the view.
constexpr double slide_length = 0.14;
const Eigen::Vector2d turn_drag = {0.12, 0.03};

/// The middles of the touchable triangles that are seen.
std::vector<Eigen::Vector2d> touchableOnScreen(const TouchSurface& surface,
                                               const OrbitCamera& camera) {
  std::vector<Eigen::Vector2d> found;
  for (std::size_t t = 0; t < surface.triangles().size(); ++t) {
    const auto triangle = static_cast<std::int32_t>(t);
    if (!surface.touchable(triangle)) continue;
    const Eigen::Vector2d place =
        camera.project(surface.position({triangle, Eigen::Vector3d::Constant(1.0 / 3)})).head<2>();
    const std::optional<PointedPlace> first = placeUnder(surface, camera, place);
    if (first && first->triangle == triangle) found.push_back(place);
  }
  return found;
}

/// A place in the view where there is nothing of the body, to the right if there is one.
Eigen::Vector2d besideTheBody(const TouchSurface& surface, const OrbitCamera& camera) {
  for (int step = 5; step < 13; ++step)
    for (const double side : {1.0, -1.0}) {
      const double away = 0.05 * step;
      Eigen::Vector2d place = {side * away, -0.3 * away};
      if (!placeUnder(surface, camera, place)) return place;
    }
  return {0.6, -0.2};
}

}  // namespace

TutorialGesture Tutorial::advance(const HapticModel& model, const OrbitCamera& camera,
                                  double seconds) {
  if (!chosen_) choosePlaces(model, camera);
  const double before = time_;
  time_ = std::min(time_ + seconds, duration);
  const auto next =
      std::ranges::find_if(steps, [&](const Step& step) { return step.from > time_; });
  const Step& now = *std::prev(next);
  const auto place = [&](At at) -> Eigen::Vector2d {
    switch (at) {
      case At::beside: return beside_;
      case At::first: return first_;
      case At::second: return second_;
      case At::turned: return beside_ + turn_drag;
    }
    return beside_;
  };
  const Eigen::Vector2d from = &now == steps.begin() ? beside_ : place(std::prev(&now)->goes_to);
  const double until = next == steps.end() ? duration : next->from, length = until - now.from;
  const double t = std::clamp((time_ - now.from) / length, 0.0, 1.0);
  TutorialGesture gesture;
  gesture.pointer = from + t * t * (3 - 2 * t) * (place(now.goes_to) - from);
  gesture.button = now.button;
  gesture.wheel = now.wheel * std::min(time_ - before, time_ - now.from) / length;
  gesture.caption = now.caption;
  return gesture;
}

/// Once: the body may be turned while it plays.
void Tutorial::choosePlaces(const HapticModel& model, const OrbitCamera& camera) {
  const std::vector<Eigen::Vector2d> seen = touchableOnScreen(model.surface(), camera);
  beside_ = besideTheBody(model.surface(), camera);
  first_ = second_ = beside_;  // where nothing can be touched from here
  chosen_ = true;
  if (seen.empty()) return;
  const Eigen::Vector2d middle = std::accumulate(seen.begin(), seen.end(), Eigen::Vector2d(0, 0)) /
                                 static_cast<double>(seen.size());
  first_ = *std::ranges::min_element(
      seen, {}, [&](const Eigen::Vector2d& place) { return (place - middle).norm(); });
  second_ = *std::ranges::min_element(seen, {}, [&](const Eigen::Vector2d& place) {
    return std::abs((place - first_).norm() - slide_length);
  });
}

}  // namespace palpate
