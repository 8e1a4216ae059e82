#pragma once

#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/wire/wire.hpp"

namespace palpate {

/// Largest size of a bundle, messages and payloads together, and largest number of its messages. A
/// message outside a bundle may be longer.
inline constexpr std::size_t bundle_bytes = 32 * 1024;
inline constexpr int bundle_messages = 1024;

/// A message with its payload.
struct Letter {
  wire::Message message;
  std::string payload;
};

/// Collects the messages to one peer into bundles. Small messages cost more per message than per
/// byte (docs/performance.md). One thread.
class Bundler {
 public:
  /// Appends a message. `payload` must be as long as the message says.
  void add(wire::Message message, std::string_view payload = {});
  /// Returns everything added since the last call: bundles, and single messages as they are.
  std::vector<Letter> take();

 private:
  void close();

  std::vector<Letter> closed_;
  Letter open_;  ///< the bundle under construction
  std::size_t bytes_ = 0;
};

/// Returns the messages of a bundle. A message that is no bundle is returned unchanged. Unreadable
/// messages have no body, as from receiveMessage(). A bundle with too many messages, or with a
/// payload that does not fit them, gives one message without a body. The bytes of the bundle count
/// for its first message.
std::vector<Incoming> unbundled(Incoming incoming);

/// Receives messages from one socket one by one, even if several arrive in a bundle. One thread.
class Inbox {
 public:
  /// Like receiveMessage(), but never returns a bundle.
  std::optional<Incoming> next(zmq::socket_t& socket, bool router) {
    return next([&] { return receiveMessage(socket, router); });
  }
  /// Takes incoming messages from `receive` instead of a socket.
  template <class Receive>
  std::optional<Incoming> next(const Receive& receive) {
    if (opened_.empty())
      if (auto incoming = receive())
        for (Incoming& part : unbundled(std::move(*incoming))) opened_.push_back(std::move(part));
    if (opened_.empty()) return std::nullopt;
    Incoming first = std::move(opened_.front());
    opened_.pop_front();
    return first;
  }
  void clear() { opened_.clear(); }

 private:
  std::deque<Incoming> opened_;
};

}  // namespace palpate
