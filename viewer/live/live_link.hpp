#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "common/wire/curve.hpp"
#include "common/wire/wire.hpp"
#include "viewer/haptics/live_touch.hpp"

namespace palpate {

struct LiveLinkOptions {
  std::string problem;   ///< problem to solve, as encodeProblem() returns it
  std::string endpoint;  ///< endpoint of a live solver; empty: start one on this machine
  std::optional<KeyFolder> keys = {};  ///< nullopt if the live solver needs no key
  std::string worker = {};  ///< path of palpate-worker; empty: in the folder of this program
};

/// Asks a live solver (`palpate follow`) for the equilibria near the hand, in a thread of its own.
/// If the live solver ends, hangs or cannot be reached, it is restarted or reconnected, and
/// trouble() reports the problem. Meanwhile the haptic loop continues with the last equilibria.
class LiveLink {
 public:
  /// `touch` must outlive this object. Error (bad input) for an invalid endpoint.
  LiveLink(LiveTouch& touch, LiveLinkOptions options);
  ~LiveLink();  ///< ends the live solver if this object started it

  /// Waits at most this long until the live solver is ready or a problem is known. Returns whether
  /// it is ready.
  bool waitUntilReady(std::chrono::seconds longest);
  /// Describes the current problem as a sentence; empty if there is none. Any thread.
  std::string trouble() const;
  LiveStatistics statistics() const;  ///< any thread

 private:
  using Clock = std::chrono::steady_clock;
  struct Follower;  ///< a live solver that this object started

  // On the link's thread.
  void run(const std::stop_token& stop);
  void attend(const std::stop_token& stop);
  std::string connect();
  bool greet(const std::stop_token& stop);
  bool askAbout(const LiveHand& hand, const std::stop_token& stop);
  std::optional<wire::Message> ask(const wire::Message& question, std::string_view payload,
                                   std::chrono::milliseconds patience, const std::stop_token& stop);
  void sayGoodbye();
  bool ended() const;  ///< whether the live solver that this object started has ended
  std::string whyNoAnswer() const;
  void tell(std::string trouble);

  LiveTouch& touch_;
  const LiveLinkOptions options_;
  zmq::context_t context_;
  zmq::socket_t socket_;
  std::optional<HandshakeWatch> handshakes_;  ///< of a live solver elsewhere
  std::string key_trouble_;                   ///< why the last handshake failed
  std::unique_ptr<Follower> follower_;
  LiveHand before_;   ///< state of the hand in the last question
  int unsolved_ = 0;  ///< number of answers in a row without an equilibrium

  mutable std::mutex mutex_;  ///< guards the members below
  std::condition_variable changed_;
  std::string trouble_;
  bool ready_ = false;
  LiveStatistics statistics_;

  std::jthread thread_;  ///< last member: ends before the members that it uses are destroyed
};

}  // namespace palpate
