#pragma once

#include <atomic>
#include <cstddef>
#include <memory>
#include <string>

namespace palpate {

/// How much of what was sent lies with peers that have not read it: payloads of their own, each
/// counted until the library lets go of it, in whatever thread. What many share (the problem) costs
/// nothing more and is not counted.
class UnreadPayloads {
 public:
  /// The payload, counted as long as anybody holds it.
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
  /// Payloads may outlive this object.
  std::shared_ptr<std::atomic<std::size_t>> bytes_ = std::make_shared<std::atomic<std::size_t>>(0);
};

}  // namespace palpate
