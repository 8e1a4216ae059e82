#include "scheduler/service/pace.hpp"

namespace palpate {
namespace {

using std::chrono::seconds;

constexpr seconds window{120};
constexpr seconds between_samples{1};

}  // namespace

void Pace::note(Time now, std::int64_t found) {
  if (now - samples_.back().when < between_samples) return;
  samples_.push_back({now, found});
  // The oldest may lie outside of the window, so that the rest covers it whole.
  while (samples_.size() > 2 && now - samples_[1].when >= window) samples_.pop_front();
}

double Pace::perSecond(Time now, std::int64_t found) const {
  const double elapsed = std::chrono::duration<double>(now - samples_.front().when).count();
  return elapsed > 0 ? static_cast<double>(found - samples_.front().found) / elapsed : 0;
}

}  // namespace palpate
