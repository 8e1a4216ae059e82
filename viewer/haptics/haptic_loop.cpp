#include "viewer/haptics/haptic_loop.hpp"

#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <system_error>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "viewer/haptics/real_time.hpp"

namespace palpate {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t stack_bytes = 256 * 1024;  // far more than a tick needs
constexpr std::int64_t publish_ns = 100'000'000;

std::int64_t clockNs(clockid_t clock) noexcept {
  timespec now{};
  clock_gettime(clock, &now);
  return std::int64_t{1'000'000'000} * now.tv_sec + now.tv_nsec;
}
std::int64_t nowNs() noexcept { return clockNs(CLOCK_MONOTONIC); }
std::int64_t processorNs() noexcept { return clockNs(CLOCK_THREAD_CPUTIME_ID); }

double seconds(std::int64_t ns) noexcept { return 1e-9 * static_cast<double>(ns); }

void sleepUntil(std::int64_t ns) noexcept {
  const timespec until = {ns / 1'000'000'000, ns % 1'000'000'000};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
  }
}

/// Maps the pages of the stack, so that no tick causes a page fault on them.
[[gnu::noinline]] void touchStack() noexcept {
  char stack[stack_bytes];
  volatile char* const bytes = stack;
  for (std::size_t at = 0; at < stack_bytes; at += 1024) bytes[at] = 0;
}

}  // namespace

HapticLoop::HapticLoop(HapticTick& tick, HapticDevice& device, const LoopOptions& options)
    : tick_(tick), device_(device), options_(options) {
  if (const double period = tick.options().period; !(std::abs(options.rate * period - 1) < 1e-9))
    throw badInput("a haptic loop at {} Hz cannot run ticks of {} s; give both the same rate",
                   options.rate, period);
  if (!(options.watchdog > 0))
    throw badInput("invalid watchdog time of {} s; give a positive time", options.watchdog);
  if (options.record) {
    recorded_ = std::make_unique<RecordedQueue>();
    while (recorded_->push({})) {
    }
    recorded_->reset();  // free the states; the pages stay mapped
  }
  statistics_.rate = options.rate;
  published_.write(statistics_);
}

HapticLoop::~HapticLoop() { stop(); }

void HapticLoop::start() {
  PALPATE_ASSERT(!started_, "a haptic loop must be started only once");
  started_ = true;
  if (options_.real_time) lockMemory();
  running_ = true;
  device_.resume();
  try {
    thread_ = std::thread([this] { runLoop(); });
    if (!options_.free_running) watchdog_ = std::thread([this] { watch(); });
  } catch (const std::system_error& error) {
    stop();
    running_ = false;
    throw failure(
        "cannot start a thread for the haptic loop: {}; end other programs, or raise ulimit -u",
        error.what());
  }
  std::unique_lock lock(waiting_);
  woken_.wait(lock, [this] { return prepared_; });
  if (!options_.real_time) return;
  if (watchdog_.joinable())
    trouble_ += giveRealTime(watchdog_.native_handle(), "watchdog", watchdog_priority);
  trouble_ += device_.askForRealTime();
}

void HapticLoop::stop() {
  {
    const std::lock_guard lock(waiting_);
    stop_ = true;
  }
  woken_.notify_all();
  if (thread_.joinable()) thread_.join();
  if (watchdog_.joinable()) watchdog_.join();
  if (memory_locked_) munlockall();
  memory_locked_ = false;
}

std::optional<HapticState> HapticLoop::takeRecorded() {
  HapticState state;
  if (!recorded_ || !recorded_->pop(state)) return std::nullopt;
  return state;
}

LoopStatistics HapticLoop::statistics() const {
  LoopStatistics statistics = published_.read();
  statistics.halts = halts_;
  return statistics;
}

void HapticLoop::lockMemory() {
  // If locked memory is limited, locking future pages would make later allocations fail.
  rlimit limit{};
  const bool unlimited = getrlimit(RLIMIT_MEMLOCK, &limit) == 0 && limit.rlim_cur == RLIM_INFINITY;
  memory_locked_ = mlockall(unlimited ? MCL_CURRENT | MCL_FUTURE : MCL_CURRENT) == 0;
  if (!memory_locked_)
    trouble_ += fmt::format(
        "Memory is not locked ({}), so a tick may wait for a page: allow locking with ulimit -l, "
        "\"@realtime - memlock unlimited\" in /etc/security/limits.conf, or "
        "LimitMEMLOCK=infinity in a systemd unit. ",
        errnoText());
}

void HapticLoop::runLoop() {
  pthread_setname_np(pthread_self(), "haptic");
  prctl(PR_SET_TIMERSLACK, 1UL, 0UL, 0UL,
        0UL);  // the kernel's default delays each sleep by up to 50 us
  if (options_.real_time) trouble_ += giveRealTime(pthread_self(), "haptic", loop_priority);
  touchStack();
  {
    const std::lock_guard lock(waiting_);
    prepared_ = true;
  }
  woken_.notify_all();
  usage_at_start_ = usage();
  runTicks();
  device_.write(Eigen::Vector3d::Zero());
  publishStatistics();
  running_.store(false, std::memory_order_release);
}

void HapticLoop::runTicks() {
  const auto period_ns = static_cast<std::int64_t>(std::llround(1e9 / options_.rate));
  std::int64_t due = nowNs() + period_ns, published = due;
  for (bool more = true; more && !stop_.load(std::memory_order_relaxed);) {
    if (!options_.free_running) sleepUntil(due);
    const std::int64_t processor = processorNs(), begin = nowNs();
    more = oneTick(begin);
    const std::int64_t end = nowNs(), computed = processorNs() - processor;
    statistics_.compute.add(seconds(end - begin));
    statistics_.processor.add(seconds(computed));
    if (!options_.free_running) {
      statistics_.latency.add(seconds(begin - due));
      due += period_ns;
      if (end > due) {
        ++(computed > period_ns ? statistics_.missed_program : statistics_.missed_system);
        due = end;
        continue;  // publishing takes time that a late loop does not have
      }
    }
    if (end - published <= publish_ns) continue;
    publishStatistics();
    published = end;
  }
}

/// Runs one tick. Returns false if it was the last one.
bool HapticLoop::oneTick(std::int64_t begin_ns) {
  const double away = last_begin_ns_ == 0 ? 0 : seconds(begin_ns - last_begin_ns_);
  if (last_begin_ns_ != 0) statistics_.period.add(away);
  last_begin_ns_ = begin_ns;
  const bool halted = halted_.load(std::memory_order_acquire);
  // An earlier loop ran this HapticTick, which still holds the last force of that loop, but the
  // device has rendered zero since then.
  const bool goes_on = statistics_.ticks == 0 && tick_.state().tick > 0;
  const bool late = halted || goes_on || (!options_.free_running && away > options_.watchdog);

  HapticCommand command;
  while (commands_.pop(command)) tick_.obey(command);
  const HapticState& state = tick_.run(late);
  const bool lost = state.reading.status == DeviceStatus::lost;
  hand(state);
  ticks_done_.store(statistics_.ticks, std::memory_order_release);
  lost_.store(lost, std::memory_order_release);
  if (halted && !lost) {
    // Clear the flag after resume(), because once it is clear the watchdog may halt the device
    // again.
    device_.resume();
    halted_.store(false, std::memory_order_release);
  }
  return options_.ticks == 0 || statistics_.ticks < options_.ticks;
}

void HapticLoop::hand(const HapticState& state) noexcept {
  count(statistics_, before_, state);
  before_ = state;
  states_.write(state);
  if (!recorded_) return;
  bool taken = recorded_->push(state);
  while (!taken && options_.free_running && !stop_.load(std::memory_order_relaxed)) {
    sched_yield();
    taken = recorded_->push(state);
  }
  if (!taken) ++statistics_.not_recorded;
}

HapticLoop::Usage HapticLoop::usage() noexcept {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return {static_cast<std::uint64_t>(usage.ru_minflt + usage.ru_majflt),
          static_cast<std::uint64_t>(usage.ru_nivcsw)};
}

void HapticLoop::publishStatistics() noexcept {
  const Usage now = usage();
  statistics_.page_faults = now.page_faults - usage_at_start_.page_faults;
  statistics_.preemptions = now.preemptions - usage_at_start_.preemptions;
  published_.write(statistics_);
}

void HapticLoop::watch() {
  const std::chrono::duration<double> limit(options_.watchdog);
  const std::chrono::duration<double> interval =
      std::min<std::chrono::duration<double>>(limit / 4, 10ms);
  auto changed = std::chrono::steady_clock::now();
  std::uint64_t seen = 0;
  std::unique_lock lock(waiting_);
  while (!stop_ && running()) {
    woken_.wait_for(lock, interval);
    // Read this flag first. If it says that the loop has resumed, the values read below were
    // written after the resume.
    const bool halted = halted_.load(std::memory_order_acquire);
    const auto now = std::chrono::steady_clock::now();
    const std::uint64_t done = ticks_done_.load(std::memory_order_acquire);
    if (done != seen) {
      seen = done;
      changed = now;
    }
    const bool hangs = now - changed > limit && running() && !stop_;
    if (halted || !(hangs || lost_.load(std::memory_order_acquire))) continue;
    // Set the flag afterwards, because the loop resumes the device when it sees the flag.
    device_.halt();
    if (hangs) ++halts_;
    halted_.store(true, std::memory_order_release);
  }
}

}  // namespace palpate
