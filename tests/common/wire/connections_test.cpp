#include "common/wire/connections.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <functional>
#include <thread>

#include "common/base/file_descriptor.hpp"
#include "common/wire/wire.hpp"

namespace palpate {
namespace {

using namespace std::chrono_literals;

/// A ROUTER under watch, and peers that connect to it from addresses of this machine.
struct ConnectionsTest : testing::Test {
  zmq::context_t context, peers_context;
  zmq::socket_t router = makeRouter(context);
  std::optional<Connections> connections;
  std::string port;

  void watch(const PeerLimits& limits) {
    connections.emplace(context, router, limits);
    const std::string endpoint = bindRouter(router, "tcp://127.0.0.1:*");
    port = endpoint.substr(endpoint.rfind(':') + 1);
  }
  /// Peers end before the router closes connections. ZeroMQ 4.3.4 aborts if a connection breaks in
  /// the middle of a message in a closed socket whose LINGER is over (zeromq/libzmq, issue 3442). A
  /// peer that ends just when it is shut out would cause that.
  void TearDown() override {
    connections.reset();
    peers_context.close();
  }

  zmq::socket_t makePeer() {
    zmq::socket_t socket(peers_context, zmq::socket_type::dealer);
    socket.set(zmq::sockopt::linger, 200);
    return socket;
  }
  zmq::socket_t connectFrom(const std::string& address) {
    zmq::socket_t socket = makePeer();
    socket.connect("tcp://" + address + ":0;127.0.0.1:" + port);
    return socket;
  }
  static bool sendFrame(zmq::socket_t& socket, std::size_t bytes, bool more) {
    const std::string frame(bytes, 'x');
    return socket
        .send(zmq::buffer(frame),
              zmq::send_flags::dontwait | (more ? zmq::send_flags::sndmore : zmq::send_flags::none))
        .has_value();
  }
  static void say(zmq::socket_t& socket) {
    wire::Message message;
    message.mutable_status_request();
    ASSERT_EQ(sendMessage(socket, "", message), Sent::yes);
  }
  /// Receives a message as a server does.
  std::optional<Incoming> receive() {
    auto incoming = receiveMessage(router, true);
    if (incoming && !connections->received(incoming->connection, incoming->bytes))
      return std::nullopt;
    return incoming;
  }
  std::optional<Incoming> await() {
    for (int n = 0; n < 2000; ++n) {
      if (auto incoming = receive()) return incoming;
      std::this_thread::sleep_for(1ms);
    }
    return std::nullopt;
  }
  /// The first line about a closed connection.
  std::string closedWhile(const std::function<void()>& step) {
    for (int n = 0; n < 4000; ++n) {
      step();
      receive();
      const Connections::Closed closed = connections->takeClosed();
      if (closed.count > 0) return fmt::format("{}", fmt::join(closed.why, "\n"));
      std::this_thread::sleep_for(1ms);
    }
    return "none";
  }
};

constexpr PeerLimits small = {.message_bytes = 1 << 20};

TEST_F(ConnectionsTest, ASenderOfALongMessageIsClosed) {
  watch(small);
  zmq::socket_t peer = connectFrom("127.0.0.1");
  for (int n = 0; n < 40; ++n) sendFrame(peer, 50000, n < 39);
  const std::string why = closedWhile([] {});
  EXPECT_EQ(why,
            "a connection from 127.0.0.1 was closed: its message of 2000000 bytes is too large");
}

/// ZeroMQ closes a descriptor in its own thread, and a new connection may then get it.
TEST_F(ConnectionsTest, AConnectionWithTheDescriptorOfAClosedOneIsKept) {
  watch(small);
  const auto makePair = [] {
    std::array<int, 2> both = {-1, -1};
    EXPECT_EQ(socketpair(AF_UNIX, SOCK_STREAM, 0, both.data()), 0);
    return std::pair(FileDescriptor(both[0]), FileDescriptor(both[1]));
  };
  const auto [first, peer_of_first] = makePair();
  const auto [second, peer_of_second] = makePair();
  char byte = 0;
  EXPECT_FALSE(connections->received(first.get(), small.message_bytes + 1));
  EXPECT_EQ(recv(peer_of_first.get(), &byte, 1, MSG_DONTWAIT), 0) << "its end is seen";
  EXPECT_FALSE(connections->received(first.get(), 1)) << "its late messages are ignored";

  ASSERT_EQ(dup2(second.get(), first.get()), first.get());
  EXPECT_TRUE(connections->received(first.get(), 1));
  EXPECT_EQ(::send(first.get(), "x", 1, MSG_NOSIGNAL), 1) << "it is still open";
  EXPECT_EQ(connections->takeClosed().count, 1);
}

TEST_F(ConnectionsTest, SendersWhoseMessagesEndAreKept) {
  watch(small);
  zmq::socket_t honest = connectFrom("127.0.0.1");
  for (int n = 0; n < 200; ++n) {  // 20 MB
    wire::Message message;
    message.mutable_result();
    ASSERT_EQ(sendMessage(honest, "", message, std::string(100000, 'x')), Sent::yes);
    const auto incoming = await();
    ASSERT_TRUE(incoming);
    EXPECT_EQ(incoming->payload.size(), 100000u);
    EXPECT_GT(incoming->bytes, 100000u);
  }
  std::this_thread::sleep_for(100ms);
  EXPECT_EQ(connections->takeClosed().count, 0);
}

TEST_F(ConnectionsTest, SomeSilentConnectionsAreKept) {
  PeerLimits limits = small;
  limits.silent = 2;
  watch(limits);
  std::vector<zmq::socket_t> silent;
  for (int n = 0; n < 4; ++n) silent.push_back(connectFrom("127.0.0.2"));
  EXPECT_THAT(closedWhile([] {}), testing::HasSubstr("from 127.0.0.2 was closed: it sent nothing"));
}

TEST_F(ConnectionsTest, AboveTheLimitTheLongestSilentAreClosed) {
  PeerLimits limits = small;
  limits.connections = 3;
  watch(limits);
  std::vector<zmq::socket_t> silent;
  for (int n = 0; n < 3; ++n) silent.push_back(connectFrom("127.0.0.2"));
  std::this_thread::sleep_for(200ms);
  zmq::socket_t talks = connectFrom("127.0.0.1");
  const std::string why = closedWhile([&] { say(talks); });
  EXPECT_EQ(
      why,
      "a connection from 127.0.0.2 was closed: it sent nothing, and there are 3 other connections");
  say(talks);
  EXPECT_TRUE(await());
}

TEST_F(ConnectionsTest, ASenderOfTooManySmallMessagesIsClosed) {
  PeerLimits limits = small;
  limits.messages_per_second = 500;
  watch(limits);
  zmq::socket_t peer = connectFrom("127.0.0.1");
  const std::string why = closedWhile([&] {
    for (int n = 0; n < 50; ++n) sendFrame(peer, 10, false);
    for (int n = 0; n < 50; ++n) receive();
  });
  EXPECT_NE(why.find("more than 500 messages per second"), std::string::npos) << why;
}

}  // namespace
}  // namespace palpate
