#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>
#include <zmq.hpp>

namespace palpate {

/// What a connection to a ROUTER may cost its process.
struct PeerLimits {
  /// Of one message, payload and all. It is in memory when it is refused.
  std::size_t message_bytes;
  /// In a second, for two seconds.
  double messages_per_second = 20000;
  /// Connections at a time; nothing: as many as the process has descriptors for, less some of its
  /// own.
  std::optional<std::size_t> connections = std::nullopt;
  /// Over which nothing was received: of each libzmq may hold a frame of 128 kB.
  std::size_t silent = 4096;
};

/// Closes connections of a ROUTER that CURVE and the limits of libzmq leave open: those that sent
/// too long a message or too many, and the oldest of those over which nothing was received, which
/// are strangers nearly always, before the process runs out of descriptors or there are thousands.
///
/// A thread of its own looks after descriptors, so that a disk that takes its time lets nobody in;
/// the other functions may be called by one other thread. Construct before the socket is bound,
/// destroy before it is.
class Connections {
 public:
  Connections(zmq::context_t& context, zmq::socket_t& router, const PeerLimits& limits);
  Connections(const Connections&) = delete;
  Connections& operator=(const Connections&) = delete;
  ~Connections();

  /// A message of so many bytes came over this connection (its descriptor, Incoming::connection).
  /// False when that is closed: nobody cares what it says.
  bool received(int connection, std::size_t bytes);
  /// How many were closed since the last call, and why, for people; not of all where it was many.
  struct Closed {
    std::int64_t count = 0;
    std::vector<std::string> why;
  };
  Closed takeClosed();

 private:
  using Clock = std::chrono::steady_clock;
  struct Connection {
    std::uint64_t cookie = 0;  ///< of the socket: descriptors are used again
    Clock::time_point since, latest;
    double messages = 0;  ///< beyond messages_per_second
    bool spoke = false, closed = false;
  };

  void watch(const std::stop_token& stop);
  Connection& of(int descriptor);
  void keepDescriptors();
  void close(int descriptor, Connection& connection, const std::string& why);

  const PeerLimits limits_;
  const std::size_t most_connections_;
  zmq::socket_t* router_;
  zmq::socket_t events_;
  std::mutex mutex_;  ///< guards what is below
  std::map<int, Connection> connections_;
  Clock::time_point looked_;  ///< at all of them
  Closed closed_;
  std::jthread thread_;
};

}  // namespace palpate
