#include "scheduler/service/server.hpp"

#include <algorithm>

#include "common/base/assertion.hpp"

namespace palpate {
namespace {

/// Returns the role needed to send this message; none for messages that only servers send.
std::optional<Roles> roleFor(const wire::Message& message) {
  using wire::Message;
  switch (message.body_case()) {
    case Message::kHello:
    case Message::kProblemRequest:
    case Message::kRequest:
    case Message::kFieldsRequest:
    case Message::kResult:
    case Message::kHeartbeat:
    case Message::kGoodbye: return Roles::worker;
    case Message::kStatusRequest: return Roles::observer;
    case Message::kStopRequest:
    case Message::kPauseRequest:
    case Message::kPriorityRequest:
    case Message::kRetryRequest: return Roles::system_operator;
    default: return std::nullopt;
  }
}

/// Limit on the size of a message without its payload; generous.
constexpr std::size_t header_bytes = 8192;
/// Margin above the longest message of an honest peer.
constexpr std::size_t beyond_messages = 1 << 20;
/// A peer with at least this many unread large answers counts as slow. Workers ask for the starts
/// of two jobs at once.
constexpr long most_unread = 2;
constexpr std::size_t many_peers = 20000;

}  // namespace

Server::Server(zmq::context_t& context, const Problem& problem, const std::string& endpoint,
               const std::optional<KeyFolder>& keys)
    : socket_(makeRouter(context)),
      connections_(context, socket_,
                   {.message_bytes = std::max(fieldsBytes(problem), bundle_bytes) + header_bytes +
                                     beyond_messages}) {
  if (keys) zap_handler_.emplace(context, socket_, *keys);
  endpoint_ = bindRouter(socket_, endpoint);
}

Next Server::turn(Coordinator& coordinator, std::chrono::milliseconds longest) {
  using Clock = std::chrono::steady_clock;
  const auto until_deadline =
      std::chrono::ceil<std::chrono::milliseconds>(coordinator.nextDeadline() - Clock::now());
  PALPATE_ASSERT(longest.count() >= 0, "the time must not be negative: poll() would not end");
  waitForMessages(socket_, std::clamp(until_deadline, std::chrono::milliseconds(0), longest));
  return exchange(coordinator, *this, Clock::now());
}

std::optional<Incoming> Server::receive() {
  auto incoming = inbox_.next(socket_, true);
  if (!incoming) return incoming;
  incoming->refusal = refusalOf(*incoming);
  if (!connections_.received(incoming->connection, incoming->bytes)) incoming->message.Clear();
  const auto unread = unread_.find(incoming->peer);
  incoming->reads_slowly = unread != unread_.end() && unread->second.use_count() >= most_unread;
  return incoming;
}

std::string Server::refusalOf(const Incoming& incoming) {
  if (!zap_handler_) return "";
  const auto wanted = roleFor(incoming.message);
  const Roles roles = zap_handler_->rolesOf(incoming.key);
  if (roles == Roles::none) return "this key is no longer allowed";
  if (!wanted || include(roles, *wanted)) return "";
  return fmt::format(
      "this key has the role {}, but the request needs {}: run palpate key allow at the server",
      wordsOf(roles), wordsOf(*wanted));
}

Sent Server::send(const Outgoing& message) {
  const bool large = message.payload || message.message.ByteSizeLong() > header_bytes;
  return sendMessage(socket_, message.peer, message.message, message.payload,
                     large ? countedFor(message.peer) : nullptr);
}

std::shared_ptr<const void> Server::countedFor(const std::string& peer) {
  if (unread_.size() >= many_peers)
    std::erase_if(unread_, [](const auto& entry) { return entry.second.expired(); });
  std::weak_ptr<const void>& counter = unread_[peer];
  std::shared_ptr<const void> counted = counter.lock();
  if (!counted) counter = counted = std::make_shared<char>();
  return std::make_shared<std::shared_ptr<const void>>(std::move(counted));
}

}  // namespace palpate
