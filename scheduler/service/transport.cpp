#include "scheduler/service/transport.hpp"

namespace palpate {
namespace {

constexpr int messages_per_turn = 256;

}  // namespace

void exchange(Coordinator& coordinator, Transport& transport, Coordinator::Time now) {
  bool all_read = false;
  for (int n = 0; n < messages_per_turn && !all_read; ++n) {
    if (const auto incoming = transport.receive())
      incoming->refusal.empty() ? coordinator.receive(*incoming, now)
                                : coordinator.refuse(*incoming, now);
    else
      all_read = true;
  }
  coordinator.noteClosed(transport.takeClosed(), now);
  // After all messages that are there, so that their results share a group.
  coordinator.advance(now, all_read);
  // A peer that is gone, or does not read, gives its leases back, which may make new messages.
  for (auto outbox = coordinator.takeOutbox(); !outbox.empty(); outbox = coordinator.takeOutbox())
    for (const Outgoing& outgoing : outbox)
      if (transport.send(outgoing) != Sent::yes) coordinator.peerUnreachable(outgoing.peer, now);
}

}  // namespace palpate
