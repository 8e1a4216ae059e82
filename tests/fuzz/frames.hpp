#pragma once

#include <zmq.hpp>

#include "tests/fuzz/fuzzer.hpp"

namespace palpate::fuzz {

/// Two sockets in this process, for messages that nobody of ours would send.
class SocketPair {
 public:
  SocketPair()
      : sender_(context_, zmq::socket_type::pair), receiver_(context_, zmq::socket_type::pair) {
    receiver_.bind("inproc://fuzzed");
    sender_.connect("inproc://fuzzed");
  }

  /// One message, of as many frames as the input has: up to 64, which wait without a limit.
  void send(Choices& choices) {
    bool more = true;
    for (int frames = 1; more; ++frames) {
      const std::string_view frame = choices.takeBytes();
      more = frames < 64 && !choices.done();
      if (!sender_.send(zmq::buffer(frame),
                        more ? zmq::send_flags::sndmore : zmq::send_flags::none))
        throw failure("a frame was not taken");
    }
  }
  zmq::socket_t& receiver() { return receiver_; }

 private:
  zmq::context_t context_{0};  // nothing leaves this process: no thread is needed
  zmq::socket_t sender_, receiver_;
};

}  // namespace palpate::fuzz
