#include "scheduler/web/status_board.hpp"

#include <algorithm>

#include "common/base/assertion.hpp"

namespace palpate {

std::optional<StatusBoard::Snapshot> StatusBoard::ask(std::chrono::milliseconds patience) {
  std::unique_lock lock(mutex_);
  if (!isFresh(Clock::now())) {
    asked_ = true;
    made_.wait_for(lock, patience, [this] { return isFresh(Clock::now()); });
  }
  if (!status_) return std::nullopt;
  const Snapshot snapshot{status_, Clock::now() - made_at_};
  PALPATE_ASSERT(snapshot.age.count() >= 0, "ask() and offer() must use the same clock");
  return snapshot;
}

void StatusBoard::offer(const std::function<wire::Status()>& make) {
  if (!asked_.load(std::memory_order_relaxed)) return;
  const auto began = Clock::now();
  {
    const std::lock_guard lock(mutex_);
    if (isFresh(began)) return;
  }
  auto status = std::make_shared<const wire::Status>(make());
  const auto ended = Clock::now();
  const std::lock_guard lock(mutex_);
  status_ = std::move(status);
  made_at_ = ended;
  good_until_ =
      ended + std::max<Clock::duration>(good_for_at_least, times_its_cost * (ended - began));
  asked_ = false;
  made_.notify_all();
}

}  // namespace palpate
