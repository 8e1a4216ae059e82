#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>
#include <zmq.hpp>

namespace palpate {

/// What the peers of a ROUTER may cost its process.
struct PeerLimits {
  /// What came in of one connection and was not received yet. libzmq counts messages, and none
  /// before its last frame: of one that never ends it would keep everything.
  std::size_t unread;
  /// Of all connections together; and once more of those that ended, since whole messages outlive
  /// theirs: as long as so much may be left of them, nobody new is let in.
  std::size_t unread_in_all;
  /// What one was sent and has not read: with more it is behind.
  std::size_t behind = 65536;
  /// Connections at a time; nothing: as many as the process has descriptors for, less some of its
  /// own.
  std::optional<std::size_t> connections = std::nullopt;
  /// Messages of one connection in a second, for two seconds.
  double messages_per_second = 20000;
  /// Of a connection from which nothing comes for so long nobody takes notice any more.
  std::chrono::seconds silence{120};
  /// One that was sent something, and reads nothing of it for so long.
  std::chrono::seconds reading{30};
  /// An address but this machine's own that was closed so often within `shut_out` is not let in for
  /// as long again.
  int floods = 3;
  std::chrono::seconds shut_out{60};

  /// Where honest peers send messages of at most `message_bytes`, and the ROUTER takes
  /// `queue_length` of one connection before it lets the others wait (RCVHWM).
  static PeerLimits forMessagesOf(std::size_t message_bytes, std::size_t queue_length);
};

/// Watches the TCP connections of a ROUTER from outside, and closes those that cost more than
/// PeerLimits: libzmq has no limit in bytes. What came in is counted by the system (TCP_INFO), what
/// was received by who receives it; the difference lies in this process's memory. Descriptors are
/// kept below the limit of the process: beyond it, connections that have been silent longest are
/// closed.
///
/// Peers of ipc:// are of this machine, and not watched.
///
/// A thread of its own, so that a disk that takes its time lets nobody in; the other functions may
/// be called by one other thread. Construct before the socket is bound, destroy before it is.
class Connections {
 public:
  Connections(zmq::context_t& context, zmq::socket_t& router, const PeerLimits& limits);
  Connections(const Connections&) = delete;
  Connections& operator=(const Connections&) = delete;
  ~Connections();

  /// A message of so many bytes (bytesOnWire) came from `peer` over this connection (its
  /// descriptor, Incoming::connection). False when that was closed because it floods: nobody cares
  /// what it says.
  bool received(int connection, const std::string& peer, std::size_t bytes);
  /// The ROUTER had nothing more to give: what connections left that ended is received too.
  void receivedAll();
  /// A message was given to libzmq for `peer`.
  void sent(const std::string& peer, std::size_t bytes);
  /// Whether much of what it was sent is still on its way: it gets nothing large until then.
  bool isBehind(const std::string& peer);
  /// How many were closed since the last call, and why, for people; not of all where it was many.
  struct Closed {
    std::int64_t count = 0;
    std::vector<std::string> why;
  };
  Closed takeClosed();

  /// A peer's bytes as the system counts them.
  struct Traffic {
    std::uint64_t received = 0;      ///< by this process
    std::uint64_t arrived = 0;       ///< by its system
    std::uint64_t acknowledged = 0;  ///< by the peer's system
  };

 private:
  using Clock = std::chrono::steady_clock;
  struct Connection {
    std::string address;
    std::uint64_t cookie = 0;               ///< of the socket: descriptors are used again
    std::string peer;                       ///< empty before its first message
    std::uint64_t taken = 0;                ///< bytes that were received from libzmq
    std::uint64_t given = 0;                ///< bytes that were given to libzmq
    std::uint64_t acknowledged_before = 0;  ///< the first was given
    double messages = 0;                    ///< beyond messages_per_second
    Traffic latest;
    /// In the time of this process: a suspended one blames nobody.
    std::chrono::duration<double> silent{0}, unmoved{0};
    std::int64_t unread = 0;
    bool closing = false, flooded = false;
  };
  struct Floods {
    int count = 0;
    Clock::time_point latest;
  };

  void watch(const std::stop_token& stop);
  void takeEvents();
  bool isSame(int descriptor) const;
  void accepted(int descriptor);
  void look(std::chrono::duration<double> since_last);
  void judge(int descriptor, Connection& connection);
  void keepBelowInAll();
  void keepDescriptors();
  void close(int descriptor, Connection& connection, const std::string& why);
  void flooded(int descriptor, Connection& connection, const std::string& why);
  void shut(int descriptor, Connection& connection);
  void note(std::string line);
  void forget(int descriptor);
  Connection* ofPeer(const std::string& peer);
  static std::uint64_t owed(const Connection& connection);
  bool isShutOut(const std::string& address) const;
  bool isFullOfEnded() const { return left_by_ended_ > limits_.unread_in_all; }

  PeerLimits limits_;
  zmq::socket_t* router_;
  std::size_t most_connections_;
  zmq::socket_t events_;
  std::mutex mutex_;  ///< everything below
  std::map<int, Connection> connections_;
  std::map<std::string, int> of_peer_;
  std::set<int> flooded_before_;  ///< descriptors whose last connection flooded, and has ended
  std::map<std::string, Floods> floods_;  ///< by address
  std::size_t left_by_ended_ = 0;         ///< bytes, at most
  bool told_of_ended_ = false;            ///< once until it is received
  std::vector<std::string> closed_;
  std::int64_t closed_count_ = 0;
  std::jthread thread_;
};

}  // namespace palpate
