#pragma once

#include <string>
#include <thread>
#include <zmq.hpp>

#include "common/base/file_descriptor.hpp"
#include "common/keys/key_folder.hpp"

// Keys on sockets. CURVE (rfc.zeromq.org/spec/26) authenticates both sides and encrypts the
// messages. ZAP (rfc.zeromq.org/spec/27) decides whether a client is admitted.

namespace palpate {

/// Sets the keys of a client's socket: its own key pair and the key of its server.
void proveAsClient(zmq::socket_t& socket, const KeyPair& own, const PublicKey& server);
/// Sets the keys of a client's socket for a server at `endpoint`, from `keys`. If this user has no
/// key and the endpoint is on this machine, makes one, as a server does. If the endpoint is on
/// another machine, a missing key is an Error, because the server could not know a new key. Error
/// (bad input) for an invalid endpoint.
void proveAsClient(zmq::socket_t& socket, const KeyFolder& keys, const std::string& endpoint);

/// Authenticates the clients of a server's socket. Only messages of clients that know the server's
/// key and are admitted reach the socket; senderOf() returns the key of the sender. ZeroMQ asks a
/// separate thread of this object whether to admit a client (ZAP requests). Make at most one per
/// context, and destroy it after the socket.
class ZapHandler {
 public:
  /// `socket` must belong to `context` and must not be bound yet. Makes this user's key if there is
  /// none. Error (bad input) if the keys cannot be read.
  ZapHandler(zmq::context_t& context, zmq::socket_t& socket, const KeyFolder& keys);
  ~ZapHandler();

  /// Returns the current roles of a sender; Roles::none if its key was withdrawn after it had
  /// connected. Call from the thread of the socket.
  Roles rolesOf(const std::optional<PublicKey>& sender);

 private:
  void answer();

  zmq::socket_t questions_;
  Admission admission_;
  FileDescriptor wake_up_;
  std::jthread thread_;  ///< last, so that it ends before the other members are destroyed
};

/// Finds out why a client cannot connect to its server, because ZeroMQ retries silently without
/// giving a reason. One thread.
class HandshakeWatch {
 public:
  /// Call before `socket` connects.
  HandshakeWatch(zmq::context_t& context, zmq::socket_t& socket);

  /// Describes the latest failure to connect since the previous call, as a clause with a remedy;
  /// empty if there was none.
  std::string trouble();

 private:
  zmq::socket_t events_;
};

}  // namespace palpate
