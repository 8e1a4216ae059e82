#pragma once

#include <zmq.hpp>

#include "tests/fuzz/fuzzer.hpp"

namespace palpate::fuzz {

/// Two connected sockets in this process, for messages that the programs never send.
class SocketPair {
 public:
  SocketPair()
      : sender_(context_, zmq::socket_type::pair), receiver_(context_, zmq::socket_type::pair) {
    receiver_.bind("inproc://fuzzed");
    sender_.connect("inproc://fuzzed");
  }

  /// Sends all frames of the input as one message, at most 64. The queue has no limit.
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
  zmq::context_t context_{0};  // messages stay in this process, so no thread is needed
  zmq::socket_t sender_, receiver_;
};

}  // namespace palpate::fuzz
