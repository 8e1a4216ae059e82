#pragma once

#include "scheduler/service/coordinator.hpp"

namespace palpate {

/// The ROUTER socket in front of a Coordinator. One thread; never blocks but in turn().
class Server {
 public:
  /// Binds `endpoint` (tcp://127.0.0.1:* lets the system choose a port). Error when it is in use.
  Server(zmq::context_t& context, const std::string& endpoint);

  /// Where it listens, with the port that was chosen.
  const std::string& endpoint() const { return endpoint_; }

  /// Waits at most `longest` for messages or the coordinator's next deadline, feeds what came in to
  /// it, lets it act, and sends what it says. Returns early on a signal.
  void turn(Coordinator& coordinator, std::chrono::milliseconds longest);

 private:
  zmq::socket_t socket_;
  std::string endpoint_;
};

}  // namespace palpate
