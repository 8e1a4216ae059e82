#pragma once

#include "common/wire/bundle.hpp"
#include "common/wire/connections.hpp"
#include "common/wire/curve.hpp"
#include "scheduler/service/transport.hpp"

namespace palpate {

/// The ROUTER socket in front of a Coordinator. One thread; only turn() blocks.
class Server : private Transport {
 public:
  /// Binds `endpoint` (tcp://127.0.0.1:* lets the system choose a port). With `keys`, accepts only
  /// the peers that the keys allow; without, accepts everybody. Disconnects a peer that sends a
  /// message longer than any result of this problem. Throws if the endpoint is in use.
  Server(zmq::context_t& context, const Problem& problem, const std::string& endpoint,
         const std::optional<KeyFolder>& keys = std::nullopt);

  /// Endpoint with the port that was chosen.
  const std::string& endpoint() const { return endpoint_; }

  /// Waits for messages, but at most `longest` or until the coordinator's next deadline, and then
  /// runs a turn (exchange()). Returns how to continue. A signal ends the wait.
  Next turn(Coordinator& coordinator, std::chrono::milliseconds longest);

 private:
  std::optional<Incoming> receive() override;
  Sent send(const Outgoing& message) override;
  Connections::Closed takeClosed() override { return connections_.takeClosed(); }
  /// Returns why the sender may not send this message; empty if it may.
  std::string refusalOf(const Incoming& incoming);
  /// Returns a token for one large answer to a peer. The answer counts as unread until the token is
  /// destroyed.
  std::shared_ptr<const void> countedFor(const std::string& peer);

  /// Without a handler, everybody may send every message. Declared before the socket, so that the
  /// handler is destroyed after the socket.
  std::optional<ZapHandler> zap_handler_;
  zmq::socket_t socket_;
  Inbox inbox_;
  Connections connections_;
  /// One token per peer, shared by the peer's large answers that libzmq still holds.
  std::map<std::string, std::weak_ptr<const void>> unread_;
  std::string endpoint_;
};

}  // namespace palpate
