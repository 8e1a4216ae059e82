#pragma once

#include <cerrno>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>
#include <zmq.hpp>

#include "common/keys/key_pair.hpp"
#include "common/space/configuration.hpp"
#include "common/space/result_key.hpp"
#include "proto/palpate.pb.h"

/// Messages of proto/palpate.proto over ZeroMQ ROUTER and DEALER sockets. docs/wire.md describes
/// the protocol.
namespace palpate {

/// Raised with every incompatible change. Hello carries it, and the scheduler refuses other
/// versions.
inline constexpr std::uint32_t protocol_version = 4;

/// Largest number of messages of one connection that wait in a ROUTER. Further ones wait at the
/// peer.
inline constexpr int router_queue_length = 16;

/// Largest payload frame. libzmq allocates a frame as soon as its length arrives, so a ROUTER
/// refuses frames longer than honest peers send.
inline constexpr std::size_t payload_frame_bytes = 64 * 1024;

/// Largest payload; longer ones are refused on receipt. A mesh of 10 million nodes does not fit;
/// nothing in practice comes near.
inline constexpr std::size_t max_payload_bytes = 512u << 20;

/// Repeats a ZeroMQ call that a signal interrupted, so that multi-frame messages stay complete.
template <class Call>
auto repeatWhenInterrupted(Call call) {
  for (;;) {
    try {
      return call();
    } catch (const zmq::error_t& error) {
      if (error.num() != EINTR) throw;
    }
  }
}

/// Default endpoint of `serve`, `status`, `stop` and `work`.
inline constexpr const char* default_endpoint = "tcp://127.0.0.1:7411";

/// Returns whether an endpoint is reachable only from this machine.
bool isOnThisMachineOnly(const std::string& endpoint);

/// A received message.
struct Incoming {
  std::string peer;  ///< routing id on a ROUTER, empty on a DEALER
  wire::Message message;
  std::string payload;  ///< the concatenated payload frames
  /// Key of the sender; nullopt if no keys are used (curve.hpp).
  std::optional<PublicKey> key = {};
  /// Reason why the sender may not send this message; empty if it may. If set, ignore the rest of
  /// the message.
  std::string refusal = {};
  int connection = -1;        ///< descriptor of its connection
  std::size_t bytes = 0;      ///< message and payload
  bool reads_slowly = false;  ///< the sender's receive backlog is full; send it no payloads
};

/// Result of sending. `unroutable`: the peer is gone. `full`: it does not read; drop the message or
/// try again later, but never block.
enum class Sent : std::uint8_t { yes, unroutable, full };

/// Sends without blocking. `peer` is the routing id on a ROUTER, empty on a DEALER. Error on any
/// other ZeroMQ failure.
[[nodiscard]] Sent sendMessage(zmq::socket_t& socket, std::string_view peer,
                               const wire::Message& message, std::string_view payload = {});

/// Sends a payload without copying it, so that peers that do not read cost no memory. `until_sent`
/// is held until the system has taken the last frame or the connection ends; any thread may release
/// it.
[[nodiscard]] Sent sendMessage(zmq::socket_t& socket, std::string_view peer,
                               const wire::Message& message,
                               const std::shared_ptr<const std::string>& payload,
                               const std::shared_ptr<const void>& until_sent = nullptr);

/// Returns the key under which a frame passed a ZapHandler (curve.hpp), or nullopt.
std::optional<PublicKey> senderOf(zmq::message_t& frame);

/// Returns whether this program knows all fields of the message, and drops unknown ones. Hello and
/// Refused are always readable and keep them, since other versions send them. For a bundle only its
/// own fields are checked; its messages are judged one by one.
bool isReadable(wire::Message& message);

/// Returns the next message without blocking, or nullopt. It may be a bundle, which Inbox takes
/// apart. A message that does not parse, is not readable, has an empty body or too large a payload
/// has message.body_case() == BODY_NOT_SET; count and drop it.
std::optional<Incoming> receiveMessage(zmq::socket_t& socket, bool router);

/// Make sockets with options that measurements showed to be necessary (docs/wire.md, "Sockets").
zmq::socket_t makeRouter(zmq::context_t& context);
zmq::socket_t makeDealer(zmq::context_t& context);

/// Error (bad input) unless the endpoint is ipc://PATH or tcp://HOST:PORT. PORT may be * to listen
/// on a free port.
void checkEndpoint(const std::string& endpoint);

/// Binds the socket. Failures such as "address already in use" become an Error with the endpoint
/// and a remedy. A socket file without a listener is replaced. The host name is resolved, which may
/// take seconds. Returns the endpoint with the host's address and the port that the system chose
/// (for tcp://localhost:*: tcp://127.0.0.1:40211).
std::string bindRouter(zmq::socket_t& socket, const std::string& endpoint);

/// Connects in the background, and again whenever the connection is lost. The host name is resolved
/// first, which may take seconds. Returns why the name cannot be resolved, or an empty text; it may
/// resolve later if the caller waits. Error (bad input) for an invalid endpoint.
[[nodiscard]] std::string connectDealer(zmq::socket_t& socket, const std::string& endpoint);

/// Waits at most `longest` until a message arrives or the descriptor `wake_up` is readable. Returns
/// false if a signal came first. Error on any other ZeroMQ failure.
bool waitForMessages(zmq::socket_t& socket, std::chrono::milliseconds longest, int wake_up = -1);

/// Returns all frames of the next message without blocking; empty if there is no message.
std::vector<std::string> receiveFrames(zmq::socket_t& socket);

/// Returns a socket that reports events of these kinds (ZMQ_EVENT_...) of `socket`, which must not
/// be bound or connected yet. ZeroMQ causes them in its own threads. Read them with nextEvent().
zmq::socket_t monitorOf(zmq::context_t& context, zmq::socket_t& socket, int kinds);
struct SocketEvent {
  int kind;
  int value;  ///< a descriptor for some kinds
};
/// Returns the next event without blocking, or nullopt.
std::optional<SocketEvent> nextEvent(zmq::socket_t& monitor);

/// Conversions between structs and messages. fromWire(wire::Result) checks validity (sizes, finite
/// numbers, known cause) and returns nullopt for an invalid message.
wire::Point toWire(const LatticePoint& point);
LatticePoint fromWire(const wire::Point& point);
/// Returns the key of a result or its acknowledgement.
template <class ResultOrAck>
ResultKey keyOf(const ResultOrAck& message) {
  return {message.space(), fromWire(message.target()), fromWire(message.parent())};
}
/// Fills outcome, cost, fields_id and payload_bytes of `result`.
void toWire(const Outcome& outcome, const std::string& fields_bytes, wire::Result& result);
/// Returns everything but `fields`, which the payload holds.
std::optional<Outcome> fromWire(const wire::Result& result);

}  // namespace palpate
