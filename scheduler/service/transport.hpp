#pragma once

#include "common/wire/connections.hpp"
#include "scheduler/service/coordinator.hpp"

namespace palpate {

/// Exchanges messages with peers, over a socket or in a test. Neither call blocks.
class Transport {
 public:
  Transport() = default;
  Transport(const Transport&) = delete;
  Transport& operator=(const Transport&) = delete;
  virtual ~Transport() = default;

  /// Returns the next message that came in; none if there is none.
  virtual std::optional<Incoming> receive() = 0;
  virtual Sent send(const Outgoing& message) = 0;
  /// Returns the connections that cost too much and were closed since the last call.
  virtual Connections::Closed takeClosed() { return {}; }
};

/// Runs one turn of a scheduler: passes the received messages to the coordinator, lets it act, and
/// sends its messages. In a flood only some messages are read, so that deadlines and answers do not
/// wait. Returns how to continue. Returns Next::anew as soon as that is known, without sending
/// anything.
Next exchange(Coordinator& coordinator, Transport& transport, Coordinator::Time now);

}  // namespace palpate
