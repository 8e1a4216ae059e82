#pragma once

#include "scheduler/service/transport.hpp"

namespace palpate {

/// The ROUTER socket in front of a Coordinator. One thread; never blocks but in turn().
class Server : private Transport {
 public:
  /// Binds `endpoint` (tcp://127.0.0.1:* lets the system choose a port). Error when it is in use.
  Server(zmq::context_t& context, const std::string& endpoint);

  /// Where it listens, with the port that was chosen.
  const std::string& endpoint() const { return endpoint_; }

  /// Waits at most `longest` for messages or the coordinator's next deadline, then exchanges
  /// messages with it. Returns early on a signal.
  void turn(Coordinator& coordinator, std::chrono::milliseconds longest);

 private:
  std::optional<Incoming> receive() override;
  Sent send(const Outgoing& message) override;

  zmq::socket_t socket_;
  std::string endpoint_;
};

}  // namespace palpate
