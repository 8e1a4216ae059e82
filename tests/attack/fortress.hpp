#pragma once

#include <atomic>
#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/support/table_worker.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/system/process.hpp"

namespace palpate::test {

/// The target: a real `palpate-scheduler serve` with keys on a port of this machine, and four
/// honest workers as if on their own machines, each with 10 ms for a solve.
class Fortress {
 public:
  Fortress() {
    writeEndlessScene(directory_.path(), 10, 8);  // enough work for four minutes
    scheduler_.emplace(
        "palpate-scheduler",
        std::vector<std::string>{"serve", "cube.toml", "--listen", "tcp://127.0.0.1:*", "--state",
                                 "state", "-o", "cube.h5", "--quiet"},
        directory_.path());
    if (!eventually([&] {
          endpoint_ = endpointAnnouncedIn(directory_ / "state");
          return !endpoint_.empty() || !scheduler_->running();
        }) ||
        endpoint_.empty())
      throw failure("the scheduler does not listen: {}", scheduler_->output());
    honest_ = std::jthread([this](const std::stop_token& stop) { work(stop); });
    if (!eventually([&] { return acknowledged() > 200; }))
      throw failure("nothing is acknowledged: {}", scheduler_->output());
  }

  const std::string& endpoint() const { return endpoint_; }
  bool stands() { return scheduler_->running(); }
  std::string log() { return scheduler_->output(); }
  /// Number of the honest workers' results on disk.
  std::size_t acknowledged() const { return acknowledged_; }

  /// Creates and admits a key pair of a stranger with these roles.
  KeyFolder stranger(const std::string& name, const std::string& roles) const {
    const KeyFolder theirs(directory_ / name);
    keys().allow({theirs.ownOrNew().open(), rolesOf(roles), name});
    theirs.trust(keys().own().open(), "*");
    // The scheduler reads the list again within a second; libzmq does not reconnect after a
    // refusal.
    std::this_thread::sleep_for(std::chrono::milliseconds(1500));
    return theirs;
  }
  KeyFolder keys() const { return KeyFolder(directory_ / "keys"); }

  /// Acknowledged results per second, averaged over `time`.
  double rate(std::chrono::milliseconds time) const {
    const auto began = std::chrono::steady_clock::now();
    const std::size_t before = acknowledged_;
    std::this_thread::sleep_for(time);
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - began;
    return static_cast<double>(acknowledged_ - before) / taken.count();
  }

  /// Returns the time that a new connection waits for the status.
  std::chrono::milliseconds statusAfter() {
    const auto began = std::chrono::steady_clock::now();
    zmq::socket_t socket = makeDealer(context_);
    socket.set(zmq::sockopt::immediate, false);
    proveAsClient(socket, keys(), endpoint_);
    if (const auto trouble = connectDealer(socket, endpoint_); !trouble.empty())
      throw failure("{}", trouble);
    wire::Message question;
    question.mutable_status_request();
    if (sendMessage(socket, "", question) != Sent::yes) throw failure("the status: cannot send");
    const auto waited = [&] {
      return std::chrono::ceil<std::chrono::milliseconds>(std::chrono::steady_clock::now() - began);
    };
    constexpr std::chrono::seconds patience{10};
    while (waited() < patience) {
      waitForMessages(socket, std::chrono::milliseconds(100));
      if (const auto incoming = receiveMessage(socket, false);
          incoming && incoming->message.has_status_reply()) {
        const auto taken = waited();
        status_ = nlohmann::json::parse(incoming->message.status_reply().json());
        return taken;
      }
    }
    return patience;
  }

  /// A counter of the latest status.
  std::int64_t counter(const std::string& name) const {
    return status_.at("counters").value(name, std::int64_t{0});
  }

  std::size_t workers() const { return status_.at("workers").size(); }

  /// Peak memory of the scheduler so far, MB.
  double mostMemory() const {
    std::ifstream status("/proc/" + std::to_string(scheduler_->pid()) + "/status");
    std::string word;
    double kilobytes = 0;
    while (status >> word)
      if (word == "VmHWM:") status >> kilobytes;
    return kilobytes / 1024;
  }

 private:
  void work(const std::stop_token& stop) {
    zmq::context_t context;
    std::vector<TableWorker> workers;
    std::vector<zmq::pollitem_t> sockets;
    for (int n = 0; n < 4; ++n)
      workers.emplace_back(context, endpoint_, keys(), n, std::chrono::milliseconds(10));
    for (TableWorker& worker : workers)
      sockets.push_back({worker.socket().handle(), 0, ZMQ_POLLIN, 0});
    while (!stop.stop_requested()) {
      zmq::poll(sockets, std::chrono::milliseconds(2));
      std::size_t sum = 0;
      for (TableWorker& worker : workers) {
        worker.turn();
        sum += worker.acknowledged();
      }
      acknowledged_ = sum;
    }
  }

  TemporaryDirectory directory_;
  zmq::context_t context_;
  std::string endpoint_;
  nlohmann::json status_;
  std::optional<Process> scheduler_;
  std::atomic<std::size_t> acknowledged_ = 0;
  std::jthread honest_;
};

}  // namespace palpate::test
