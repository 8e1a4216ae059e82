#include "common/wire/curve.hpp"

#include <sys/eventfd.h>
#include <zmq.h>

#include "common/base/error.hpp"
#include "common/wire/wire.hpp"

namespace palpate {
namespace {

/// Endpoint to which ZeroMQ sends its admission requests. Without a handler there, ZeroMQ would
/// admit every client, and messages would not carry the key of their sender.
constexpr const char* zap_endpoint = "inproc://zeromq.zap.01";

void setOption(zmq::socket_t& socket, int option, const void* value, std::size_t bytes) {
  if (zmq_setsockopt(socket.handle(), option, value, bytes) != 0)
    throw failure("ZeroMQ does not accept keys: {} (is libzmq built without CURVE?)",
                  zmq_strerror(zmq_errno()));
}

void setKey(zmq::socket_t& socket, int option, const Bytes32& key) {
  setOption(socket, option, key.data(), key.size());
}

void sendFrames(zmq::socket_t& socket, const std::vector<std::string>& frames) {
  for (std::size_t n = 0; n < frames.size(); ++n)
    repeatWhenInterrupted([&] {
      return socket.send(zmq::buffer(frames[n]),
                         n + 1 < frames.size() ? zmq::send_flags::sndmore : zmq::send_flags::none);
    });
}

}  // namespace

void proveAsClient(zmq::socket_t& socket, const KeyPair& own, const PublicKey& server) {
  setKey(socket, ZMQ_CURVE_SERVERKEY, server);
  setKey(socket, ZMQ_CURVE_PUBLICKEY, own.open());
  setKey(socket, ZMQ_CURVE_SECRETKEY, own.secret());
}

void proveAsClient(zmq::socket_t& socket, const KeyFolder& keys, const std::string& endpoint) {
  checkEndpoint(endpoint);
  const KeyPair own = isOnThisMachineOnly(endpoint) ? keys.ownOrNew() : keys.own();
  proveAsClient(socket, own, keys.serverAt(endpoint));
}

ZapHandler::ZapHandler(zmq::context_t& context, zmq::socket_t& socket, const KeyFolder& keys)
    : questions_(context, zmq::socket_type::rep),
      admission_(keys),
      wake_up_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  if (!wake_up_) throw failure("eventfd failed: {}", errnoText());
  socket.set(zmq::sockopt::curve_server, true);
  setKey(socket, ZMQ_CURVE_SECRETKEY, keys.own().secret());
  constexpr std::string_view domain = "palpate";
  setOption(socket, ZMQ_ZAP_DOMAIN, domain.data(), domain.size());
  questions_.set(zmq::sockopt::linger, 0);
  questions_.bind(zap_endpoint);
  thread_ = std::jthread([this](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      waitForMessages(questions_, std::chrono::milliseconds(1000), wake_up_.get());
      answer();
    }
  });
}

ZapHandler::~ZapHandler() {
  thread_.request_stop();
  // If the write fails, the thread notices the stop request within a second.
  eventfd_write(wake_up_.get(), 1);
  thread_.join();
  // Unbind now, so that the endpoint is free at once; closing the socket frees it a moment later.
  zmq_unbind(questions_.handle(), zap_endpoint);
}

void ZapHandler::answer() {
  // The frames are version, request id, domain, address, identity, mechanism, credentials.
  const std::vector<std::string> request = receiveFrames(questions_);
  if (request.empty()) return;
  const auto key = request.size() == 7 && request[5] == "CURVE" ? PublicKey::fromBytes(request[6])
                                                                : std::nullopt;
  const bool admitted = key && admission_.rolesOf(*key) != Roles::none;
  sendFrames(questions_, {"1.0", request.size() > 1 ? request[1] : "", admitted ? "200" : "400",
                          admitted ? "" : "not admitted", admitted ? key->hex() : "", ""});
}

Roles ZapHandler::rolesOf(const std::optional<PublicKey>& sender) {
  return sender ? admission_.rolesOf(*sender) : Roles::none;
}

HandshakeWatch::HandshakeWatch(zmq::context_t& context, zmq::socket_t& socket)
    : events_(monitorOf(context, socket,
                        ZMQ_EVENT_HANDSHAKE_FAILED_NO_DETAIL | ZMQ_EVENT_HANDSHAKE_FAILED_PROTOCOL |
                            ZMQ_EVENT_HANDSHAKE_FAILED_AUTH)) {}

std::string HandshakeWatch::trouble() {
  std::string newest;
  while (const auto event = nextEvent(events_)) {
    switch (event->kind) {
      case ZMQ_EVENT_HANDSHAKE_FAILED_AUTH:
        newest =
            "it does not admit this key (print the key with palpate key show, and admit it there "
            "with palpate key allow)";
        break;
      case ZMQ_EVENT_HANDSHAKE_FAILED_PROTOCOL:
        newest = "one side uses keys and the other does not (--insecure)";
        break;
      default:
        newest =
            "its key differs from the one known here (print it there with palpate key show, accept "
            "it here with palpate key trust), it uses no keys (--insecure), or it has just ended";
    }
  }
  return newest;
}

}  // namespace palpate
