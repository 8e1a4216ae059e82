#pragma once

#include "common/wire/connections.hpp"
#include "scheduler/service/coordinator.hpp"

namespace palpate {

/// Exchanges messages with peers, over a socket or in a test. No function blocks.
class Transport {
 public:
  virtual ~Transport() = default;

  /// Returns the next received message; none if there is none.
  virtual std::optional<Incoming> receive() = 0;
  virtual Sent send(const Outgoing& message) = 0;
  /// Returns the connections that were closed since the last call because they exceeded a limit of
  /// Connections.
  virtual Connections::Closed takeClosed() { return {}; }
};

/// Runs one turn of a scheduler: passes the received messages to the coordinator, lets it act, and
/// sends its messages. Reads only a limited number of messages, so that a flood does not delay
/// deadlines and answers. Returns how the scheduler continues. If a new Build is needed
/// (Next::anew), returns at once and sends nothing.
Next exchange(Coordinator& coordinator, Transport& transport, Coordinator::Time now);

}  // namespace palpate
