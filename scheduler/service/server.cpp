#include "scheduler/service/server.hpp"

#include <algorithm>
#include <array>

#include "common/base/error.hpp"
#include "common/wire/wire.hpp"

namespace palpate {
namespace {

/// So that a flood of messages cannot keep deadlines and answers waiting.
constexpr int messages_per_turn = 256;

using Clock = std::chrono::steady_clock;

void waitForMessages(zmq::socket_t& socket, std::chrono::milliseconds longest) {
  std::array<zmq::pollitem_t, 1> items = {{{socket.handle(), 0, ZMQ_POLLIN, 0}}};
  try {
    zmq::poll(items, longest);
  } catch (const zmq::error_t& error) {
    if (error.num() != EINTR) throw failure("ZeroMQ poll: {}", error.what());
  }
}

}  // namespace

Server::Server(zmq::context_t& context, const std::string& endpoint)
    : socket_(makeRouter(context)), endpoint_(bindRouter(socket_, endpoint)) {}

void Server::turn(Coordinator& coordinator, std::chrono::milliseconds longest) {
  const auto until_deadline =
      std::chrono::ceil<std::chrono::milliseconds>(coordinator.nextDeadline() - Clock::now());
  waitForMessages(socket_, std::clamp(until_deadline, std::chrono::milliseconds(0), longest));
  for (int n = 0; n < messages_per_turn; ++n) {
    const auto incoming = receiveMessage(socket_, true);
    if (!incoming) break;
    coordinator.receive(*incoming, Clock::now());
  }
  // After all messages that are there, so that their results share a group.
  coordinator.advance(Clock::now());
  sendAll(coordinator);
}

void Server::sendAll(Coordinator& coordinator) {
  // A peer that is gone, or does not read, gives its leases back, which may make new messages.
  for (auto outbox = coordinator.takeOutbox(); !outbox.empty(); outbox = coordinator.takeOutbox())
    for (const Outgoing& outgoing : outbox) {
      const std::string_view payload =
          outgoing.payload ? std::string_view(*outgoing.payload) : std::string_view();
      if (sendMessage(socket_, outgoing.peer, outgoing.message, payload) != Sent::yes)
        coordinator.peerUnreachable(outgoing.peer, Clock::now());
    }
}

}  // namespace palpate
