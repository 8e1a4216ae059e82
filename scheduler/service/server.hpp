#pragma once

#include "common/wire/bundle.hpp"
#include "common/wire/connections.hpp"
#include "common/wire/curve.hpp"
#include "scheduler/service/transport.hpp"

namespace palpate {

/// The ROUTER socket in front of a Coordinator. One thread; never blocks but in turn().
class Server : private Transport {
 public:
  /// Binds `endpoint` (tcp://127.0.0.1:* lets the system choose a port) for those whom `keys` lets
  /// in, or without any for everybody. Who sends more than results of this problem can be is let
  /// go. Error when it is in use.
  Server(zmq::context_t& context, const Problem& problem, const std::string& endpoint,
         const std::optional<KeyFolder>& keys = std::nullopt);

  /// Where it listens, with the port that was chosen.
  const std::string& endpoint() const { return endpoint_; }

  /// Waits at most `longest` for messages or the coordinator's next deadline, then exchanges
  /// messages with it. Returns early on a signal, and what follows.
  Next turn(Coordinator& coordinator, std::chrono::milliseconds longest);

 private:
  std::optional<Incoming> receive() override;
  Sent send(const Outgoing& message) override;
  Connections::Closed takeClosed() override { return connections_.takeClosed(); }
  /// Why the sender may not say this; empty when it may.
  std::string refusalOf(const Incoming& incoming);
  /// For a large answer: counted among those of the peer as long as anybody holds it.
  std::shared_ptr<const void> countedFor(const std::string& peer);

  /// Nothing: everybody may say everything. Before the socket: it goes after it.
  std::optional<ZapHandler> zap_handler_;
  zmq::socket_t socket_;
  Inbox inbox_;
  Connections connections_;
  /// Of each peer, held once for each large answer that libzmq still has.
  std::map<std::string, std::weak_ptr<const void>> unread_;
  std::string endpoint_;
};

}  // namespace palpate
