#include "scheduler/service/server.hpp"

#include <algorithm>

#include "common/base/assertion.hpp"

namespace palpate {

Server::Server(zmq::context_t& context, const std::string& endpoint)
    : socket_(makeRouter(context)), endpoint_(bindRouter(socket_, endpoint)) {}

void Server::turn(Coordinator& coordinator, std::chrono::milliseconds longest) {
  using Clock = std::chrono::steady_clock;
  const auto until_deadline =
      std::chrono::ceil<std::chrono::milliseconds>(coordinator.nextDeadline() - Clock::now());
  PALPATE_ASSERT(longest.count() >= 0, "poll() takes less than 0 for ever");
  waitForMessages(socket_, std::clamp(until_deadline, std::chrono::milliseconds(0), longest));
  exchange(coordinator, *this, Clock::now());
}

std::optional<Incoming> Server::receive() { return receiveMessage(socket_, true); }

Sent Server::send(const Outgoing& message) {
  const std::string_view payload = message.payload ? *message.payload : std::string_view();
  return sendMessage(socket_, message.peer, message.message, payload);
}

}  // namespace palpate
