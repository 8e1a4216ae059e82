#include "common/wire/connections.hpp"

#include <fmt/format.h>
#include <netdb.h>
#include <sys/resource.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <utility>

#include "common/base/error.hpp"
#include "common/wire/wire.hpp"

namespace palpate {
namespace {

/// Number of descriptors reserved for files and for clients that ask for the status.
constexpr std::size_t descriptors_of_our_own = 128;
constexpr double seconds_of_messages = 2;
constexpr std::size_t most_closed_told = 20;

std::string addressOf(int descriptor) {
  sockaddr_storage storage{};
  socklen_t size = sizeof storage;
  auto* const address = reinterpret_cast<sockaddr*>(&storage);
  std::array<char, NI_MAXHOST> text{};
  if (getpeername(descriptor, address, &size) != 0 ||
      getnameinfo(address, size, text.data(), text.size(), nullptr, 0, NI_NUMERICHOST) != 0)
    return "an unknown address";
  return text.data();
}

/// Returns the id that the system gives to a socket for its lifetime; 0 if it is not a socket.
std::uint64_t cookieOf(int descriptor) {
  std::uint64_t cookie = 0;
  socklen_t size = sizeof cookie;
  return getsockopt(descriptor, SOL_SOCKET, SO_COOKIE, &cookie, &size) == 0 ? cookie : 0;
}

std::size_t mostConnections() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) throw failure("getrlimit failed: {}", errnoText());
  return limit.rlim_cur > 2 * descriptors_of_our_own ? limit.rlim_cur - descriptors_of_our_own
                                                     : descriptors_of_our_own;
}

}  // namespace

Connections::Connections(zmq::context_t& context, zmq::socket_t& router, const PeerLimits& limits)
    : limits_(limits),
      most_connections_(limits.connections ? *limits.connections : mostConnections()),
      router_(&router),
      events_(monitorOf(context, router, ZMQ_EVENT_ACCEPTED | ZMQ_EVENT_MONITOR_STOPPED)) {
  thread_ = std::jthread([this](const std::stop_token& stop) { watch(stop); });
}

Connections::~Connections() {
  thread_.request_stop();
  // Stop the monitor. This is an event too, which wakes the thread.
  zmq_socket_monitor(router_->handle(), nullptr, 0);
  thread_.join();
}

void Connections::watch(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    waitForMessages(events_, std::chrono::seconds(1));
    const std::lock_guard lock(mutex_);
    while (const auto event = nextEvent(events_))
      if (event->kind == ZMQ_EVENT_ACCEPTED) of(event->value);
    const bool looks = Clock::now() - looked_ >= std::chrono::seconds(1);
    if (connections_.size() > most_connections_ || (looks && connections_.size() > limits_.silent))
      keepDescriptors();
  }
}

/// Returns the record of the connection that now has the descriptor; makes it if necessary, because
/// a message may be read before the event that reports its connection as accepted. The record of an
/// ended connection remains until its descriptor is reused or keepDescriptors() runs.
Connections::Connection& Connections::of(int descriptor) {
  Connection& connection = connections_[descriptor];
  // If the cookie is 0, the connection has ended, but its last messages may still arrive; keep the
  // record.
  if (const std::uint64_t cookie = cookieOf(descriptor); cookie != 0 && connection.cookie != cookie)
    connection = {.cookie = cookie, .since = Clock::now(), .latest = Clock::now()};
  return connection;
}

void Connections::keepDescriptors() {
  looked_ = Clock::now();
  std::erase_if(connections_, [](const auto& entry) {
    const std::uint64_t cookie = cookieOf(entry.first);
    return cookie == 0 || entry.second.cookie != cookie;
  });
  std::vector<std::pair<Clock::time_point, int>> silent;
  std::size_t open = 0;
  for (const auto& [descriptor, connection] : connections_) {
    if (connection.closed) continue;
    ++open;
    if (!connection.spoke) silent.emplace_back(connection.since, descriptor);
  }
  // Close a few more than necessary, so that not every new connection causes a full check.
  const auto beyond = [](std::size_t count, std::size_t most) {
    return count > most ? count - most + most / 64 : 0;
  };
  std::ranges::sort(silent);
  silent.resize(std::min(silent.size(), std::max(beyond(open, most_connections_),
                                                 beyond(silent.size(), limits_.silent))));
  for (const auto& [since, descriptor] : silent)
    close(descriptor, connections_.at(descriptor),
          fmt::format("it sent nothing, and there are {} other connections", open - 1));
}

/// Shuts the connection down. ZeroMQ's thread then drops its incomplete message and closes the
/// descriptor. If that thread closes the descriptor between the check and the shutdown, and it is
/// reused, the wrong connection is shut down; its peer then connects again.
void Connections::close(int descriptor, Connection& connection, const std::string& why) {
  connection.closed = true;
  ++closed_.count;
  if (closed_.why.size() < most_closed_told)
    closed_.why.push_back(
        fmt::format("a connection from {} was closed: {}", addressOf(descriptor), why));
  if (connection.cookie != 0 && cookieOf(descriptor) == connection.cookie)
    shutdown(descriptor, SHUT_RDWR);
}

bool Connections::received(int descriptor, std::size_t bytes) {
  const std::lock_guard lock(mutex_);
  Connection& connection = of(descriptor);
  if (connection.closed) return false;
  connection.spoke = true;
  const auto now = Clock::now();
  const std::chrono::duration<double> since_latest = now - std::exchange(connection.latest, now);
  connection.messages =
      1 + std::max(0.0, connection.messages - limits_.messages_per_second * since_latest.count());
  if (bytes > limits_.message_bytes)
    close(descriptor, connection, fmt::format("its message of {} bytes is too large", bytes));
  else if (connection.messages > seconds_of_messages * limits_.messages_per_second)
    close(descriptor, connection,
          fmt::format("it sent more than {} messages per second", limits_.messages_per_second));
  return !connection.closed;
}

Connections::Closed Connections::takeClosed() {
  const std::lock_guard lock(mutex_);
  return std::exchange(closed_, {});
}

}  // namespace palpate
