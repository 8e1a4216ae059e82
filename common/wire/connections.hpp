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

/// Limits on connections to a ROUTER.
struct PeerLimits {
  /// Largest message with its payload. A longer one is refused, but has then been in memory.
  std::size_t message_bytes;
  /// Allowed rate. A burst may hold the messages of two seconds.
  double messages_per_second = 20000;
  /// Largest number of simultaneous connections. Default: the process's descriptor limit minus some
  /// for its own use.
  std::optional<std::size_t> connections = std::nullopt;
  /// Largest number of connections without a received message. For each, libzmq may hold a frame of
  /// 128 kB.
  std::size_t silent = 4096;
};

/// Closes connections of a ROUTER that CURVE and the limits of libzmq leave open: those with too
/// long or too many messages, and the oldest silent ones. Silent connections, nearly always of
/// strangers, are closed before the process runs out of descriptors or has thousands of them.
///
/// A separate thread watches descriptors, so that a slow disk does not stop this protection. One
/// other thread may call the other functions. Construct before the socket is bound, destroy before
/// the socket.
class Connections {
 public:
  Connections(zmq::context_t& context, zmq::socket_t& router, const PeerLimits& limits);
  Connections(const Connections&) = delete;
  Connections& operator=(const Connections&) = delete;
  ~Connections();

  /// Records a message of `bytes` bytes over this connection (its descriptor,
  /// Incoming::connection). Returns false if the connection is closed; the message must then be
  /// ignored.
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
    std::uint64_t cookie = 0;  ///< of the socket, since descriptors are reused
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
