#include "scheduler/service/transport.hpp"

#include <unordered_map>

#include "common/wire/bundle.hpp"

namespace palpate {
namespace {

constexpr int messages_per_turn = 256;

/// Joins the messages to each peer into bundles, in their order.
std::vector<Outgoing> bundled(std::vector<Outgoing> outbox) {
  std::vector<Outgoing> leaving;
  std::unordered_map<std::string, Bundler> bundlers;
  const auto close = [&](const std::string& peer, Bundler& bundler) {
    for (Letter& letter : bundler.take())
      leaving.push_back({peer, std::move(letter.message), nullptr});
  };
  for (Outgoing& outgoing : outbox) {
    Bundler& bundler = bundlers[outgoing.peer];
    if (outgoing.payload == nullptr) {
      bundler.add(std::move(outgoing.message));
      continue;
    }
    // Do not bundle payloads: many messages may share one, and it must not be copied.
    close(outgoing.peer, bundler);
    leaving.push_back(std::move(outgoing));
  }
  for (auto& [peer, bundler] : bundlers) close(peer, bundler);
  return leaving;
}

}  // namespace

Next exchange(Coordinator& coordinator, Transport& transport, Coordinator::Time now) {
  bool all_read = false;
  for (int n = 0; n < messages_per_turn && !all_read; ++n) {
    if (auto incoming = transport.receive())
      incoming->refusal.empty() ? coordinator.receive(std::move(*incoming), now)
                                : coordinator.refuse(*incoming, now);
    else
      all_read = true;
    if (coordinator.next() == Next::anew) return Next::anew;
  }
  coordinator.noteClosed(transport.takeClosed(), now);
  // Advance only after these messages are handled, so that one commit covers their results.
  if (coordinator.advance(now, all_read) == Next::anew) return Next::anew;
  // A peer that is gone or does not read loses its leases, which may cause new messages.
  for (auto outbox = coordinator.takeOutbox(); !outbox.empty(); outbox = coordinator.takeOutbox())
    for (const Outgoing& outgoing : bundled(std::move(outbox)))
      if (transport.send(outgoing) != Sent::yes) coordinator.peerUnreachable(outgoing.peer, now);
  return coordinator.next();
}

}  // namespace palpate
