#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/base/program.hpp"
#include "common/wire/wire.hpp"
#include "scheduler/build.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/temporary_directory.hpp"

namespace palpate::test {

/// A small cube with two active nodes and 33 lattice points around each.
inline Problem cubeProblem(double c10 = 1300) {
  Scene scene;
  scene.name = "cube";
  scene.mesh = "cube.msh";
  scene.regions[0].material.c10 = c10;
  scene.regions[0].material.c01 = 1280;
  scene.fixed.half_spaces = {{0, true, 0.15, std::nullopt}};
  scene.active = {{"tip", Eigen::Vector3d(0.1, 0.05, 0.05), std::nullopt, 0},
                  {"corner", Eigen::Vector3d(0.1, 0.1, 0.1), std::nullopt, 0}};
  scene.workspace = {0.02, 0.01, 8.5, true};
  return resolve(scene, cubeMesh(0.1, 2));
}

/// What a worker would answer: a pure function of the transition. About a quarter of the
/// transitions fail and some points lie beyond max_force. Forces of neighbours contradict each
/// other, so that branches are looked for.
inline std::pair<wire::Result, std::string> solve(const Problem& problem, std::uint32_t space,
                                                  const LatticePoint& target,
                                                  const LatticePoint& parent) {
  std::uint64_t dice = 88172645463325252ull + space;
  for (const LatticePoint& p : {target, parent})
    for (const std::int32_t c : p) {
      dice = (dice ^ static_cast<std::uint64_t>(c + 100)) * 0x9e3779b97f4a7c15ull;
      dice ^= dice >> 29;
    }
  Outcome outcome;
  outcome.cost = {static_cast<std::int32_t>(dice % 9), 3, 2, 0.25};
  const bool origin = target == LatticePoint{};
  outcome.converged = origin || dice % 100 >= 25;
  if (outcome.converged) {
    const double norm = std::sqrt(static_cast<double>(squaredNorm(target)));
    outcome.equilibrium.force = {-3 * norm - 0.1 * static_cast<double>(dice % 40), 0.5,
                                 1e-3 / (1 + norm)};
    outcome.equilibrium.energy =
        norm + 0.01 * static_cast<double>(dice % 7);  // another branch, another energy
    const std::size_t nodes = problem.mesh.nodes.size();
    for (std::size_t n = 0; n < 3 * nodes; ++n)
      outcome.fields.displacement.push_back(static_cast<float>(dice % 1000) +
                                            static_cast<float>(n));
    outcome.fields.pressure.assign(nodes, static_cast<float>(dice % 77));
  } else {
    outcome.failure.cause = static_cast<Cause>(1 + dice % 7);
    outcome.failure.step_reached = static_cast<double>(dice % 11) / 11;
    outcome.failure.residual = dice % 2 == 0 ? std::nan("") : 1;
  }
  wire::Result result;
  result.set_build(std::string(problemId(problem).bytes()));
  result.set_space(space);
  *result.mutable_target() = toWire(target);
  *result.mutable_parent() = toWire(parent);
  result.set_kernel_family("baseline");
  const std::string payload = outcome.converged ? outcome.fields.encode() : std::string();
  toWire(outcome, payload, result);
  return {result, payload};
}

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

/// A build in a temporary directory, a clock that tests move, and workers that are names: messages
/// go in by hand and what comes out is sorted by peer.
class BuildWorld {
 public:
  explicit BuildWorld(CoordinatorSettings settings = {}) : settings_(settings) { start(); }

  /// As after a kill: everything that is not on disk is gone.
  void restart() {
    build_.reset();
    inbox.clear();
    start();
  }

  Coordinator& coordinator() { return build_->coordinator(); }
  Build& build() { return *build_; }

  /// In steps that a scheduler makes which is not stopped meanwhile.
  void pass(std::chrono::milliseconds time) {
    constexpr std::chrono::milliseconds longest{1000};
    do {
      const auto step = std::min(time, longest);
      now += step;
      time -= step;
      settle();
    } while (time.count() > 0);
  }
  /// The scheduler does nothing meanwhile.
  void sleep(std::chrono::milliseconds time) { now += time; }
  void send(const std::string& peer, const wire::Message& message,
            const std::string& payload = "") {
    coordinator().receive({peer, message, payload}, now);
    collect();
  }
  void settle() {
    coordinator().advance(now);
    collect();
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
    auto [result, payload] = solve(problem, space, fromWire(target), fromWire(parent));
    wire::Message message;
    *message.mutable_result() = result;
    send(peer, message, payload);
  }
  void deliver(const std::string& peer, const wire::Job& job) {
    for (const wire::Target& target : job.targets())
      deliver(peer, job.space(), target.point(), job.start());
  }

  /// Takes the messages of one kind out of a peer's inbox.
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

  /// Lets `peers` (joined) solve everything.
  void finish(const std::vector<std::string>& peers) {
    for (int turns = 0; !coordinator().complete(); ++turns) {
      ASSERT_LT(turns, 10000) << "the build does not end";
      for (const std::string& peer : peers)
        for (const wire::Job& job : takeJobs(peer)) {
          deliver(peer, job);
          request(peer, 1);
        }
      pass(std::chrono::milliseconds(25));
    }
  }

  ContentId sealedContent() {
    build_->seal(directory / "cube.h5");
    return Dataset(directory / "cube.h5").contentId();
  }

  TemporaryDirectory directory;
  const Problem problem = cubeProblem();
  Coordinator::Time now = std::chrono::steady_clock::now();
  std::map<std::string, std::vector<Outgoing>> inbox;

 private:
  void start() { build_ = std::make_unique<Build>(problem, directory / "state", settings_); }
  void collect() {
    for (Outgoing& outgoing : coordinator().takeOutbox())
      inbox[outgoing.peer].push_back(std::move(outgoing));
  }

  CoordinatorSettings settings_;
  std::unique_ptr<Build> build_;
};

}  // namespace palpate::test
