#pragma once

#include <string>
#include <thread>
#include <zmq.hpp>

#include "common/base/file_descriptor.hpp"
#include "common/keys/key_folder.hpp"

// Keys on sockets: CURVE (rfc.zeromq.org/spec/26) proves both sides to each other and encrypts what
// they say; ZAP (rfc.zeromq.org/spec/27) asks whether a client is let in.

namespace palpate {

/// For a socket that will be connected, to a server with the key `server`.
void proveAsClient(zmq::socket_t& socket, const KeyPair& own, const PublicKey& server);
/// The same as the keys of a user have it for `endpoint`. On this machine a key is made when there
/// is none, as a server does; Error (bad input) elsewhere, where nobody could know it, and for an
/// endpoint that makes no sense.
void proveAsClient(zmq::socket_t& socket, const KeyFolder& keys, const std::string& endpoint);

/// Of a server that will be bound: only clients that know its key, and that it lets in, get
/// through; their messages carry their keys (senderOf). A thread of its own answers whether a
/// client that connects is let in. One per context; to go after the socket.
class ZapHandler {
 public:
  /// For `socket` of `context`, which is not bound yet. Makes the own key when there is none. Error
  /// (bad input) when the keys cannot be read.
  ZapHandler(zmq::context_t& context, zmq::socket_t& socket, const KeyFolder& keys);
  ~ZapHandler();
  ZapHandler(const ZapHandler&) = delete;
  ZapHandler& operator=(const ZapHandler&) = delete;

  /// What the sender of a message may do now; nothing when its key was withdrawn since it
  /// connected. For the thread of the socket.
  Roles rolesOf(const std::optional<PublicKey>& sender);

 private:
  void answer();

  zmq::socket_t questions_;
  Admission admission_;
  FileDescriptor wake_up_;
  std::jthread thread_;  ///< the last member: it ends before what it uses goes
};

/// Why a client does not get through to its server, which ZeroMQ keeps to itself: it tries again
/// and again. One thread.
class HandshakeWatch {
 public:
  /// Before `socket` is connected.
  HandshakeWatch(zmq::context_t& context, zmq::socket_t& socket);

  /// What failed last since the last call, as a clause that says what to do; empty when nothing
  /// did.
  std::string trouble();

 private:
  zmq::socket_t events_;
};

}  // namespace palpate
