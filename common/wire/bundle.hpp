#pragma once

#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/wire/wire.hpp"

namespace palpate {

/// Largest size of a bundle, in bytes of messages and payloads together, and largest number of
/// messages in it. A message that is sent alone may be larger.
inline constexpr std::size_t bundle_bytes = 32 * 1024;
inline constexpr int bundle_messages = 1024;

/// A message with its payload.
struct Letter {
  wire::Message message;
  std::string payload;
};

/// Collects the messages to one peer into bundles, because the cost of small messages depends on
/// their number more than on their size (docs/evaluation.md). One thread.
class Bundler {
 public:
  /// Adds a message. `payload` must have the length that the message gives.
  void add(wire::Message message, std::string_view payload = {});
  /// Returns the messages added since the last call, in bundles. A message that would be alone in
  /// its bundle is returned without a bundle.
  std::vector<Letter> take();

 private:
  void close();

  std::vector<Letter> closed_;
  Letter open_;  ///< the bundle under construction
  std::size_t bytes_ = 0;
};

/// Returns the messages of a bundle, or the message itself if it is not a bundle. Unreadable
/// messages have no body, as in receiveMessage(). If a bundle has too many messages, or if its
/// payload does not have the length that the messages give, the result is one message without a
/// body. Incoming::bytes of the first message is the size of the whole bundle, and 0 for the
/// others.
std::vector<Incoming> unbundled(Incoming incoming);

/// Receives messages from one socket one by one, even if several arrive in a bundle. One thread.
class Inbox {
 public:
  /// Like receiveMessage(), but never returns a bundle.
  std::optional<Incoming> next(zmq::socket_t& socket, bool router) {
    return next([&] { return receiveMessage(socket, router); });
  }
  /// Takes incoming messages and bundles from `receive` instead of a socket.
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
