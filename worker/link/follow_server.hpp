#pragma once

#include <chrono>
#include <optional>

#include "common/wire/bundle.hpp"
#include "common/wire/curve.hpp"
#include "worker/solver/follower.hpp"

namespace palpate {

/// Offers the live solver to one haptic client at a time (docs/internals/wire.md). The client sends
/// its problem, then positions of the hand. Each position is answered by the equilibrium near it
/// before the next one is read. Another client is refused until the first one has said Goodbye or
/// been silent for two seconds. One thread.
class FollowServer {
 public:
  /// Listens at `endpoint`. `keys` is empty if clients need no key. Errors as from bindRouter().
  FollowServer(const std::string& endpoint, const ElementKernels& kernels,
               const std::optional<KeyFolder>& keys);

  const std::string& endpoint() const { return endpoint_; }  ///< with the actual port
  /// Receives messages for at most `longest` and answers them.
  void turn(std::chrono::milliseconds longest);

 private:
  using Clock = std::chrono::steady_clock;
  void handle(const Incoming& incoming);
  void begin(const Incoming& incoming);
  void follow(const Incoming& incoming);
  void send(const std::string& peer, const wire::Message& message);
  void refuse(const std::string& peer, const std::string& why);

  const ElementKernels& kernels_;
  zmq::context_t context_;
  zmq::socket_t socket_;
  std::optional<ZapHandler> zap_handler_;
  std::string endpoint_;
  Inbox inbox_;
  std::string client_;  ///< routing id; empty if there is no client
  Clock::time_point last_heard_;
  std::optional<Problem> problem_;
  std::optional<Follower> follower_;  ///< of problem_
};

}  // namespace palpate
