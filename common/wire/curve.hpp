#pragma once

#include <string>
#include <thread>
#include <zmq.hpp>

#include "common/base/file_descriptor.hpp"
#include "common/keys/key_folder.hpp"

// Keys on sockets. CURVE (rfc.zeromq.org/spec/26) authenticates both sides and encrypts the
// messages. ZAP (rfc.zeromq.org/spec/27) decides whether a client is admitted.

namespace palpate {

/// Sets the keys of a socket that will connect to a server with the key `server`.
void proveAsClient(zmq::socket_t& socket, const KeyPair& own, const PublicKey& server);
/// Sets the keys that `keys` holds for `endpoint`. For an endpoint on this machine, a missing own
/// key is made, as a server does. Error (bad input) for an invalid endpoint. A missing key is also
/// an Error for other machines, because their servers could not know a new one.
void proveAsClient(zmq::socket_t& socket, const KeyFolder& keys, const std::string& endpoint);

/// Authenticates the clients of a server that will be bound. Only clients that know its key and are
/// admitted get through; their messages carry their keys (senderOf). A separate thread answers ZAP
/// requests for connecting clients. One per context; destroy after the socket.
class ZapHandler {
 public:
  /// `socket` belongs to `context` and is not bound yet. Makes the own key if there is none. Error
  /// (bad input) if the keys cannot be read.
  ZapHandler(zmq::context_t& context, zmq::socket_t& socket, const KeyFolder& keys);
  ~ZapHandler();
  ZapHandler(const ZapHandler&) = delete;
  ZapHandler& operator=(const ZapHandler&) = delete;

  /// Returns the current roles of the sender of a message; none if its key was withdrawn after it
  /// connected. Call from the thread of the socket.
  Roles rolesOf(const std::optional<PublicKey>& sender);

 private:
  void answer();

  zmq::socket_t questions_;
  Admission admission_;
  FileDescriptor wake_up_;
  std::jthread thread_;  ///< last, so that it ends before the members it uses
};

/// Finds out why a client cannot connect to its server. ZeroMQ does not report it and retries
/// silently. One thread.
class HandshakeWatch {
 public:
  /// Call before `socket` connects.
  HandshakeWatch(zmq::context_t& context, zmq::socket_t& socket);

  /// Returns the last failure since the previous call, as a clause with a remedy; empty if there
  /// was none.
  std::string trouble();

 private:
  zmq::socket_t events_;
};

}  // namespace palpate
