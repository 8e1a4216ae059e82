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

/// Messages of proto/palpate.proto over ZeroMQ ROUTER and DEALER sockets. docs/wire.md tells who
/// says what when.
namespace palpate {

/// Raised with every incompatible change; Hello carries it and the scheduler refuses another one.
inline constexpr std::uint32_t protocol_version = 4;

/// So many messages of one connection wait in a ROUTER; then the others have to.
inline constexpr int router_queue_length = 16;

/// Payload frames are at most this long. libzmq takes memory for a frame when its length comes in,
/// so a ROUTER refuses longer frames than honest peers send.
inline constexpr std::size_t payload_frame_bytes = 64 * 1024;

/// A payload longer than this is refused on receipt (a mesh of 10 million nodes does not fit;
/// nothing we make comes near).
inline constexpr std::size_t max_payload_bytes = 512u << 20;

/// Calls ZeroMQ again when a signal came: it must not tear a message of several frames apart.
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

/// Where `serve` listens and `status`, `stop`, `work` connect when nothing is said.
inline constexpr const char* default_endpoint = "tcp://127.0.0.1:7411";

/// Whether nobody beyond this machine reaches what listens at `endpoint`.
bool isOnThisMachineOnly(const std::string& endpoint);

/// A message as it came in.
struct Incoming {
  std::string peer;  ///< routing id on a ROUTER, empty on a DEALER
  wire::Message message;
  std::string payload;  ///< the concatenated payload frames
  /// Whose key it came under; nothing where no keys are asked for (curve.hpp).
  std::optional<PublicKey> key = {};
  /// Why its sender may not say this; empty when it may. Nothing else of the message counts then.
  std::string refusal = {};
  int connection = -1;        ///< descriptor of the connection it came over
  std::size_t bytes = 0;      ///< message and payload
  bool reads_slowly = false;  ///< its sender has not read what it was sent: it gets nothing large
};

/// What became of a message we wanted to send. `unroutable`: the peer is gone. `full`: it does not
/// read; drop it or try again, but never block.
enum class Sent : std::uint8_t { yes, unroutable, full };

/// Sends without blocking. `peer` is the routing id on a ROUTER, empty on a DEALER. Error on any
/// other ZeroMQ failure.
[[nodiscard]] Sent sendMessage(zmq::socket_t& socket, std::string_view peer,
                               const wire::Message& message, std::string_view payload = {});

/// The same with a payload that is not copied: what peers do not read costs nothing. `until_sent`
/// is held until the system has the last frame, or the connection ends; on whatever thread.
[[nodiscard]] Sent sendMessage(zmq::socket_t& socket, std::string_view peer,
                               const wire::Message& message,
                               const std::shared_ptr<const std::string>& payload,
                               const std::shared_ptr<const void>& until_sent = nullptr);

/// The key under which a frame came through a ZapHandler (curve.hpp); nothing where there is none.
std::optional<PublicKey> senderOf(zmq::message_t& frame);

/// Whether this program knows all that the message says, but for what another version of it says of
/// itself; what it does not know is dropped. Of a bundle: less its messages, which are judged one
/// by one.
bool isReadable(wire::Message& message);

/// The next message without blocking, which may be a bundle: Inbox takes those apart. Nothing when
/// there is none. A message that does not parse or is not readable, has an empty body, or too large
/// a payload is returned with message.body_case() == BODY_NOT_SET: count it and drop it.
std::optional<Incoming> receiveMessage(zmq::socket_t& socket, bool router);

/// Sockets with the options that were measured to be needed (docs/wire.md, "Sockets").
zmq::socket_t makeRouter(zmq::context_t& context);
zmq::socket_t makeDealer(zmq::context_t& context);

/// Refuses everything but ipc://PATH and tcp://HOST:PORT (PORT may be * to listen on a free one).
/// Error (bad input).
void checkEndpoint(const std::string& endpoint);

/// Binds, and turns "address already in use" and the like into an Error that names the endpoint and
/// what to do; a socket file at which nobody listens any more is replaced. A host's name is looked
/// up, which may take seconds. Returns the endpoint with the host's address and the port that the
/// system chose (for tcp://localhost:*: tcp://127.0.0.1:40211).
std::string bindRouter(zmq::socket_t& socket, const std::string& endpoint);

/// Connects, in the background and again whenever the connection is lost, after it has looked the
/// host's name up, which may take seconds. Returns why the name is not found, empty when it is: it
/// may be later, for whoever waits. Error (bad input) when the endpoint makes no sense.
[[nodiscard]] std::string connectDealer(zmq::socket_t& socket, const std::string& endpoint);

/// Waits at most `longest` until a message is there, or the descriptor `wake_up` is readable. False
/// when a signal came first. Error on any other ZeroMQ failure.
bool waitForMessages(zmq::socket_t& socket, std::chrono::milliseconds longest, int wake_up = -1);

/// All frames of the next message without blocking; none when there is no message.
std::vector<std::string> receiveFrames(zmq::socket_t& socket);

/// The socket that tells events of these kinds (ZMQ_EVENT_...) of `socket`, which is not bound or
/// connected yet: what ZeroMQ does in its own threads. nextEvent() reads them.
zmq::socket_t monitorOf(zmq::context_t& context, zmq::socket_t& socket, int kinds);
struct SocketEvent {
  int kind;
  int value;  ///< a descriptor, where the kind has one
};
/// Without blocking; nothing when there is none.
std::optional<SocketEvent> nextEvent(zmq::socket_t& monitor);

/// Struct <-> message. The from... functions check meaning (sizes, finite numbers, known cause);
/// nothing when it is not valid.
wire::Point toWire(const LatticePoint& point);
LatticePoint fromWire(const wire::Point& point);
/// What a result, or its acknowledgement, is of.
template <class ResultOrAck>
ResultKey keyOf(const ResultOrAck& message) {
  return {message.space(), fromWire(message.target()), fromWire(message.parent())};
}
/// Fills outcome, cost, fields_id and payload_bytes of `result`.
void toWire(const Outcome& outcome, const std::string& fields_bytes, wire::Result& result);
/// Everything but `fields`, which the payload holds.
std::optional<Outcome> fromWire(const wire::Result& result);

}  // namespace palpate
