#include "common/wire/connections.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <linux/tcp.h>
#include <netinet/in.h>
#include <sys/ioctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
#include <optional>
#include <tuple>

#include "common/base/error.hpp"
#include "common/base/file_descriptor.hpp"
#include "common/base/machine.hpp"
#include "common/wire/wire.hpp"

namespace palpate {
namespace {

using Seconds = std::chrono::duration<double>;

/// A gigabyte a second, which is what comes in at most, is 20 MB of this.
constexpr std::chrono::milliseconds between_looks{20};
/// Looking takes at most such a share of a processor.
constexpr double share_of_looking = 0.05;
/// A process that was stopped counts no more than this of the time it was.
constexpr Seconds longest_between_looks{1};
/// The handshake is received and never delivered.
constexpr std::int64_t bytes_of_handshake = 16384;
/// Kept for files, and for whoever comes to ask for the status.
constexpr std::size_t descriptors_of_our_own = 128;
constexpr double seconds_of_messages = 2;
constexpr std::size_t most_closed_told = 20, most_addresses = 4096;

/// The address of the other side; nothing when there is none any more, or it is no TCP connection.
std::optional<std::string> addressOf(int descriptor) {
  sockaddr_storage storage{};
  socklen_t size = sizeof storage;
  if (getpeername(descriptor, reinterpret_cast<sockaddr*>(&storage), &size) != 0)
    return std::nullopt;
  std::array<char, INET6_ADDRSTRLEN> text{};
  const void* address = nullptr;
  if (storage.ss_family == AF_INET)
    address = &reinterpret_cast<const sockaddr_in&>(storage).sin_addr;
  else if (storage.ss_family == AF_INET6)
    address = &reinterpret_cast<const sockaddr_in6&>(storage).sin6_addr;
  if (address == nullptr ||
      inet_ntop(storage.ss_family, address, text.data(), text.size()) == nullptr)
    return std::nullopt;
  return text.data();
}

template <class Value>
bool readOption(int descriptor, int level, int option, Value& value) {
  socklen_t size = sizeof value;
  return getsockopt(descriptor, level, option, &value, &size) == 0 && size == sizeof value;
}

std::uint64_t cookieOf(int descriptor) {
  std::uint64_t cookie = 0;
  return readOption(descriptor, SOL_SOCKET, SO_COOKIE, cookie) ? cookie : 0;
}

/// Of the connection with this cookie; nothing when it has ended, whoever has its descriptor.
std::optional<Connections::Traffic> trafficOf(int descriptor, std::uint64_t cookie) {
  tcp_info info{};
  socklen_t size = sizeof info;
  int unread = 0;
  if (getsockopt(descriptor, IPPROTO_TCP, TCP_INFO, &info, &size) != 0 ||
      size < offsetof(tcp_info, tcpi_segs_out) || ioctl(descriptor, FIONREAD, &unread) != 0 ||
      cookieOf(descriptor) != cookie)
    return std::nullopt;
  // What is still with the system is not in this process.
  const auto received = static_cast<std::int64_t>(info.tcpi_bytes_received) - unread;
  return Connections::Traffic{
      .received = static_cast<std::uint64_t>(std::max<std::int64_t>(received, 0)),
      .arrived = info.tcpi_bytes_received,
      .acknowledged = info.tcpi_bytes_acked};
}

std::size_t mostConnections() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) throw failure("getrlimit: {}", errnoText());
  return limit.rlim_cur > 2 * descriptors_of_our_own ? limit.rlim_cur - descriptors_of_our_own
                                                     : descriptors_of_our_own;
}

}  // namespace

PeerLimits PeerLimits::forMessagesOf(std::size_t message_bytes, std::size_t queue_length) {
  constexpr std::size_t beside = 1 << 20;  // one that is being read, and buffers
  const std::size_t unread = (queue_length + 2) * message_bytes + beside;
  // So that a hall full of workers is no flood while the disk stands still for some seconds.
  constexpr std::size_t share_of_memory = 16;
  return {
      .unread = unread,
      .unread_in_all = std::max<std::size_t>(64 << 20, memoryBytes().value_or(0) / share_of_memory),
      // Workers ask for the starts of two jobs at once.
      .behind = std::max<std::size_t>(65536, 2 * message_bytes)};
}

Connections::Connections(zmq::context_t& context, zmq::socket_t& router, const PeerLimits& limits)
    : limits_(limits),
      router_(&router),
      most_connections_(limits.connections ? *limits.connections : mostConnections()),
      events_(context, zmq::socket_type::pair) {
  static std::atomic<int> count{0};
  const std::string endpoint = fmt::format("inproc://connections-{}", ++count);
  if (zmq_socket_monitor(router.handle(), endpoint.c_str(),
                         ZMQ_EVENT_ACCEPTED | ZMQ_EVENT_DISCONNECTED) != 0)
    throw failure("ZeroMQ does not watch a socket: {}", zmq_strerror(zmq_errno()));
  events_.set(zmq::sockopt::linger, 0);
  // ZeroMQ's own thread would wait for room.
  events_.set(zmq::sockopt::rcvhwm, 0);
  events_.connect(endpoint);
  thread_ = std::jthread([this](const std::stop_token& stop) { watch(stop); });
}

Connections::~Connections() {
  thread_.request_stop();
  thread_.join();
  // ZeroMQ's own thread would wait for somebody to take its events.
  zmq_socket_monitor(router_->handle(), nullptr, 0);
}

void Connections::watch(const std::stop_token& stop) {
  auto looked = Clock::now();
  std::chrono::milliseconds pause = between_looks;
  while (!stop.stop_requested()) {
    waitForMessages(events_, pause);
    const std::lock_guard lock(mutex_);
    takeEvents();
    const auto now = Clock::now();
    // Events come in between as they like.
    if (now - looked < pause) continue;
    look(std::min<Seconds>(now - std::exchange(looked, now), longest_between_looks));
    const Seconds taken = Clock::now() - now;
    pause = std::max(between_looks,
                     std::chrono::ceil<std::chrono::milliseconds>(taken / share_of_looking));
  }
}

void Connections::takeEvents() {
  zmq::message_t event, endpoint;
  while (repeatWhenInterrupted([&] { return events_.recv(event, zmq::recv_flags::dontwait); })) {
    if (!event.more() || event.size() < 6) continue;
    (void)repeatWhenInterrupted([&] { return events_.recv(endpoint, zmq::recv_flags::none); });
    std::uint16_t kind = 0;
    std::int32_t descriptor = -1;
    std::memcpy(&kind, event.data(), sizeof kind);
    std::memcpy(&descriptor, event.data<char>() + sizeof kind, sizeof descriptor);
    if (kind == ZMQ_EVENT_ACCEPTED)
      accepted(descriptor);
    else if (!isSame(descriptor))
      forget(descriptor);
  }
}

/// Events come late: the descriptor may be another connection's by now, which is known by its first
/// message.
bool Connections::isSame(int descriptor) const {
  const auto known = connections_.find(descriptor);
  return known != connections_.end() && known->second.cookie == cookieOf(descriptor);
}

void Connections::accepted(int descriptor) {
  if (isSame(descriptor)) return;
  forget(descriptor);
  const std::uint64_t cookie = cookieOf(descriptor);
  const auto address = addressOf(descriptor);
  // Another one came between: its own event tells.
  if (!address || cookieOf(descriptor) != cookie) return;
  flooded_before_.erase(descriptor);
  Connection& connection = connections_[descriptor];
  connection.address = *address;
  connection.cookie = cookie;
  connection.flooded = isShutOut(*address);
  if (connection.flooded) return shut(descriptor, connection);
  if (!isFullOfEnded()) return;
  const std::string why = fmt::format(
      "others that ended may have left {} bytes that were not received yet", left_by_ended_);
  if (!std::exchange(told_of_ended_, true)) return close(descriptor, connection, why);
  shut(descriptor, connection);
  ++closed_count_;
}

void Connections::forget(int descriptor) {
  const auto found = connections_.find(descriptor);
  if (found == connections_.end()) return;
  const auto peer = of_peer_.find(found->second.peer);
  if (peer != of_peer_.end() && peer->second == descriptor) of_peer_.erase(peer);
  if (found->second.flooded) flooded_before_.insert(descriptor);
  // What came after the last look is not known any more.
  left_by_ended_ += limits_.unread;
  connections_.erase(found);
}

void Connections::look(Seconds since_last) {
  std::vector<int> gone;
  for (auto& [descriptor, connection] : connections_) {
    const auto traffic = trafficOf(descriptor, connection.cookie);
    if (!traffic) {
      gone.push_back(descriptor);
      continue;
    }
    connection.silent =
        traffic->arrived > connection.latest.arrived ? Seconds(0) : connection.silent + since_last;
    const bool moves = traffic->acknowledged > connection.latest.acknowledged;
    connection.latest = *traffic;
    connection.unmoved =
        moves || owed(connection) <= limits_.behind ? Seconds(0) : connection.unmoved + since_last;
    connection.messages =
        std::max(0.0, connection.messages - limits_.messages_per_second * since_last.count());
    connection.unread = static_cast<std::int64_t>(traffic->received) -
                        static_cast<std::int64_t>(connection.taken) - bytes_of_handshake;
    if (!connection.closing) judge(descriptor, connection);
  }
  for (const int descriptor : gone) forget(descriptor);
  keepBelowInAll();
  keepDescriptors();
}

void Connections::judge(int descriptor, Connection& connection) {
  if (std::cmp_greater(connection.unread, limits_.unread))
    return flooded(descriptor, connection,
                   fmt::format("{} bytes of it were not received yet", connection.unread));
  if (connection.messages > seconds_of_messages * limits_.messages_per_second)
    return flooded(
        descriptor, connection,
        fmt::format("it sent more than {} messages a second", limits_.messages_per_second));
  if (connection.unmoved >= limits_.reading)
    return close(descriptor, connection,
                 fmt::format("it reads nothing of {} bytes", owed(connection)));
  if (connection.silent >= limits_.silence)
    close(descriptor, connection, fmt::format("it said nothing for {} s", limits_.silence.count()));
}

/// Those that have most go first.
void Connections::keepBelowInAll() {
  std::int64_t sum = 0;
  std::vector<std::pair<std::int64_t, int>> largest;
  for (const auto& [descriptor, connection] : connections_) {
    if (connection.closing || connection.unread <= 0) continue;
    sum += connection.unread;
    largest.emplace_back(connection.unread, descriptor);
  }
  if (std::cmp_less_equal(sum, limits_.unread_in_all)) return;
  std::ranges::sort(largest, std::greater());
  for (const auto& [unread, descriptor] : largest) {
    if (std::cmp_less_equal(sum, limits_.unread_in_all)) return;
    sum -= unread;
    close(descriptor, connections_.at(descriptor),
          fmt::format("{} bytes of it, and more of others, were not received yet", unread));
  }
}

/// Those go first that never said anything, and of them, and of the others, those that have been
/// silent longest.
void Connections::keepDescriptors() {
  std::vector<std::tuple<bool, Seconds, int>> open;
  for (const auto& [descriptor, connection] : connections_)
    if (!connection.closing)
      open.emplace_back(connection.peer.empty(), connection.silent, descriptor);
  if (open.size() <= most_connections_) return;
  std::ranges::sort(open, std::greater());
  open.resize(open.size() - most_connections_);
  for (const auto& [is_stranger, silent, descriptor] : open)
    close(descriptor, connections_.at(descriptor),
          fmt::format("there are {} others, and none was silent for longer", most_connections_));
}

void Connections::flooded(int descriptor, Connection& connection, const std::string& why) {
  close(descriptor, connection, why);
  connection.flooded = true;
  // Many may come from here that have nothing to do with each other: through a tunnel, as a build's
  // own.
  if (connection.address == "127.0.0.1" || connection.address == "::1") return;
  const auto now = Clock::now();
  if (floods_.size() >= most_addresses)
    std::erase_if(floods_,
                  [&](const auto& flood) { return now - flood.second.latest > limits_.shut_out; });
  if (floods_.size() >= most_addresses) floods_.clear();
  Floods& floods = floods_[connection.address];
  if (now - floods.latest > limits_.shut_out) floods.count = 0;
  ++floods.count;
  floods.latest = now;
  if (floods.count == limits_.floods)
    note(fmt::format("{} is not let in for {} s: it flooded {} times", connection.address,
                     limits_.shut_out.count(), floods.count));
}

bool Connections::isShutOut(const std::string& address) const {
  const auto found = floods_.find(address);
  return found != floods_.end() && found->second.count >= limits_.floods &&
         Clock::now() - found->second.latest <= limits_.shut_out;
}

void Connections::close(int descriptor, Connection& connection, const std::string& why) {
  shut(descriptor, connection);
  note(fmt::format("a connection from {} was closed: {}", connection.address, why));
}

/// ZeroMQ's thread finds it ended, drops the message that is not whole, and closes the descriptor.
void Connections::shut(int descriptor, Connection& connection) {
  connection.closing = true;
  // That thread may have closed it, and accepted another connection there: a copy stays what it is.
  const FileDescriptor copy(fcntl(descriptor, F_DUPFD_CLOEXEC, 0));
  const int its_own = copy ? copy.get() : descriptor;
  if (cookieOf(its_own) == connection.cookie)
    shutdown(its_own, SHUT_RDWR);  // where it fails, it has ended
}

void Connections::note(std::string line) {
  ++closed_count_;
  if (closed_.size() < most_closed_told) closed_.push_back(std::move(line));
}

bool Connections::received(int connection, const std::string& peer, std::size_t bytes) {
  const std::lock_guard lock(mutex_);
  accepted(connection);
  const auto found = connections_.find(connection);
  // It has ended, and nobody has its descriptor yet.
  if (found == connections_.end()) return !flooded_before_.contains(connection);
  Connection& from = found->second;
  from.taken += bytes;
  ++from.messages;
  // It came faster than anybody looked.
  if (bytes > limits_.unread && !from.closing)
    flooded(connection, from, fmt::format("it sent a message of {} bytes", bytes));
  if (from.flooded || from.peer == peer) return !from.flooded;
  // A message outlives its connection: the one before may have had this descriptor.
  if (const auto before = of_peer_.find(from.peer);
      before != of_peer_.end() && before->second == connection)
    of_peer_.erase(before);
  from.peer = peer;
  from.given = 0;
  const auto traffic = trafficOf(connection, from.cookie);
  from.acknowledged_before = traffic ? traffic->acknowledged : 0;
  of_peer_[peer] = connection;
  return true;
}

void Connections::receivedAll() {
  const std::lock_guard lock(mutex_);
  left_by_ended_ = 0;
  told_of_ended_ = false;
}

void Connections::sent(const std::string& peer, std::size_t bytes) {
  const std::lock_guard lock(mutex_);
  if (Connection* const to = ofPeer(peer)) to->given += bytes;
}

bool Connections::isBehind(const std::string& peer) {
  const std::lock_guard lock(mutex_);
  Connection* const to = ofPeer(peer);
  if (to == nullptr || owed(*to) <= limits_.behind) return false;
  if (const auto traffic = trafficOf(of_peer_.at(peer), to->cookie))
    to->latest.acknowledged = traffic->acknowledged;
  return owed(*to) > limits_.behind;
}

std::uint64_t Connections::owed(const Connection& connection) {
  const std::uint64_t read =
      connection.latest.acknowledged -
      std::min(connection.latest.acknowledged, connection.acknowledged_before);
  return connection.given - std::min(connection.given, read);
}

Connections::Connection* Connections::ofPeer(const std::string& peer) {
  const auto found = of_peer_.find(peer);
  if (found == of_peer_.end()) return nullptr;
  const auto connection = connections_.find(found->second);
  return connection == connections_.end() ? nullptr : &connection->second;
}

Connections::Closed Connections::takeClosed() {
  const std::lock_guard lock(mutex_);
  return {std::exchange(closed_count_, 0), std::exchange(closed_, {})};
}

}  // namespace palpate
