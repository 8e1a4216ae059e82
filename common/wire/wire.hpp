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
#include "common/space/following.hpp"
#include "common/space/result_key.hpp"
#include "proto/palpate.pb.h"

/// Messages of proto/palpate.proto over ZeroMQ ROUTER and DEALER sockets. docs/internals/wire.md
/// describes the protocol.
namespace palpate {

/// Version of the protocol, raised with every incompatible change. A peer's first message, Hello,
/// contains it, and the scheduler refuses peers with another version.
inline constexpr std::uint32_t protocol_version = 5;

/// Largest number of messages from one connection that wait in a ROUTER. Further messages wait at
/// the peer.
inline constexpr int router_queue_length = 16;

/// Largest payload frame, bytes. libzmq allocates a frame as soon as its length arrives, so a
/// ROUTER refuses frames longer than honest peers send.
inline constexpr std::size_t payload_frame_bytes = 64 * 1024;

/// Largest payload, bytes; receiveMessage() refuses larger ones. A mesh of 10 million nodes would
/// exceed this limit, but meshes in practice are far smaller.
inline constexpr std::size_t max_payload_bytes = 512u << 20;

/// Makes the ZeroMQ call `call` and repeats it if a signal interrupts it, so that messages of
/// several frames stay complete. Returns its result.
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
  /// Reason why the sender is not allowed to send this message; empty if it is allowed. If this is
  /// set, ignore the message and its payload.
  std::string refusal = {};
  int connection = -1;        ///< descriptor of the connection; -1 on a DEALER
  std::size_t bytes = 0;      ///< size of message and payload
  bool reads_slowly = false;  ///< the sender's receive backlog is full; send it no payloads
};

/// Result of sending. `unroutable` means that the peer is gone. `full` means that the peer does not
/// read its messages: drop the message or try again later, but never block.
enum class Sent : std::uint8_t { yes, unroutable, full };

/// Sends without blocking. `peer` is the routing id on a ROUTER, empty on a DEALER. Error on ZeroMQ
/// failures for which Sent has no value.
[[nodiscard]] Sent sendMessage(zmq::socket_t& socket, std::string_view peer,
                               const wire::Message& message, std::string_view payload = {});

/// Sends a message that is encoded already.
[[nodiscard]] Sent sendBytes(zmq::socket_t& socket, std::string_view peer, std::string_view bytes);

/// Sends a payload without copying it, so that messages for a peer that does not read take no
/// further memory. `payload` and `until_sent` are kept alive until the system has taken the last
/// frame, or the connection ends. Any thread may destroy the last reference.
[[nodiscard]] Sent sendMessage(zmq::socket_t& socket, std::string_view peer,
                               const wire::Message& message,
                               const std::shared_ptr<const std::string>& payload,
                               const std::shared_ptr<const void>& until_sent = nullptr);

/// Returns the key with which a ZapHandler (curve.hpp) authenticated the sender of a frame; nullopt
/// without a ZapHandler.
std::optional<PublicKey> senderOf(zmq::message_t& frame);

/// Returns whether this program knows all fields of the message, and removes unknown fields. Hello
/// and Refused are always readable and keep unknown fields, because programs of other versions send
/// them. If the message is a bundle, only the bundle's own fields are checked; unbundled() checks
/// the messages in it.
bool isReadable(wire::Message& message);

/// Returns the next message without blocking, or nullopt. The message may be a bundle; Inbox splits
/// bundles. If a message cannot be parsed, is not readable (isReadable), has no body or too large a
/// payload, its body_case() is BODY_NOT_SET; count such messages and drop them.
std::optional<Incoming> receiveMessage(zmq::socket_t& socket, bool router);

/// Make sockets with the options that measurements showed to be necessary (docs/internals/wire.md,
/// "Sockets").
zmq::socket_t makeRouter(zmq::context_t& context);
zmq::socket_t makeDealer(zmq::context_t& context);

/// Error (bad input) unless the endpoint is ipc://PATH or tcp://HOST:PORT. PORT may be * to listen
/// on a free port.
void checkEndpoint(const std::string& endpoint);

/// Binds the socket to an endpoint. Resolves the host name first, which may take seconds. Replaces
/// a socket file at which no process listens. Returns the endpoint with the host's address and the
/// actual port, such as tcp://127.0.0.1:40211 for tcp://localhost:*. Error with the endpoint and a
/// remedy if that fails, for example because the address is in use.
std::string bindRouter(zmq::socket_t& socket, const std::string& endpoint);

/// Makes ZeroMQ connect to an endpoint in the background, and reconnect whenever the connection is
/// lost. Resolves the host name first, which may take seconds. If the host name cannot be resolved,
/// returns the reason, else an empty string. The failure may be temporary: ZeroMQ resolves the name
/// again whenever it tries to connect. Error (bad input) for an invalid endpoint.
[[nodiscard]] std::string connectDealer(zmq::socket_t& socket, const std::string& endpoint);

/// Waits until a message arrives or the descriptor `wake_up` is readable, but no longer than
/// `longest`. Returns false if a signal interrupted it. Error on any other ZeroMQ failure.
bool waitForMessages(zmq::socket_t& socket, std::chrono::milliseconds longest, int wake_up = -1);

/// Returns all frames of the next message without blocking; empty if there is no message.
std::vector<std::string> receiveFrames(zmq::socket_t& socket);

/// Returns a socket from which nextEvent() reads the events of these kinds (ZMQ_EVENT_...) that
/// happen on `socket`. `socket` must not be bound or connected yet. The events come from ZeroMQ's
/// own threads.
zmq::socket_t monitorOf(zmq::context_t& context, zmq::socket_t& socket, int kinds);
struct SocketEvent {
  int kind;
  int value;  ///< a file descriptor for some kinds
};
/// Returns the next event without blocking, or nullopt.
std::optional<SocketEvent> nextEvent(zmq::socket_t& monitor);

/// Conversions between structs and messages. fromWire(wire::Result) returns nullopt if the message
/// is invalid (wrong sizes, numbers that are not finite, an unknown cause).
wire::Point toWire(const LatticePoint& point);
LatticePoint fromWire(const wire::Point& point);
/// Returns the key of a result, or of the acknowledgement of a result.
template <class ResultOrAck>
ResultKey keyOf(const ResultOrAck& message) {
  return {message.space(), fromWire(message.target()), fromWire(message.parent())};
}
/// Sets the outcome, cost, fields_id and payload_bytes of `result`. `fields_bytes` is the encoded
/// NodalFields, which are sent as the payload.
void toWire(const Outcome& outcome, const std::string& fields_bytes, wire::Result& result);
/// Returns the outcome without its `fields`, which are in the payload.
std::optional<Outcome> fromWire(const wire::Result& result);
void toWire(const HandMotion& hand, wire::HandMotion& message);
std::optional<HandMotion> fromWire(const wire::HandMotion& message);
void toWire(const Followed& followed, wire::Followed& message);
std::optional<Followed> fromWire(const wire::Followed& message);

}  // namespace palpate
