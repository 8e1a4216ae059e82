#pragma once

#include <functional>
#include <set>

#include "common/wire/bundle.hpp"
#include "scheduler/builds/build.hpp"
#include "scheduler/service/transport.hpp"
#include "tests/simulation/disk.hpp"
#include "tests/simulation/ledger.hpp"
#include "tests/simulation/worker.hpp"

namespace palpate::simulation {

/// A scheduler process: the real Build with all its parts, and the steps of `serve` around it
/// (scheduler/verbs/served_build.cpp).
class SchedulerProcess : private Transport {
 public:
  SchedulerProcess(Network& network, Disk& disk, Ledger& ledger, const Problem& problem,
                   std::filesystem::path folder, const SpotCheckSettings& spot_checks,
                   Random& random);
  ~SchedulerProcess() override;

  enum class State : std::uint8_t { down, running, leaving, sealed, stopped, stuck };
  State state() const { return state_; }
  bool up() const { return build_ != nullptr; }
  std::filesystem::path stateDirectory() const { return folder_ / "state"; }
  std::filesystem::path dataset() const { return folder_ / "out.h5"; }

  void start(Seconds now);
  Seconds nextWake(Seconds now) const;
  void wake(Seconds now);

  /// Kills the process at once (SIGKILL), while it waits.
  void kill();
  /// Kills the process after this many changes of the disk, counted from the next verdict on a
  /// liar.
  void killAtVerdict(int changes) { kill_at_verdict_ = changes; }
  void stop(Seconds from, Seconds until, bool clock_too);
  void leap(Seconds by) { clock_.leap(by); }
  void askToStop(Seconds now);
  /// Time at which the current coordinator was created.
  Seconds openedAt() const { return opened_at_; }
  Coordinator& coordinator() { return build_->coordinator(); }
  /// The error that last ended the process; empty if it ended without one.
  const std::string& lastError() const { return last_error_; }
  /// How often each kind of accident took effect.
  const std::map<Accident, std::uint64_t>& felt() const { return felt_; }

 private:
  std::optional<Incoming> receive() override;
  Sent send(const Outgoing& message) override;
  void note(const std::string& peer, const wire::Message& message);

  void guarded(const std::function<void()>& step);
  void open(Seconds now);
  void turn(Seconds now);
  void keepOut(const std::vector<KeptOut>& liars, Seconds now);
  void openAnew(Seconds now);
  void seal(Seconds now);
  void leave();
  void end(State state);

  Network& network_;
  Disk& disk_;
  Ledger& ledger_;
  const Problem& problem_;
  const std::filesystem::path folder_;
  CoordinatorSettings settings_;
  ProcessClock clock_;
  Seconds now_ = 0, stopped_until_ = 0, next_turn_ = 0, leaves_at_ = 0, opened_at_ = 0;
  Inbox inbox_;
  std::unique_ptr<Build> build_;
  State state_ = State::down;
  std::string last_error_;
  int damages_ = 0;
  std::optional<int> kill_at_verdict_;
  std::map<Accident, std::uint64_t> felt_;
  bool sealed_ = false;  ///< this process has sealed the dataset
};

}  // namespace palpate::simulation
