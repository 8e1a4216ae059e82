#include "scheduler/service/pace.hpp"

#include <algorithm>
#include <vector>

#include "common/base/assertion.hpp"

namespace palpate {
namespace {

constexpr std::chrono::seconds pace_window{120};
constexpr std::chrono::seconds between_samples{1};

/// Estimates made between these fractions of the time worked are compared. An earlier estimate
/// knows little of the build; a later one is too recent to show its error.
constexpr double compared_from = 0.15, compared_to = 0.4;
/// An estimate is kept whenever the time worked has grown by this factor.
constexpr double between_estimates = 1.02;
constexpr double largest_factor = 4;
/// Errors up to this factor are not corrected. Some forecasts turn from right to too large near the
/// end of a build, and the correction would make them worse. With this factor, the correction
/// changes little in five of six builds. In the sixth (a flap), estimates were always 2 to 10 times
/// too short.
constexpr double usual_error = 1.6;

}  // namespace

void Pace::note(Time now, std::int64_t found) {
  if (now - samples_.back().when < between_samples) return;
  samples_.push_back({now, found});
  // Keep one sample outside the window, so that the samples cover all of it.
  while (samples_.size() > 2 && now - samples_[1].when >= pace_window) samples_.pop_front();
}

double Pace::perSecond(Time now, std::int64_t found) const {
  PALPATE_ASSERT(!samples_.empty(), "at least one sample must be kept");
  const double elapsed = std::chrono::duration<double>(now - samples_.front().when).count();
  return elapsed > 0 ? static_cast<double>(found - samples_.front().found) / elapsed : 0;
}

void Hindsight::note(double worked, double left) {
  if (!(left > 0)) return;
  if (estimates_.empty() || worked >= between_estimates * estimates_.back().worked)
    estimates_.push_back({worked, left});
  while (estimates_.front().worked < compared_from * worked && estimates_.size() > 1)
    estimates_.pop_front();
}

double Hindsight::factor(double worked, double left) const {
  std::vector<double> factors;
  for (const Estimate& then : estimates_)
    if (then.worked >= compared_from * worked && then.worked <= compared_to * worked)
      factors.push_back((worked - then.worked + left) / then.left);
  if (factors.empty()) return 1;
  const auto middle = factors.begin() + std::ssize(factors) / 2;
  std::ranges::nth_element(factors, middle);
  return std::clamp(*middle / usual_error, 1.0, largest_factor);
}

}  // namespace palpate
