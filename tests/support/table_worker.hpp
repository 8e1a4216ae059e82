#pragma once

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <deque>
#include <filesystem>
#include <fstream>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <zmq.hpp>

#include "common/base/error.hpp"
#include "common/base/program.hpp"
#include "common/mesh/node_set.hpp"
#include "common/problem/problem.hpp"
#include "common/wire/bundle.hpp"
#include "common/wire/curve.hpp"
#include "common/wire/wire.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/solved_table.hpp"

/// Workers that speak the real protocol and look up their answers, for tests and benchmarks of a
/// real scheduler.
namespace palpate::test {

/// Writes the scene cube.toml to `directory`: a cube of (cells + 1)^3 nodes with `patches` active
/// surface nodes and about `points` points around each of these. No machine completes its build in
/// the time of a test.
inline void writeEndlessScene(const std::filesystem::path& directory, int cells, int patches,
                              double points = 11500) {
  constexpr double radius = 0.05;
  const double spacing = radius * std::cbrt(4 * std::numbers::pi / 3 / points);
  const Mesh mesh = cubeMesh(0.1, cells);
  writeGmsh22(mesh, directory / "cube.msh");
  std::ofstream scene(directory / "cube.toml");
  scene << "name = \"cube\"\nmesh = \"cube.msh\"\n"
        << "[material]\nlaw = \"mooney-rivlin\"\nc10 = 1300.0\nc01 = 1280.0\n"
        << "[fixed]\nbelow = { axis = \"x\", fraction = 0.15 }\n"
        << "[workspace]\nradius = " << radius << "\nspacing = " << spacing
        << "\nmax_force = 100.0\n";
  int active = 0;
  for (const std::int32_t node : surfaceNodes(mesh))
    if (mesh.nodes[static_cast<std::size_t>(node)].x() > 0.05 && active < patches)
      scene << "[[active]]\nname = \"skin-" << ++active << "\"\nnode = " << node << "\n";
}

/// The answer of a linear body: one branch, everything converges. `problem` must outlive it.
class LinearBody {
 public:
  explicit LinearBody(const Problem& problem)
      : problem_(&problem),
        build_(problemId(problem)),
        // The scene must not be adaptive, because coordinates are in spacings.
        at_(Lattice::ofRest(problem.scene.workspace.radius, problem.scene.workspace.spacing, 1)) {}

  std::pair<wire::Result, std::string> solve(std::uint32_t space, const wire::Point& target,
                                             const wire::Point& parent) const {
    constexpr double stiffness = 50;  // N/m
    const LatticePoint at = fromWire(target);
    const Eigen::Vector3d p = at_.displacementOf(at);
    Configuration found;
    found.equilibrium.force = -stiffness * p;
    found.equilibrium.stiffness = -stiffness * Eigen::Matrix3d::Identity();
    found.equilibrium.energy = stiffness / 2 * p.squaredNorm();
    found.fields = fieldsOf(*problem_, space, p, [&](std::size_t n) -> Eigen::Vector3d {
      return p * problem_->mesh.nodes[n].x() / 0.1;
    });
    found.fields.pressure.assign(problem_->pressures.count(), static_cast<float>(p.norm()));
    return resultOf(build_, space, at, fromWire(parent), {std::move(found), {3, 1, 1, 1e-4}});
  }

 private:
  const Problem* problem_;
  ContentId build_;
  Lattice at_;
};

/// A worker whose solves take no time, or `pause` without using a processor, as if it ran on
/// another machine. It counts acknowledgements and never repeats a message, because no peer leaves.
class TableWorker {
 public:
  TableWorker(zmq::context_t& context, const std::string& endpoint,
              const std::optional<KeyFolder>& keys, int number,
              std::chrono::milliseconds pause = {})
      : socket_(makeDealer(context)), pause_(pause) {
    const std::string id = fmt::format("table-worker-{:04}", number);
    socket_.set(zmq::sockopt::routing_id, id);
    if (keys) proveAsClient(socket_, *keys, endpoint);
    if (const auto trouble = connectDealer(socket_, endpoint); !trouble.empty())
      throw failure("{}", trouble);
    hello_ = Clock::now() - std::chrono::hours(1);
    wire::Hello& hello = *introduction_.mutable_hello();
    hello.set_protocol(protocol_version);
    hello.set_version(version());
    hello.set_worker(id);
    hello.set_host("here");
    hello.set_pid(static_cast<std::uint32_t>(getpid()));
    hello.set_kernel_family("baseline");
  }

  zmq::socket_t& socket() { return socket_; }
  std::size_t acknowledged() const { return acknowledged_; }
  std::size_t payloadBytes() const { return payload_bytes_; }

  /// Handles all received messages and delivers the results that are due.
  void turn() {
    // Greet repeatedly, because messages are dropped until the scheduler is running.
    if (!welcome_ && Clock::now() - hello_ > std::chrono::milliseconds(200)) {
      send(introduction_);
      hello_ = Clock::now();
    }
    while (const auto incoming = inbox_.next(socket_, false)) handle(*incoming);
    for (; !work_.empty() && work_.front().due <= Clock::now(); work_.pop_front())
      deliver(work_.front());
    if (welcome_ && Clock::now() - beat_ > std::chrono::seconds(1)) {
      wire::Message message;
      message.mutable_heartbeat();
      send(message);
      beat_ = Clock::now();
    }
    for (const Letter& letter : outbox_.take())
      if (sendMessage(socket_, "", letter.message, letter.payload) != Sent::yes && welcome_)
        throw failure("the scheduler does not accept messages");
  }

 private:
  using Clock = std::chrono::steady_clock;
  struct Solve {
    Clock::time_point due;
    wire::Job job;
    wire::Target target;
    bool last = false;  ///< `target` is the last one of the job
  };

  void handle(const Incoming& incoming) {
    const wire::Message& message = incoming.message;
    if (message.has_refused()) throw failure("refused: {}", message.refused().reason());
    if (message.has_result_ack()) {
      ++acknowledged_;
    } else if (message.has_welcome() && !welcome_) {
      welcome_ = true;
      wire::Message request;
      request.mutable_problem_request();
      send(request);
    } else if (message.has_problem_reply() && !problem_) {
      problem_ = std::make_unique<Problem>(decodeProblem(incoming.payload));
      body_.emplace(*problem_);
      requestJobs(2);
    } else if (message.has_job()) {
      for (const wire::Target& target : message.job().targets()) {
        const auto begins = work_.empty() ? Clock::now() : work_.back().due;
        const bool last = &target == &*message.job().targets().rbegin();
        work_.push_back({begins + pause_, message.job(), target, last});
      }
    }
  }
  void deliver(const Solve& solve) {
    auto [result, payload] =
        body_->solve(solve.job.space(), solve.target.point(), solve.job.start());
    answer(solve.job, solve.target, result);
    payload_bytes_ = payload.size();
    wire::Message delivery;
    *delivery.mutable_result() = std::move(result);
    send(std::move(delivery), payload);
    if (solve.last) requestJobs(1);
  }
  void requestJobs(std::uint32_t credit) {
    wire::Message message;
    message.mutable_request()->set_credit(credit);
    send(message);
  }
  void send(wire::Message message, const std::string& payload = {}) {
    outbox_.add(std::move(message), payload);
  }

  zmq::socket_t socket_;
  Inbox inbox_;
  Bundler outbox_;
  std::chrono::milliseconds pause_;
  std::deque<Solve> work_;
  wire::Message introduction_;
  std::unique_ptr<Problem> problem_;  ///< at a fixed address, because the body refers to it
  std::optional<LinearBody> body_;
  bool welcome_ = false;
  Clock::time_point hello_, beat_;
  std::size_t acknowledged_ = 0, payload_bytes_ = 0;
};

}  // namespace palpate::test
