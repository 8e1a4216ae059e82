#pragma once

#include <gtest/gtest.h>

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/base/program.hpp"
#include "common/wire/wire.hpp"
#include "scheduler/builds/build.hpp"
#include "tests/support/solved_table.hpp"
#include "tests/support/temporary_directory.hpp"

namespace palpate::test {

inline wire::Message helloOf(const std::string& id, std::uint32_t pid = 1) {
  wire::Message message;
  wire::Hello& hello = *message.mutable_hello();
  hello.set_protocol(protocol_version);
  hello.set_version(version());
  hello.set_worker(id);
  hello.set_host("here");
  hello.set_pid(pid);
  hello.set_kernel_family("baseline");
  return message;
}

inline wire::Message goodbyeOf(const std::string& reason = "") {
  wire::Message message;
  message.mutable_goodbye()->set_reason(reason);
  return message;
}

/// A build in a temporary directory with a simulated clock and simulated workers, which are only
/// names. Tests send messages by hand; outgoing messages are sorted by peer.
class BuildWorld {
 public:
  /// No result is solved twice, so tests control which worker solves which target.
  static CoordinatorSettings withoutChecks() {
    CoordinatorSettings settings;
    settings.spot_checks.share = 0;
    AllotmentSettings& allotment = settings.allotment;
    allotment.overdue_at_least = allotment.overdue_without_any = std::chrono::hours(24 * 365);
    return settings;
  }
  /// This share of the results is solved twice; limits for overdue work are the defaults.
  static CoordinatorSettings checking(double share) {
    CoordinatorSettings settings;
    settings.spot_checks.share = share;
    return settings;
  }

  explicit BuildWorld(CoordinatorSettings settings = withoutChecks(), Problem of = cubeProblem())
      : problem(std::move(of)), settings_(settings) {
    start();
  }

  /// Simulates a kill: everything that is not on disk is lost.
  void restart() {
    build_.reset();
    inbox.clear();
    start();
  }

  void restartWith(CoordinatorSettings settings) {
    settings_ = std::move(settings);
    restart();
  }

  Coordinator& coordinator() { return build_->coordinator(); }
  Build& build() { return *build_; }

  /// Advances the clock in steps, as for a scheduler that runs all the time.
  void pass(std::chrono::milliseconds time) {
    constexpr std::chrono::milliseconds longest{1000};
    do {
      const auto step = std::min(time, longest);
      now += step;
      time -= step;
      settle();
    } while (time.count() > 0);
  }
  /// Advances the clock while the scheduler does nothing.
  void sleep(std::chrono::milliseconds time) { now += time; }
  void send(const std::string& peer, const wire::Message& message,
            const std::string& payload = "") {
    Incoming incoming{peer, message, payload};
    if (const auto key = key_of.find(peer); key != key_of.end()) incoming.key = key->second;
    coordinator().receive(incoming, now);
    collect();
  }
  /// `all_read`: no further messages are waiting.
  Next settle(bool all_read = true) {
    const Next next = coordinator().advance(now, all_read);
    collect();
    return next;
  }

  void join(const std::string& peer, std::uint32_t credit, std::uint32_t pid = 1) {
    send(peer, helloOf(peer, pid));
    request(peer, credit);
  }
  void request(const std::string& peer, std::uint32_t credit) {
    wire::Message message;
    message.mutable_request()->set_credit(credit);
    send(peer, message);
    settle();
  }
  void beat(const std::string& peer, const wire::Job* job = nullptr) {
    wire::Message message;
    wire::Heartbeat& heartbeat = *message.mutable_heartbeat();
    if (job != nullptr) {
      heartbeat.set_solving(true);
      heartbeat.set_job(job->id());
      *heartbeat.mutable_target() = job->targets(0).point();
    }
    send(peer, message);
  }
  void deliver(const std::string& peer, std::uint32_t space, const wire::Point& target,
               const wire::Point& parent) {
    auto [result, payload] = solver(problem, space, fromWire(target), fromWire(parent));
    prove(peer, result);
    if (falsify) falsify(peer, result, payload);
    wire::Message message;
    *message.mutable_result() = result;
    send(peer, message, payload);
  }
  /// Fills in the members that a result repeats from the peer's job for the same target, if any.
  void prove(const std::string& peer, wire::Result& result) const {
    const auto asked = leases_.find({peer, keyOf(result)});
    if (asked == leases_.end()) return;
    result.set_start_id(asked->second.start_id());
    result.set_lease(asked->second.lease());
    // The bits of a result depend on the number of steps.
    result.mutable_cost()->set_steps(static_cast<std::int32_t>(asked->second.steps()));
  }
  void deliver(const std::string& peer, const wire::Job& job) {
    for (const wire::Target& target : job.targets())
      deliver(peer, job.space(), target.point(), job.start());
  }

  /// The peer delivers all its jobs, and requests a new job for each. Returns the number of
  /// targets.
  int work(const std::string& peer) {
    int delivered = 0;
    for (const wire::Job& job : takeJobs(peer)) {
      deliver(peer, job);
      delivered += job.targets_size();
      request(peer, 1);
    }
    return delivered;
  }
  /// Lets worker "a" solve the rest states of both spaces.
  void solveOrigins() {
    join("a", 2);
    for (const wire::Job& job : takeJobs("a")) deliver("a", job);
    pass(std::chrono::milliseconds(25));
    take("a", wire::Message::kResultAck);
  }

  /// Removes the messages of one kind from a peer's inbox and returns them.
  std::vector<wire::Message> take(const std::string& peer, wire::Message::BodyCase kind) {
    std::vector<wire::Message> taken;
    std::erase_if(inbox[peer], [&](const Outgoing& outgoing) {
      if (outgoing.message.body_case() != kind) return false;
      taken.push_back(outgoing.message);
      return true;
    });
    return taken;
  }
  std::vector<wire::Job> takeJobs(const std::string& peer) {
    std::vector<wire::Job> jobs;
    for (const wire::Message& message : take(peer, wire::Message::kJob))
      jobs.push_back(message.job());
    return jobs;
  }
  std::int64_t counter(const std::string& name) {
    const wire::Status status = coordinator().status(now);
    const auto found = status.counters().find(name);
    return found == status.counters().end() ? 0 : found->second;
  }

  /// Lets `peers` (already joined) solve everything.
  void finish(const std::vector<std::string>& peers) {
    for (int turns = 0; !coordinator().complete(); ++turns) {
      ASSERT_LT(turns, 10000) << "the build does not end";
      for (const std::string& peer : peers) work(peer);
      pass(std::chrono::milliseconds(25));
    }
  }

  ContentId sealedContent() {
    build_->seal(directory / "cube.h5");
    return Dataset(directory / "cube.h5").contentId();
  }

  TemporaryDirectory directory;
  const Problem problem;
  Coordinator::Time now = std::chrono::steady_clock::now();
  std::map<std::string, std::vector<Outgoing>> inbox;
  /// The keys of peers that have one.
  std::map<std::string, PublicKey> key_of;
  /// Looks up the answers of workers, and changes them for liars.
  std::function<std::pair<wire::Result, std::string>(const Problem&, std::uint32_t,
                                                     const LatticePoint&, const LatticePoint&)>
      solver = solve;
  std::function<void(const std::string& peer, wire::Result&, std::string& payload)> falsify;

 private:
  void start() { build_ = std::make_unique<Build>(problem, directory / "state", now, settings_); }
  void collect() {
    for (Outgoing& outgoing : coordinator().takeOutbox()) {
      if (outgoing.message.has_job()) note(outgoing.peer, outgoing.message.job());
      inbox[outgoing.peer].push_back(std::move(outgoing));
    }
  }
  void note(const std::string& peer, const wire::Job& job) {
    for (const wire::Target& target : job.targets()) {
      wire::Result& asked =
          leases_[{peer, {job.space(), fromWire(target.point()), fromWire(job.start())}}];
      asked.set_start_id(job.start_id());
      asked.set_lease(target.lease());
      asked.set_steps(target.steps());
    }
  }

  CoordinatorSettings settings_;
  std::unique_ptr<Build> build_;
  std::map<std::pair<std::string, ResultKey>, wire::Result> leases_;
};

}  // namespace palpate::test
