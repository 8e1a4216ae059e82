#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <string>

namespace palpate {

/// Counts the bytes of sent payloads that peers have not read. A payload is counted until the
/// messaging library releases it, which may happen in any thread. Shared payloads (the problem)
/// take no extra memory and are not counted.
class UnreadPayloads {
 public:
  /// Returns the payload for sending. It is counted until its last owner releases it.
  std::shared_ptr<const std::string> add(std::string payload) const {
    auto* const owned = new std::string(std::move(payload));
    *bytes_ += owned->size();
    return {owned, [bytes = bytes_](const std::string* sent) {
              *bytes -= sent->size();
              delete sent;
            }};
  }
  std::size_t bytes() const { return *bytes_; }

 private:
  /// Shared with the payloads, because they may outlive this object.
  std::shared_ptr<std::atomic<std::size_t>> bytes_ = std::make_shared<std::atomic<std::size_t>>(0);
};

}  // namespace palpate
