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
  std::string problem;                 ///< encodeProblem()
  std::string endpoint;                ///< of a follower; empty: start one on this machine
  std::optional<KeyFolder> keys = {};  ///< nothing if the follower needs no key
};

/// How a follower has kept up with the hand.
struct LiveStatistics {
  std::uint64_t answers = 0;   ///< equilibria
  std::uint64_t failures = 0;  ///< hands without an equilibrium
  std::uint64_t restarts = 0;  ///< times that the follower was started or connected again
  double seconds = 0;          ///< s from the question to the answer, sum over answers and failures
  double largest_seconds = 0;  ///< s
};

/// Asks a follower for the equilibria around the hand, on a thread of its own. If the follower
/// ends, hangs or cannot be reached, it is started or asked again, and trouble() says so; meanwhile
/// the loop goes on with the equilibria that it has.
class LiveLink {
 public:
  /// `touch` must outlive this object. Error (bad input) for an invalid endpoint.
  LiveLink(LiveTouch& touch, LiveLinkOptions options);
  ~LiveLink();  ///< ends a follower that was started

  /// Waits until the follower is ready or a difficulty is known, at most this long. Returns whether
  /// it is ready.
  bool waitUntilReady(std::chrono::seconds longest);
  /// Returns a sentence about the present difficulty; empty if there is none. Any thread.
  std::string trouble() const;
  LiveStatistics statistics() const;  ///< any thread

 private:
  using Clock = std::chrono::steady_clock;
  struct Follower;  ///< a process that was started here

  // On the thread of the link.
  void run(const std::stop_token& stop);
  void attend(const std::stop_token& stop);
  std::string connect();
  bool greet(const std::stop_token& stop);
  void askAbout(const LiveHand& hand, const std::stop_token& stop);
  std::optional<wire::Message> ask(const wire::Message& question, std::string_view payload,
                                   std::chrono::milliseconds patience, const std::stop_token& stop);
  void tell(std::string trouble);

  LiveTouch& touch_;
  const LiveLinkOptions options_;
  zmq::context_t context_;
  zmq::socket_t socket_;
  std::unique_ptr<Follower> follower_;
  LiveHand before_;  ///< the hand of the last question

  mutable std::mutex mutex_;  ///< guards the members below
  std::condition_variable changed_;
  std::string trouble_;
  bool ready_ = false;
  LiveStatistics statistics_;

  std::jthread thread_;  ///< last member: ends before the members that it uses are destroyed
};

}  // namespace palpate
