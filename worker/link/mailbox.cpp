#include "worker/link/mailbox.hpp"

#include <sys/eventfd.h>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"

namespace palpate {

Mailbox::Mailbox(std::chrono::milliseconds gathers_for)
    : gathers_for_(gathers_for), event_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
  if (!event_) throw failure("eventfd: {}", errnoText());
}

void Mailbox::wakeNetwork() {
  // EAGAIN means that the counter is full, so the reader wakes up anyway.
  if (eventfd_write(event_.get(), 1) != 0 && errno != EAGAIN)
    throw failure("eventfd write: {}", errnoText());
}

void Mailbox::put(ReadyJob job) {
  const std::lock_guard lock(mutex_);
  PALPATE_ASSERT(job.problem && !closed_, "a job needs its problem and an open mailbox");
  jobs_.push_back(std::move(job));
  changed_.notify_one();
}

void Mailbox::forgetJobs() {
  const std::lock_guard lock(mutex_);
  jobs_.clear();
  forget_current_ = progress_.heartbeat.solving();
}

void Mailbox::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  changed_.notify_one();
}

std::vector<FinishedTarget> Mailbox::takeFinished() {
  eventfd_t count = 0;
  // The counter is read before the results are taken, so that a result which arrives in between
  // wakes the network thread again.
  if (eventfd_read(event_.get(), &count) != 0 && errno != EAGAIN)
    throw failure("eventfd read: {}", errnoText());
  const std::lock_guard lock(mutex_);
  return std::exchange(finished_, {});
}

std::optional<std::string> Mailbox::solverError() {
  const std::lock_guard lock(mutex_);
  return error_;
}

Mailbox::Progress Mailbox::progress() {
  const std::lock_guard lock(mutex_);
  return progress_;
}

bool Mailbox::hasWork() {
  const std::lock_guard lock(mutex_);
  return !jobs_.empty() || progress_.heartbeat.solving();
}

std::optional<ReadyJob> Mailbox::next(bool waits) {
  std::unique_lock lock(mutex_);
  progress_.heartbeat.set_solving(false);
  // An earlier request to drop the current job concerned the previous job.
  forget_current_ = false;
  if (waits) changed_.wait(lock, [this] { return closed_ || !jobs_.empty(); });
  if (jobs_.empty()) return std::nullopt;
  ReadyJob job = std::move(jobs_.front());
  jobs_.pop_front();
  progress_.heartbeat.set_solving(true);
  progress_.heartbeat.set_job(job.job.id());
  // Until begin() names a target, the solver prepares the start. The start is reported as the
  // target, because its preparation may kill the process too.
  *progress_.heartbeat.mutable_target() = job.job.start();
  ++progress_.begun;
  progress_.hung_after = std::chrono::seconds(job.job.hung_after_s());
  return job;
}

bool Mailbox::begin(std::uint64_t job, const wire::Point& target) {
  const std::lock_guard lock(mutex_);
  PALPATE_ASSERT(progress_.heartbeat.solving() && progress_.heartbeat.job() == job,
                 "a solve must belong to the current job");
  *progress_.heartbeat.mutable_target() = target;
  ++progress_.begun;
  return !forget_current_;
}

void Mailbox::finish(FinishedTarget target) {
  const std::lock_guard lock(mutex_);
  PALPATE_ASSERT(progress_.heartbeat.solving(), "a job must be running when a solve ends");
  const bool last = target.last_of_job;
  finished_.push_back(std::move(target));
  // A result that wakes nobody does not wait forever, because the network thread also polls.
  const auto now = std::chrono::steady_clock::now();
  if (!last && woke_ && now - *woke_ < gathers_for_) return;
  woke_ = now;
  wakeNetwork();
}

void Mailbox::solverEnds(const std::string& error) {
  const std::lock_guard lock(mutex_);
  progress_.heartbeat.set_solving(false);
  if (!error.empty()) error_ = error;
  wakeNetwork();
}

}  // namespace palpate
