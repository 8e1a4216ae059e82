#include "scheduler/service/server.hpp"

#include <algorithm>

#include "common/base/assertion.hpp"

namespace palpate {
namespace {

/// So that a flood of messages cannot keep deadlines and answers waiting.
constexpr int messages_per_turn = 256;

using Clock = std::chrono::steady_clock;

}  // namespace

Server::Server(zmq::context_t& context, const std::string& endpoint)
    : socket_(makeRouter(context)), endpoint_(bindRouter(socket_, endpoint)) {}

void Server::turn(Coordinator& coordinator, std::chrono::milliseconds longest) {
  const auto until_deadline =
      std::chrono::ceil<std::chrono::milliseconds>(coordinator.nextDeadline() - Clock::now());
  PALPATE_ASSERT(longest.count() >= 0, "poll() takes less than 0 for ever");
  waitForMessages(socket_, std::clamp(until_deadline, std::chrono::milliseconds(0), longest));
  bool all_read = false;
  for (int n = 0; n < messages_per_turn && !all_read; ++n) {
    if (const auto incoming = receiveMessage(socket_, true))
      coordinator.receive(*incoming, Clock::now());
    else
      all_read = true;
  }
  // After all messages that are there, so that their results share a group.
  coordinator.advance(Clock::now(), all_read);
  // A peer that is gone, or does not read, gives its leases back, which may make new messages.
  for (auto outbox = coordinator.takeOutbox(); !outbox.empty(); outbox = coordinator.takeOutbox())
    for (const Outgoing& outgoing : outbox) {
      const std::string_view payload = outgoing.payload ? *outgoing.payload : std::string_view();
      if (sendMessage(socket_, outgoing.peer, outgoing.message, payload) != Sent::yes)
        coordinator.peerUnreachable(outgoing.peer, Clock::now());
    }
}

}  // namespace palpate
