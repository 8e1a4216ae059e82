#pragma once

#include "common/wire/bundle.hpp"
#include "common/wire/connections.hpp"
#include "common/wire/curve.hpp"
#include "scheduler/service/transport.hpp"

namespace palpate {

/// The ROUTER socket in front of a Coordinator. One thread; only turn() blocks.
class Server : private Transport {
 public:
  /// Binds `endpoint` (tcp://127.0.0.1:* lets the system choose a port). Accepts the peers that
  /// `keys` allows, or everybody without keys. Disconnects peers that send more than a result of
  /// this problem can take. Throws if the endpoint is in use.
  Server(zmq::context_t& context, const Problem& problem, const std::string& endpoint,
         const std::optional<KeyFolder>& keys = std::nullopt);

  /// Endpoint with the port that was chosen.
  const std::string& endpoint() const { return endpoint_; }

  /// Waits at most `longest` for messages or the coordinator's next deadline, then exchanges
  /// messages with it. Returns how to continue; returns early on a signal.
  Next turn(Coordinator& coordinator, std::chrono::milliseconds longest);

 private:
  std::optional<Incoming> receive() override;
  Sent send(const Outgoing& message) override;
  Connections::Closed takeClosed() override { return connections_.takeClosed(); }
  /// Returns why the sender may not send this message; empty if it may.
  std::string refusalOf(const Incoming& incoming);
  /// Returns a token for a large answer. It counts against the peer while anybody holds it.
  std::shared_ptr<const void> countedFor(const std::string& peer);

  /// None: everybody may send every message. Declared before the socket, so that it is destroyed
  /// after it.
  std::optional<ZapHandler> zap_handler_;
  zmq::socket_t socket_;
  Inbox inbox_;
  Connections connections_;
  /// By peer: a token, held once for each large answer that libzmq still has.
  std::map<std::string, std::weak_ptr<const void>> unread_;
  std::string endpoint_;
};

}  // namespace palpate
