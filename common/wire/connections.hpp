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

/// Limits on connections to a ZeroMQ ROUTER socket.
struct PeerLimits {
  /// Largest message including its payload, bytes. A connection that sends a larger one is closed,
  /// but only after the message was received into memory.
  std::size_t message_bytes;
  /// Allowed rate of messages per connection. A burst may contain as many messages as are allowed
  /// in two seconds.
  double messages_per_second = 20000;
  /// Largest number of simultaneous connections. The default is the process's limit on file
  /// descriptors minus a reserve for the process itself.
  std::optional<std::size_t> connections = std::nullopt;
  /// Largest number of silent connections, from which no message was received. For each of them,
  /// libzmq may have an incomplete frame of 128 kB in memory.
  std::size_t silent = 4096;
};

/// Protects a ROUTER against overload by closing connections, which CURVE and the limits of libzmq
/// do not do. Closes a connection if its messages are too large or too many. Closes the oldest
/// silent connections, nearly all of which belong to strangers, before the process runs out of
/// descriptors or has thousands of silent connections.
///
/// A separate thread watches for new connections, so that the protection also works while the main
/// thread waits for a slow disk. One other thread at a time may call the functions below. Construct
/// this object before the socket is bound, and destroy it before the socket.
class Connections {
 public:
  Connections(zmq::context_t& context, zmq::socket_t& router, const PeerLimits& limits);
  ~Connections();

  /// Must be called for every received message, with its size in bytes and the descriptor of its
  /// connection (Incoming::connection). Returns false if the connection was already closed, or if
  /// this call closes it; the caller must then ignore the message.
  bool received(int connection, std::size_t bytes);
  /// Number of connections closed since the last call, with reasons for the first few.
  struct Closed {
    std::int64_t count = 0;
    std::vector<std::string> why;
  };
  Closed takeClosed();

 private:
  using Clock = std::chrono::steady_clock;
  struct Connection {
    std::uint64_t cookie = 0;  ///< identifies the socket, because descriptors are reused
    Clock::time_point since, latest;
    double messages = 0;  ///< level of a leaky bucket that drains at messages_per_second
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
  std::mutex mutex_;  ///< guards the members below
  std::map<int, Connection> connections_;
  Clock::time_point looked_;  ///< time of the last check of all connections
  Closed closed_;
  std::jthread thread_;
};

}  // namespace palpate
