#include "common/wire/wire.hpp"

#include <net/if.h>
#include <netdb.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "common/base/file_descriptor.hpp"
#include "common/base/index.hpp"
#include "common/base/number_in.hpp"

namespace palpate {
namespace {

/// Owner of the memory of a message's frames, released when the system has taken the last frame.
/// Frames without an owner are copied.
using Owner = std::shared_ptr<const void>;

zmq::message_t frameOf(std::string_view bytes, const Owner& owner) {
  if (!owner) return {bytes.data(), bytes.size()};
  // ZeroMQ takes a pointer to mutable memory, although it only reads from it. It calls the release
  // function from its own thread.
  return {const_cast<char*>(bytes.data()), bytes.size(),
          [](void*, void* held) { delete static_cast<Owner*>(held); }, new Owner(owner)};
}

bool sendFrame(zmq::socket_t& socket, zmq::message_t frame, bool more) {
  const zmq::send_flags flags =
      zmq::send_flags::dontwait | (more ? zmq::send_flags::sndmore : zmq::send_flags::none);
  return repeatWhenInterrupted([&] { return socket.send(frame, flags).has_value(); });
}

Sent sendInFrames(zmq::socket_t& socket, std::string_view peer, std::string_view message,
                  std::string_view payload, const Owner& owner) {
  // If libzmq accepts the first frame, it accepts the other frames of the message too.
  try {
    if (!peer.empty() && !sendFrame(socket, frameOf(peer, nullptr), true)) return Sent::full;
    if (!sendFrame(socket, frameOf(message, owner), !payload.empty())) return Sent::full;
    for (; !payload.empty(); payload.remove_prefix(std::min(payload.size(), payload_frame_bytes)))
      if (!sendFrame(socket, frameOf(payload.substr(0, payload_frame_bytes), owner),
                     payload.size() > payload_frame_bytes))
        throw failure("ZeroMQ took the first frames of a message and then refused the next");
  } catch (const zmq::error_t& error) {
    if (error.num() == EHOSTUNREACH) return Sent::unroutable;
    throw failure("ZeroMQ send: {}", error.what());
  }
  return Sent::yes;
}

zmq::socket_t makeSocket(zmq::context_t& context, zmq::socket_type type) {
  zmq::socket_t socket(context, type);
  // Do not wait for undelivered messages when the program ends; lost results are computed again.
  socket.set(zmq::sockopt::linger, 0);
  socket.set(zmq::sockopt::maxmsgsize, static_cast<std::int64_t>(4) << 20);
  socket.set(zmq::sockopt::handshake_ivl, 10000);
  socket.set(zmq::sockopt::tcp_keepalive, 1);
  socket.set(zmq::sockopt::tcp_keepalive_idle, 60);
  socket.set(zmq::sockopt::tcp_keepalive_intvl, 10);
  socket.set(zmq::sockopt::tcp_keepalive_cnt, 6);
  return socket;
}

/// The result of resolving a host name.
struct HostAddress {
  std::string text = {};     ///< as in endpoints: "127.0.0.1", "[::1]"; empty if not found
  std::string trouble = {};  ///< the reason if no address was found
};

/// Resolves a host name. Returns its first IPv4 address, else its first IPv6 address. IPv4 goes
/// first, because localhost has both kinds of address, and a server may listen at 127.0.0.1 only.
HostAddress lookUp(const std::string& host) {
  addrinfo wanted{};
  wanted.ai_socktype = SOCK_STREAM;
  addrinfo* all = nullptr;
  int error = getaddrinfo(host.c_str(), nullptr, &wanted, &all);
  std::array<char, NI_MAXHOST> text{};
  bool of_ipv6 = false;
  if (error == 0 && all != nullptr) {
    const addrinfo* chosen = all;
    while (chosen != nullptr && chosen->ai_family != AF_INET) chosen = chosen->ai_next;
    of_ipv6 = chosen == nullptr;
    if (of_ipv6) chosen = all;
    error = getnameinfo(chosen->ai_addr, chosen->ai_addrlen, text.data(), text.size(), nullptr, 0,
                        NI_NUMERICHOST);
    freeaddrinfo(all);
  }
  if (error != 0)
    return {.trouble = fmt::format("host {} not found ({}); check its name", host,
                                   error == EAI_SYSTEM ? errnoText() : gai_strerror(error))};
  return {.text = of_ipv6 ? fmt::format("[{}]", text.data()) : text.data()};
}

/// Returns HOST and PORT of tcp://HOST:PORT. A missing part is empty. The brackets around an IPv6
/// address are removed.
std::pair<std::string, std::string> hostAndPort(const std::string& endpoint) {
  const std::string address = endpoint.substr(std::string_view("tcp://").size());
  const std::size_t colon = address.rfind(':');
  if (colon == std::string::npos) return {address, ""};
  std::string host = address.substr(0, colon);
  if (host.starts_with('[') && host.ends_with(']')) host = host.substr(1, host.size() - 2);
  return {host, address.substr(colon + 1)};
}

/// Returns `endpoint` with its host name replaced by the address, because libzmq does not resolve
/// names when it binds. Error if the host is not found.
std::string withAddress(const std::string& endpoint) {
  if (!endpoint.starts_with("tcp://")) return endpoint;
  const auto [host, port] = hostAndPort(endpoint);
  // libzmq itself understands *, which means all IPv4 addresses, and names of network interfaces
  // such as eth0.
  if (host == "*" || if_nametoindex(host.c_str()) != 0) return endpoint;
  const HostAddress found = lookUp(host);
  if (!found.trouble.empty()) throw failure("cannot listen on {}: {}", endpoint, found.trouble);
  return fmt::format("tcp://{}:{}", found.text, port);
}

bool hasUnknownFieldsHere(const google::protobuf::Message& message) {
  return !message.GetReflection()->GetUnknownFields(message).empty();
}

/// Returns whether a process listens at the socket file. The file that a killed process leaves
/// behind refuses connections.
bool isListenedAt(const std::string& path) {
  struct sockaddr_un address {};
  address.sun_family = AF_UNIX;
  PALPATE_ASSERT(path.size() < sizeof address.sun_path, "the path must fit into the address");
  path.copy(address.sun_path, path.size());
  const FileDescriptor probe(socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!probe) throw failure("ipc://{}: cannot check for a listener: {}", path, errnoText());
  const bool connected =
      connect(probe.get(), reinterpret_cast<const struct sockaddr*>(&address), sizeof address) == 0;
  // EAGAIN means that the listener's queue of pending connections is full.
  return connected || errno == EAGAIN || errno == EACCES;
}

/// Refuses an ipc:// path that is in use. Without this check libzmq would remove any file at the
/// path before it listens there, even the socket of a running scheduler.
void refuseTakenPath(const std::string& endpoint) {
  constexpr std::string_view ipc = "ipc://";
  if (!endpoint.starts_with(ipc)) return;
  const std::string path = endpoint.substr(ipc.size());
  // A path that begins with @ is not a file. For the path *, libzmq chooses a new file.
  if (path.starts_with('@') || path == "*") return;
  struct stat info {};
  if (lstat(path.c_str(), &info) != 0) return;
  if (!S_ISSOCK(info.st_mode))
    throw failure("{}: this file exists and is not a socket; choose another path", endpoint);
  if (isListenedAt(path))
    throw failure(
        "{} is in use by another program: stop it (palpate stop {}) or choose another path",
        endpoint, endpoint);
}

/// Reads a matrix of doubles from raw bytes, row by row. Returns false if the length is wrong or a
/// number is not finite.
template <int rows, int columns, int options>
bool readMatrix(const std::string& bytes, Eigen::Matrix<double, rows, columns, options>& matrix) {
  Eigen::Matrix<double, rows, columns, columns == 1 ? Eigen::ColMajor : Eigen::RowMajor> values;
  if (bytes.size() != sizeof(double) * rows * columns) return false;
  std::memcpy(values.data(), bytes.data(), bytes.size());
  matrix = values;
  return matrix.allFinite();
}

/// Returns the bytes of a matrix row by row, as readMatrix expects them.
std::string matrixBytes(const Eigen::Ref<const Eigen::MatrixXd>& matrix) {
  const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> rows = matrix;
  return {reinterpret_cast<const char*>(rows.data()), at(rows.size()) * sizeof(double)};
}

bool readDrive(const wire::Equilibrium& message, Equilibrium& equilibrium) {
  if (message.drive().empty() && message.drive_stiffness().empty() &&
      message.drive_slope().empty() && message.stiffness_by_p().empty() &&
      message.stiffness_by_s().empty() && message.drive_slope_by_p().empty())
    return true;
  return readMatrix(message.drive(), equilibrium.drive) &&
         readMatrix(message.drive_stiffness(), equilibrium.drive_stiffness) &&
         readMatrix(message.drive_slope(), equilibrium.drive_slope) &&
         readMatrix(message.stiffness_by_p(), equilibrium.stiffness_by_p) &&
         readMatrix(message.stiffness_by_s(), equilibrium.stiffness_by_s) &&
         readMatrix(message.drive_slope_by_p(), equilibrium.drive_slope_by_p);
}

void setVector(const Eigen::Vector3d& vector, std::string& bytes) {
  bytes.assign(reinterpret_cast<const char*>(vector.data()), 3 * sizeof(double));
}

void toWire(const Hold& hold, wire::Hold& message) {
  setVector(hold.place, *message.mutable_place());
  setVector(hold.displacement, *message.mutable_displacement());
}

bool readHold(const wire::Hold& message, Hold& hold) {
  return readMatrix(message.place(), hold.place) &&
         readMatrix(message.displacement(), hold.displacement);
}

bool readHeld(const wire::Held& message, Held& held) {
  return readHold(message.at(), held.at) && readMatrix(message.force(), held.force) &&
         readMatrix(message.stiffness(), held.stiffness) &&
         readMatrix(message.hand_by_hold(), held.hand_by_hold);
}

void toWire(const Equilibrium& equilibrium, wire::Equilibrium& message) {
  setVector(equilibrium.force, *message.mutable_force());
  message.set_stiffness(matrixBytes(equilibrium.stiffness));
  message.set_energy(equilibrium.energy);
  message.set_min_det_f(equilibrium.min_det_F);
  if (!hasDrive(equilibrium)) return;
  setVector(equilibrium.drive, *message.mutable_drive());
  message.set_drive_stiffness(matrixBytes(equilibrium.drive_stiffness));
  message.set_drive_slope(matrixBytes(equilibrium.drive_slope));
  message.set_stiffness_by_p(matrixBytes(equilibrium.stiffness_by_p));
  message.set_stiffness_by_s(matrixBytes(equilibrium.stiffness_by_s));
  message.set_drive_slope_by_p(matrixBytes(equilibrium.drive_slope_by_p));
}

/// Returns nullopt if the message is invalid or has numbers that cannot be used.
std::optional<Equilibrium> fromWire(const wire::Equilibrium& message) {
  Equilibrium equilibrium;
  equilibrium.energy = message.energy();
  equilibrium.min_det_F = message.min_det_f();
  const bool valid = readMatrix<3, 1>(message.force(), equilibrium.force) &&
                     readMatrix<3, 3>(message.stiffness(), equilibrium.stiffness) &&
                     readDrive(message, equilibrium) && isUsable(equilibrium);
  return valid ? std::optional(equilibrium) : std::nullopt;
}

void toWire(const Failure& failure, wire::Failure& message) {
  message.set_cause(static_cast<std::uint32_t>(failure.cause));
  message.set_step_reached(failure.step_reached);
  message.set_residual(failure.residual);
  message.set_element(failure.element);
  message.set_element_det_f(failure.element_det_F);
  message.set_negative_pivots(failure.negative_pivots);
  message.set_expected_negative_pivots(failure.expected_negative_pivots);
  message.set_mumps_infog1(failure.mumps_infog1);
  message.set_mumps_infog2(failure.mumps_infog2);
}

/// Returns nullopt if the cause is unknown.
std::optional<Failure> fromWire(const wire::Failure& message) {
  const std::optional<Cause> cause = causeOf(message.cause());
  if (!cause) return std::nullopt;
  return Failure{*cause,
                 message.step_reached(),
                 message.residual(),
                 message.element(),
                 message.element_det_f(),
                 message.negative_pivots(),
                 message.expected_negative_pivots(),
                 message.mumps_infog1(),
                 message.mumps_infog2()};
}

void toWire(const Cost& cost, wire::Cost& message) {
  message.set_newton_iterations(cost.newton_iterations);
  message.set_factorizations(cost.factorizations);
  message.set_steps(cost.steps);
  message.set_seconds(cost.seconds);
}

Cost fromWire(const wire::Cost& message) {
  return {message.newton_iterations(), message.factorizations(), message.steps(),
          message.seconds()};
}

}  // namespace

bool isOnThisMachineOnly(const std::string& endpoint) {
  return std::ranges::any_of(std::array{"ipc://", "tcp://127.", "tcp://localhost:", "tcp://[::1]:"},
                             [&](const char* prefix) { return endpoint.starts_with(prefix); });
}

Sent sendMessage(zmq::socket_t& socket, std::string_view peer, const wire::Message& message,
                 std::string_view payload) {
  return sendInFrames(socket, peer, message.SerializeAsString(), payload, nullptr);
}

Sent sendBytes(zmq::socket_t& socket, std::string_view peer, std::string_view bytes) {
  return sendInFrames(socket, peer, bytes, {}, nullptr);
}

Sent sendMessage(zmq::socket_t& socket, std::string_view peer, const wire::Message& message,
                 const std::shared_ptr<const std::string>& payload,
                 const std::shared_ptr<const void>& until_sent) {
  if (!payload && !until_sent) return sendMessage(socket, peer, message);
  struct Kept {
    std::string message;
    std::shared_ptr<const std::string> payload;
    std::shared_ptr<const void> until_sent;
  };
  const auto kept =
      std::make_shared<const Kept>(Kept{message.SerializeAsString(), payload, until_sent});
  return sendInFrames(socket, peer, kept->message, payload ? *payload : std::string_view(), kept);
}

bool isReadable(wire::Message& message) {
  if (message.has_hello() || message.has_refused()) return true;
  if (message.has_bundle())
    return !hasUnknownFieldsHere(message) && !hasUnknownFieldsHere(message.bundle());
  // Remove unknown fields, which Protobuf would otherwise keep and forward. Protobuf does not
  // remove unknown fields inside maps, but no message of the protocol contains a map.
  const std::size_t before = message.ByteSizeLong();
  message.DiscardUnknownFields();
  return message.ByteSizeLong() == before;
}

std::optional<PublicKey> senderOf(zmq::message_t& frame) {
  const char* const hex = zmq_msg_gets(frame.handle(), "User-Id");
  return hex == nullptr ? std::nullopt : PublicKey::fromHex(hex);
}

std::optional<Incoming> receiveMessage(zmq::socket_t& socket, bool router) {
  Incoming incoming;
  bool intact = true;
  int frame_number = router ? 0 : 1;
  zmq::message_t frame;
  try {
    do {
      if (!repeatWhenInterrupted([&] { return socket.recv(frame, zmq::recv_flags::dontwait); }))
        return std::nullopt;
      if (frame_number == 0) {
        incoming.peer = frame.to_string();
      } else if (frame_number == 1) {
        intact = incoming.message.ParseFromArray(frame.data(), static_cast<int>(frame.size())) &&
                 isReadable(incoming.message);
        if (router) {
          incoming.key = senderOf(frame);
          incoming.connection = zmq_msg_get(frame.handle(), ZMQ_SRCFD);
        }
      } else if (incoming.payload.size() + frame.size() <= max_payload_bytes) {
        incoming.payload.append(frame.data<char>(), frame.size());
      } else {
        intact = false;
      }
      if (frame_number > 0) incoming.bytes += frame.size();
      ++frame_number;
    } while (frame.more());
  } catch (const zmq::error_t& error) {
    throw failure("ZeroMQ receive: {}", error.what());
  }
  // All frames of a bad message were read, so the next call begins with the next message.
  if (!intact) incoming.message.Clear();
  return incoming;
}

zmq::socket_t makeRouter(zmq::context_t& context) {
  zmq::socket_t socket = makeSocket(context, zmq::socket_type::router);
  socket.set(zmq::sockopt::router_mandatory, true);
  // If a worker reconnects under the same name, its new connection replaces the old one.
  socket.set(zmq::sockopt::router_handover, true);
  // Frames from workers are small: a result without its fields, or a part of the fields.
  socket.set(zmq::sockopt::maxmsgsize, static_cast<std::int64_t>(2 * payload_frame_bytes));
  socket.set(zmq::sockopt::backlog, 4096);
  socket.set(zmq::sockopt::sndhwm, 4096);
  socket.set(zmq::sockopt::rcvhwm, router_queue_length);
  return socket;
}

zmq::socket_t makeDealer(zmq::context_t& context) {
  zmq::socket_t socket = makeSocket(context, zmq::socket_type::dealer);
  // Queue no messages while there is no connection to the scheduler.
  socket.set(zmq::sockopt::immediate, true);
  socket.set(zmq::sockopt::reconnect_ivl, 200);
  socket.set(zmq::sockopt::reconnect_ivl_max, 8000);
  socket.set(zmq::sockopt::connect_timeout, 5000);
  return socket;
}

void checkEndpoint(const std::string& endpoint) {
  if (endpoint.starts_with("ipc://")) {
    if (endpoint.size() < 6 + sizeof sockaddr_un::sun_path) return;
    throw badInput(
        "{}: the path is too long for a socket; choose one of at most {} bytes (TMPDIR sets the "
        "folder of temporary files)",
        endpoint, sizeof sockaddr_un::sun_path - 1);
  }
  if (endpoint.starts_with("tcp://")) {
    const auto [host, port] = hostAndPort(endpoint);
    if (!host.empty() && (port == "*" || numberIn<std::uint16_t>(port).value_or(0) > 0)) return;
  }
  throw badInput(
      "endpoint \"{}\": write tcp://HOST:PORT with a port from 1 to 65535, or ipc://PATH",
      endpoint);
}

std::string bindRouter(zmq::socket_t& socket, const std::string& endpoint) {
  checkEndpoint(endpoint);
  const std::string address = withAddress(endpoint);
  refuseTakenPath(address);
  try {
    socket.set(zmq::sockopt::ipv6, address.starts_with("tcp://["));
    socket.bind(address);
  } catch (const zmq::error_t& error) {
    if (error.num() == EADDRINUSE)
      throw failure(
          "{} is in use by another program: stop it (palpate stop {}) or choose another port",
          endpoint, endpoint);
    throw failure("cannot listen on {}: {}", endpoint, error.what());
  }
  std::string bound = socket.get(zmq::sockopt::last_endpoint);
  PALPATE_ASSERT(!bound.empty() && !(bound.starts_with("tcp://") && bound.ends_with(":*")),
                 "the endpoint must name the actual port");
  return bound;
}

std::string connectDealer(zmq::socket_t& socket, const std::string& endpoint) {
  checkEndpoint(endpoint);
  HostAddress found;
  if (endpoint.starts_with("tcp://")) found = lookUp(hostAndPort(endpoint).first);
  try {
    // Set this option only for IPv6 addresses. With it libzmq prefers the IPv6 address of every
    // host that has one.
    socket.set(zmq::sockopt::ipv6, found.text.starts_with('['));
    // Connect by host name, so that libzmq resolves the name again if the connection is lost.
    socket.connect(endpoint);
  } catch (const zmq::error_t& error) {
    throw badInput("cannot connect to {}: {}", endpoint, error.what());
  }
  return found.trouble;
}

bool waitForMessages(zmq::socket_t& socket, std::chrono::milliseconds longest, int wake_up) {
  std::array<zmq::pollitem_t, 2> items = {
      {{socket.handle(), 0, ZMQ_POLLIN, 0}, {nullptr, wake_up, ZMQ_POLLIN, 0}}};
  try {
    zmq::poll(items.data(), wake_up < 0 ? 1 : 2, longest);
  } catch (const zmq::error_t& error) {
    if (error.num() != EINTR) throw failure("ZeroMQ poll: {}", error.what());
    return false;
  }
  return true;
}

std::vector<std::string> receiveFrames(zmq::socket_t& socket) {
  std::vector<std::string> frames;
  zmq::message_t frame;
  do {
    if (!repeatWhenInterrupted([&] { return socket.recv(frame, zmq::recv_flags::dontwait); }))
      break;
    frames.push_back(frame.to_string());
  } while (frame.more());
  return frames;
}

zmq::socket_t monitorOf(zmq::context_t& context, zmq::socket_t& socket, int kinds) {
  static std::atomic<int> count{0};
  const std::string endpoint = fmt::format("inproc://monitor-{}", ++count);
  if (zmq_socket_monitor(socket.handle(), endpoint.c_str(), kinds) != 0)
    throw failure("ZeroMQ cannot monitor a socket: {}", zmq_strerror(zmq_errno()));
  zmq::socket_t monitor(context, zmq::socket_type::pair);
  monitor.set(zmq::sockopt::linger, 0);
  // Do not limit the queue of events; if it were full, ZeroMQ's own thread would wait.
  monitor.set(zmq::sockopt::rcvhwm, 0);
  monitor.connect(endpoint);
  return monitor;
}

std::optional<SocketEvent> nextEvent(zmq::socket_t& monitor) {
  for (auto frames = receiveFrames(monitor); !frames.empty(); frames = receiveFrames(monitor)) {
    std::uint16_t kind = 0;
    std::int32_t value = 0;
    if (frames[0].size() < sizeof kind + sizeof value) continue;
    std::memcpy(&kind, frames[0].data(), sizeof kind);
    std::memcpy(&value, frames[0].data() + sizeof kind, sizeof value);
    return SocketEvent{kind, value};
  }
  return std::nullopt;
}

wire::Point toWire(const LatticePoint& point) {
  wire::Point message;
  message.set_i(point[0]);
  message.set_j(point[1]);
  message.set_k(point[2]);
  return message;
}

LatticePoint fromWire(const wire::Point& point) { return {point.i(), point.j(), point.k()}; }

void toWire(const Outcome& outcome, const std::string& fields_bytes, wire::Result& result) {
  toWire(outcome.cost, *result.mutable_cost());
  if (!outcome.converged()) {
    PALPATE_ASSERT(stopsTransitions(outcome.failure().cause),
                   "a transition cannot fail with this cause");
    return toWire(outcome.failure(), *result.mutable_failure());
  }
  PALPATE_ASSERT(!fields_bytes.empty(), "an equilibrium must have nodal fields");
  toWire(outcome.equilibrium(), *result.mutable_equilibrium());
  result.mutable_equilibrium()->set_residual(outcome.configuration().residual);
  result.set_fields_id(std::string(ContentId::of(fields_bytes).bytes()));
  result.set_payload_bytes(static_cast<std::uint32_t>(fields_bytes.size()));
}

std::optional<Outcome> fromWire(const wire::Result& result) {
  const Cost cost = fromWire(result.cost());
  if (result.has_equilibrium()) {
    const auto equilibrium = fromWire(result.equilibrium());
    if (!equilibrium || result.fields_id().size() != 32 || result.payload_bytes() == 0)
      return std::nullopt;
    return Outcome{Configuration{*equilibrium, result.equilibrium().residual(), {}}, cost};
  }
  if (!result.has_failure()) return std::nullopt;
  const auto failure = fromWire(result.failure());
  if (!failure || !stopsTransitions(failure->cause)) return std::nullopt;
  return Outcome{*failure, cost};
}

void toWire(const HandMotion& hand, wire::HandMotion& message) {
  setVector(hand.place, *message.mutable_place());
  setVector(hand.displacement, *message.mutable_displacement());
  setVector(hand.place_speed, *message.mutable_place_speed());
  setVector(hand.displacement_speed, *message.mutable_displacement_speed());
  if (hand.hold) toWire(*hand.hold, *message.mutable_hold());
}

std::optional<HandMotion> fromWire(const wire::HandMotion& message) {
  HandMotion hand;
  const bool valid = readMatrix(message.place(), hand.place) &&
                     readMatrix(message.displacement(), hand.displacement) &&
                     readMatrix(message.place_speed(), hand.place_speed) &&
                     readMatrix(message.displacement_speed(), hand.displacement_speed) &&
                     (!message.has_hold() || readHold(message.hold(), hand.hold.emplace()));
  return valid ? std::optional(hand) : std::nullopt;
}

void toWire(const Followed& followed, wire::Followed& message) {
  toWire(followed.cost, *message.mutable_cost());
  if (const auto* failure = std::get_if<Failure>(&followed.end))
    return toWire(*failure, *message.mutable_failure());
  const auto& expansion = std::get<Expansion>(followed.end);
  setVector(expansion.place, *message.mutable_place());
  setVector(expansion.displacement, *message.mutable_displacement());
  toWire(expansion.equilibrium, *message.mutable_equilibrium());
  if (!expansion.held) return;
  wire::Held& held = *message.mutable_held();
  toWire(expansion.held->at, *held.mutable_at());
  held.set_force(matrixBytes(expansion.held->force));
  held.set_stiffness(matrixBytes(expansion.held->stiffness));
  held.set_hand_by_hold(matrixBytes(expansion.held->hand_by_hold));
}

std::optional<Followed> fromWire(const wire::Followed& message) {
  const Cost cost = fromWire(message.cost());
  if (message.has_failure()) {
    const auto failure = fromWire(message.failure());
    return failure ? std::optional(Followed{*failure, cost}) : std::nullopt;
  }
  if (!message.has_equilibrium()) return std::nullopt;
  const auto equilibrium = fromWire(message.equilibrium());
  Expansion expansion;
  const bool valid = equilibrium && readMatrix(message.place(), expansion.place) &&
                     readMatrix(message.displacement(), expansion.displacement) &&
                     (!message.has_held() || readHeld(message.held(), expansion.held.emplace()));
  if (!valid) return std::nullopt;
  expansion.equilibrium = *equilibrium;
  return Followed{expansion, cost};
}

}  // namespace palpate
