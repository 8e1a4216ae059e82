#pragma once

#include "common/wire/bundle.hpp"
#include "tests/simulation/ledger.hpp"
#include "tests/simulation/network.hpp"
#include "worker/link/worker_session.hpp"

namespace palpate::simulation {

/// The monotonic clock of a process: it runs a little fast or slow, may jump ahead, and never goes
/// back.
class ProcessClock {
 public:
  using Time = std::chrono::steady_clock::time_point;
  ProcessClock() = default;
  explicit ProcessClock(Random& random)
      : offset_(random.between(0, 1e5)), rate_(random.between(0.99, 1.01)) {}

  Time at(Seconds now) const {
    return Time(std::chrono::duration_cast<Time::duration>(
        std::chrono::duration<double>(offset_ + rate_ * now)));
  }
  void leap(Seconds by) { offset_ += by; }
  Seconds secondsUntil(Time time, Seconds now) const {
    return std::chrono::duration<double>(time - at(now)).count() / rate_;
  }

 private:
  double offset_ = 0, rate_ = 1;
};

/// The results that solvers look up, and the accidents of solvers. Shared by all workers.
struct SolverWorld {
  const Scenario* scenario = nullptr;
  /// Transitions that kill every worker that solves them, with the time until which they do so.
  std::map<std::tuple<std::uint32_t, LatticePoint>, Seconds> deadly;
  std::map<std::string, Liar> liars;  ///< by host
  Lies* told = nullptr;
};

/// A worker process with a real session and mailbox, a solver that looks up its answers, and
/// accidents of processes. In the product the solver is a thread; here it is a state.
class WorkerProcess {
 public:
  /// `ended` names the workers that this one replaces. The references must outlive this object.
  WorkerProcess(Network& network, SolverWorld& world, const std::string& id,
                const std::string& host, std::vector<std::string> ended, Seconds now,
                Random random);

  /// How it ended; empty while it runs.
  enum class End : std::uint8_t { left, failed, killed };
  const std::optional<End>& end() const { return end_; }
  const std::string& id() const { return id_; }
  const std::string& peer() const { return peer_; }
  std::size_t unacknowledged() const { return session_->unacknowledged(); }

  Seconds nextWake(Seconds now) const;
  void wake(Seconds now);

  void kill(Seconds now);
  /// Stops the process. If `clock_too`, its machine is suspended, and its clock stops too.
  void stop(Seconds from, Seconds until, bool clock_too);
  void leap(Seconds by) { clock_.leap(by); }
  void interrupt(Seconds now);
  void hangNext() { hang_next_ = true; }
  void runOutOfMemory() { no_memory_ = true; }
  void solveSlowly(Seconds longer) { longer_ = longer; }
  /// How often each kind of accident took effect.
  const std::map<Accident, std::uint64_t>& felt() const { return felt_; }

 private:
  struct Work {
    ReadyJob job;
    int target = 0;
    Seconds done_at = 0;
  };

  void solve(Seconds now);
  void beginTarget(Seconds now);
  void finishTarget();
  void endsWith(End end, Seconds now);

  Network& network_;
  SolverWorld& world_;
  std::string id_, host_, peer_;
  Random random_;
  ProcessClock clock_;
  Seconds now_ = 0;
  std::unique_ptr<Mailbox> mailbox_;
  Inbox inbox_;
  std::unique_ptr<WorkerSession> session_;
  std::optional<Work> work_;
  std::optional<End> end_;
  std::map<Accident, std::uint64_t> felt_;
  Seconds stopped_until_ = 0, next_turn_ = 0, longer_ = 0;
  bool hang_next_ = false, hangs_ = false, no_memory_ = false;
};

}  // namespace palpate::simulation
