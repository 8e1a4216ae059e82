#pragma once

#include "common/wire/connections.hpp"
#include "scheduler/service/coordinator.hpp"

namespace palpate {

/// Messages of peers, whatever carries them. Neither call waits.
class Transport {
 public:
  Transport() = default;
  Transport(const Transport&) = delete;
  Transport& operator=(const Transport&) = delete;
  virtual ~Transport() = default;

  /// The next one that came in; nothing when there is none.
  virtual std::optional<Incoming> receive() = 0;
  virtual Sent send(const Outgoing& message) = 0;
  /// Connections that cost too much, and were closed since the last call.
  virtual Connections::Closed takeClosed() { return {}; }
};

/// One turn of a scheduler: feeds what came in to the coordinator (of a flood a part, so that
/// deadlines and answers do not wait for it), lets it act, and sends what it says. Returns what
/// follows; Next::anew as soon as that is known, and nothing is sent then.
Next exchange(Coordinator& coordinator, Transport& transport, Coordinator::Time now);

}  // namespace palpate
