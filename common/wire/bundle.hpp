#pragma once

#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/wire/wire.hpp"

namespace palpate {

/// A bundle takes no more than this, messages and payloads together, and no more messages; one
/// message by itself may be longer.
inline constexpr std::size_t bundle_bytes = 32 * 1024;
inline constexpr int bundle_messages = 1024;

/// A message with its payload.
struct Letter {
  wire::Message message;
  std::string payload;
};

/// Gathers what one peer is told, so that it leaves in few messages: a small one costs more by
/// being one than by its bytes (docs/performance.md). One thread.
class Bundler {
 public:
  /// Behind what was added before. `payload` is as long as the message says.
  void add(wire::Message message, std::string_view payload = {});
  /// What was added since the last call: bundles, and what is by itself as it is.
  std::vector<Letter> take();

 private:
  void close();

  std::vector<Letter> closed_;
  Letter open_;  ///< a bundle, which has room
  std::size_t bytes_ = 0;
};

/// The messages of a bundle, or the one that is none. Those that cannot be read have no body, as
/// receiveMessage() has it; of a bundle that has too many, or whose payload is not theirs, one
/// without a body is all there is. The bytes that it took count as the first one's.
std::vector<Incoming> unbundled(Incoming incoming);

/// What comes in over one socket, message by message, however many came as one. One thread.
class Inbox {
 public:
  /// As receiveMessage(), but never a bundle.
  std::optional<Incoming> next(zmq::socket_t& socket, bool router) {
    return next([&] { return receiveMessage(socket, router); });
  }
  /// The same of what `receive` gives.
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
