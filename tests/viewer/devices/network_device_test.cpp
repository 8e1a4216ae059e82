#include "viewer/devices/network_device.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <thread>

#include "tests/support/expect_error.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/viewer/devices/polling.hpp"
#include "tests/viewer/devices/real_time_threads.hpp"
#include "tests/viewer/devices/stalling_relay.hpp"
#include "tests/viewer/devices/tray_device.hpp"
#include "viewer/devices/device_server.hpp"
#include "viewer/haptics/real_time.hpp"

namespace palpate {
namespace {

using namespace std::chrono_literals;
using test::eventually;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A local device and a client to which it is lent.
class NetworkDeviceTest : public ::testing::Test {
 protected:
  void serve() { server = std::make_unique<DeviceServer>(tray, endpoint); }
  void connect() {
    endpoint = server->endpoint();
    device =
        std::make_unique<NetworkDevice>(NetworkDeviceOptions{.endpoint = endpoint, .wait = 20s});
  }
  void SetUp() override {
    serve();
    connect();
  }
  /// One tick of a client that pushes with `force`.
  DeviceReading tick(const Eigen::Vector3d& force = Eigen::Vector3d::Zero()) {
    DeviceReading reading = device->read();
    device->write(force);
    return reading;
  }
  bool becomes(DeviceStatus status) {
    return eventually([&] { return tick().status == status; });
  }

  test::TrayDevice tray;
  std::string endpoint = "tcp://127.0.0.1:*";
  std::unique_ptr<DeviceServer> server;
  std::unique_ptr<NetworkDevice> device;
};

TEST_F(NetworkDeviceTest, HasTheLimitsOfTheRemoteDevice) {
  EXPECT_EQ(device->profile().max_force, 2);
  EXPECT_EQ(device->profile().max_stiffness, 500);
  EXPECT_EQ(device->profile().workspace_radius, 0.06);
  EXPECT_FALSE(device->livesInScene());
  EXPECT_TRUE(device->hasButtons());
  EXPECT_THAT(device->name(), HasSubstr("tray"));
}

TEST_F(NetworkDeviceTest, IsLentOnlyToOperatorsWithAKey) {
  const test::TemporaryDirectory directory;
  const KeyFolder here(directory / "here"), there(directory / "there");
  there.ownOrNew();
  server.reset();
  here.allow({there.ownOrNew().open(), rolesOf("worker,observer"), "there"});
  DeviceServer lent(tray, "tcp://127.0.0.1:*", 1000, here);
  there.trust(here.own().open(), "*");
  {
    NetworkDevice refused({.endpoint = lent.endpoint(), .keys = there, .wait = 1ms});
    EXPECT_TRUE(eventually([&] {
      return refused.trouble().find("KEY operator") != std::string::npos;
    })) << refused.trouble();
    EXPECT_FALSE(lent.state().held);
    here.allow({there.own().open(), rolesOf("operator"), "there"});
    EXPECT_TRUE(eventually([&] { return lent.state().held; })) << refused.trouble();
    here.withdraw("there");
    EXPECT_TRUE(eventually([&] { return !lent.state().held; })) << "within a second";
  }
  NetworkDevice stranger({.endpoint = lent.endpoint(), .wait = 1ms});
  EXPECT_TRUE(eventually([&] {
    return stranger.trouble().find("--insecure") != std::string::npos;
  })) << stranger.trouble();
}

TEST_F(NetworkDeviceTest, ReadingsArrive) {
  tray.lay({{0.01, -0.02, 0.03}, 5, DeviceStatus::fresh});
  EXPECT_TRUE(eventually([&] {
    const DeviceReading reading = tick();
    return reading.status == DeviceStatus::fresh && reading.buttons == 5 &&
           reading.position == Eigen::Vector3d(0.01, -0.02, 0.03);
  }));
  EXPECT_THAT(device->trouble(), IsEmpty());
}

TEST_F(NetworkDeviceTest, ForcesArriveClampedToTheLimit) {
  EXPECT_TRUE(eventually([&] {
    return tick({0.5, 1, -0.25}), tray.force() == Eigen::Vector3d(0.5, 1, -0.25);
  }));
  EXPECT_TRUE(eventually([&] {
    return tick({30, 0, 40}), tray.force().isApprox(Eigen::Vector3d(1.2, 0, 1.6));
  }));
}

TEST_F(NetworkDeviceTest, NaNInAReadingIsPassedOn) {
  tray.lay({Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()), 0,
            DeviceStatus::fresh});
  EXPECT_TRUE(eventually([&] {
    const DeviceReading reading = tick();
    return reading.status == DeviceStatus::fresh && std::isnan(reading.position.y());
  }));
}

TEST_F(NetworkDeviceTest, ARemoteDeviceThatIsUnpluggedOrAwayIsLost) {
  ASSERT_TRUE(becomes(DeviceStatus::fresh));
  for (const DeviceStatus there : {DeviceStatus::lost, DeviceStatus::away}) {
    tray.lay({Eigen::Vector3d::Zero(), 0, there});
    EXPECT_TRUE(becomes(DeviceStatus::lost));
    tray.lay({Eigen::Vector3d::Zero(), 0, DeviceStatus::fresh});
    EXPECT_TRUE(becomes(DeviceStatus::fresh));
  }
}

TEST_F(NetworkDeviceTest, HaltingMakesTheRemoteForceZeroUntilResume) {
  ASSERT_TRUE(eventually([&] { return tick({1, 0, 0}), tray.force().x() == 1; }));
  device->halt();
  EXPECT_TRUE(eventually([&] { return tick({1, 0, 0}), tray.force().isZero(); }));
  device->resume();
  EXPECT_TRUE(eventually([&] { return tick({1, 0, 0}), tray.force().x() == 1; }));
}

TEST_F(NetworkDeviceTest, AKilledServerIsLostAndFoundAgain) {
  ASSERT_TRUE(becomes(DeviceStatus::fresh));
  server.reset();
  EXPECT_TRUE(tray.force().isZero());
  EXPECT_TRUE(becomes(DeviceStatus::lost));
  EXPECT_TRUE(eventually([&] { return device->trouble().find(endpoint) != std::string::npos; }));
  serve();
  EXPECT_TRUE(becomes(DeviceStatus::fresh));
  EXPECT_TRUE(eventually([&] { return device->trouble().empty(); })) << device->trouble();
  EXPECT_TRUE(eventually([&] { return tick({1, 0, 0}), tray.force().x() == 1; }));
}

TEST_F(NetworkDeviceTest, AClientThatLeavesReleasesForceAndDevice) {
  ASSERT_TRUE(eventually([&] { return tick({1, 0, 0}), tray.force().x() == 1; }));
  device.reset();
  EXPECT_TRUE(eventually([&] { return tray.force().isZero(); }));
  connect();
  EXPECT_TRUE(becomes(DeviceStatus::fresh));
}

TEST_F(NetworkDeviceTest, ASecondClientIsRefusedWithTheReason) {
  ASSERT_TRUE(becomes(DeviceStatus::fresh));
  NetworkDevice second({.endpoint = endpoint, .wait = 1ms});
  EXPECT_TRUE(eventually([&] {
    tick();
    return second.trouble().find("another simulator") != std::string::npos;
  })) << second.trouble();
  EXPECT_EQ(second.read().status, DeviceStatus::lost);
  EXPECT_TRUE(becomes(DeviceStatus::fresh));
}

TEST(NetworkDevice, SaysHowToStartADeviceIfNoServerAnswers) {
  NetworkDevice device({.endpoint = "tcp://127.0.0.1:9", .wait = 1ms});
  EXPECT_EQ(device.read().status, DeviceStatus::lost);
  EXPECT_THAT(device.trouble(), HasSubstr("tcp://127.0.0.1:9"));
  EXPECT_THAT(device.trouble(), HasSubstr("palpate device"));
  EXPECT_EQ(device.profile(), device_profiles.front());
}

TEST(NetworkDevice, HasRealTimeThreadsOnRequest) {
  NetworkDevice device({.endpoint = "tcp://127.0.0.1:9", .wait = 1ms, .real_time = true});
  const std::string refused = device.askForRealTime();
  if (!refused.empty()) GTEST_SKIP() << refused;
  EXPECT_TRUE(eventually([] { return test::threadsWith(device_priority) == 3; }))
      << "its own and two of ZeroMQ, which start with a delay";
}

TEST(NetworkDevice, RefusesAnInvalidEndpoint) {
  test::expectBadInput([] { NetworkDevice({.endpoint = "tcp://nowhere"}); },
                       {"tcp://nowhere", "PORT"});
}

/// Base of a server and a client that a test controls message by message.
class Side {
 public:
  /// Waits for the next message of that kind.
  wire::DeviceMessage expect(wire::DeviceMessage::BodyCase kind) {
    wire::DeviceMessage found;
    EXPECT_TRUE(eventually([&] {
      const auto incoming = receiveDeviceMessage(socket_, is_router_);
      if (!incoming) return false;
      peer_ = incoming->peer;
      found = incoming->message;
      return found.body_case() == kind;
    })) << "no message of kind "
        << kind;
    return found;
  }
  void send(const wire::DeviceMessage& message) {
    sendDeviceMessage(socket_, is_router_ ? peer_ : "", message);
  }
  void sendRaw(const std::string& bytes) {
    if (is_router_) socket_.send(zmq::buffer(peer_), zmq::send_flags::sndmore);
    socket_.send(zmq::buffer(bytes), zmq::send_flags::none);
  }

 protected:
  explicit Side(bool is_router)
      : socket_(is_router ? makeDeviceRouter(context_) : makeDeviceDealer(context_)),
        is_router_(is_router) {}
  zmq::context_t context_;
  zmq::socket_t socket_;
  bool is_router_;
  std::string peer_;
};

class FarSide : public Side {
 public:
  FarSide() : Side(true) {
    socket_.bind("tcp://127.0.0.1:*");
    endpoint = socket_.get(zmq::sockopt::last_endpoint);
  }
  void sayHello(double max_force = 3) {
    wire::DeviceMessage message;
    wire::DeviceHello& hello = *message.mutable_hello();
    hello.set_protocol(device_protocol);
    hello.set_max_force(max_force);
    hello.set_max_stiffness(400);
    hello.set_workspace_radius(0.1);
    send(message);
  }
  void sendReading(std::uint64_t sequence, double x) {
    wire::DeviceMessage message;
    message.mutable_reading()->set_sequence(sequence);
    message.mutable_reading()->set_x(x);
    send(message);
  }

  std::string endpoint;
};

/// A device whose name and trouble contain codes that move the cursor, and bytes that are not
/// UTF-8.
class RudeDevice : public test::TrayDevice {
 public:
  std::string name() const override { return "\x1b[2Jtray"; }
  std::string trouble() const override {
    return "\xff\x1b[31m" + std::string(600, 'x') + "\xc3\xa4";
  }
};

TEST(NetworkDevice, EscapesInvalidTextOfADevice) {
  RudeDevice rude;
  DeviceServer server(rude, "tcp://127.0.0.1:*");
  NetworkDevice device({.endpoint = server.endpoint()});
  EXPECT_TRUE(eventually([&] { return device.read().status == DeviceStatus::fresh; }));
  // Before the first state of the device arrives, trouble() reports that no server answers.
  EXPECT_TRUE(eventually([&] { return device.trouble().find("??[31mxxx") != std::string::npos; }))
      << device.trouble();
  EXPECT_THAT(device.name(), HasSubstr("?[2Jtray at"));
  EXPECT_EQ(device.trouble().find('\x1b'), std::string::npos);
}

TEST(NetworkDevice, IgnoresGarbageAndCountsIt) {
  FarSide far;
  NetworkDevice device({.endpoint = far.endpoint, .wait = 1ms});
  far.expect(wire::DeviceMessage::kGreeting);
  far.sendRaw("\xff\xff\xff\xff");
  far.sendRaw("");
  far.sayHello(-1);
  EXPECT_TRUE(eventually([&] {
    return device.trouble().find("3 invalid messages") != std::string::npos;
  })) << device.trouble();
  far.sayHello();
  far.sendReading(1, 0.25);
  EXPECT_TRUE(eventually([&] { return device.read().position.x() == 0.25; }));
}

TEST(NetworkDevice, IgnoresReadingsThatAreOlderThanTheLast) {
  FarSide far;
  NetworkDevice device({.endpoint = far.endpoint, .wait = 1ms});
  far.expect(wire::DeviceMessage::kGreeting);
  far.sayHello();
  far.sendReading(7, 0.7);
  far.sendReading(6, 0.6);
  far.sendReading(8, 0.8);
  EXPECT_TRUE(eventually([&] {
    const double x = device.read().position.x();
    EXPECT_NE(x, 0.6);
    return x == 0.8;
  }));
}

TEST(NetworkDevice, GivesALateDeviceNoMoreThanItsFirstLimit) {
  FarSide far;
  NetworkDevice device({.endpoint = far.endpoint, .wait = 1ms});
  far.expect(wire::DeviceMessage::kGreeting);
  device.write({100, 0, 0});
  far.sayHello(50);
  EXPECT_NEAR(far.expect(wire::DeviceMessage::kForce).force().x(), device.profile().max_force,
              1e-12);
}

class NearSide : public Side {
 public:
  explicit NearSide(const std::string& endpoint) : Side(false) {
    socket_.set(zmq::sockopt::immediate, false);
    socket_.connect(endpoint);
  }
  void greet(std::uint32_t protocol = device_protocol) {
    wire::DeviceMessage message;
    message.mutable_greeting()->set_protocol(protocol);
    send(message);
  }
  void push(std::uint64_t sequence, double x, double valid_for_s) {
    push(sequence, x, valid_for_s, newestReading());
  }
  void push(std::uint64_t sequence, double x, double valid_for_s, std::uint64_t reading) {
    wire::DeviceMessage message;
    message.mutable_force()->set_sequence(sequence);
    message.mutable_force()->set_x(x);
    message.mutable_force()->set_valid_for_s(valid_for_s);
    message.mutable_force()->set_reading(reading);
    send(message);
  }
  std::uint64_t newestReading() {
    while (const auto incoming = receiveDeviceMessage(socket_, false))
      if (incoming->message.has_reading()) reading_ = incoming->message.reading().sequence();
    return reading_;
  }

 private:
  std::uint64_t reading_ = 0;
};

/// A lent device, and a client controlled by the test.
struct DeviceServerTest : ::testing::Test {
  test::TrayDevice tray;
  DeviceServer server{tray, "tcp://127.0.0.1:*"};
  NearSide client{server.endpoint()};
  std::uint64_t number = 0;

  void hold() {
    client.greet();
    client.expect(wire::DeviceMessage::kHello);
  }
  /// Sends forces along x until `felt` is felt.
  bool pushes(double x, double felt) {
    return eventually([&] { return client.push(++number, x, 0.5), tray.force().x() == felt; });
  }
};

TEST_F(DeviceServerTest, ReleasesTheForceWhenItsValidityExpires) {
  hold();
  ASSERT_TRUE(pushes(1.5, 1.5));
  EXPECT_TRUE(eventually([&] { return tray.force().isZero(); }));
  EXPECT_GE(server.state().lapses, 1U);
  EXPECT_TRUE(pushes(1, 1));
}

/// Even an endless flood of messages must not keep a force: the device is still read and written.
TEST_F(DeviceServerTest, ReleasesTheForceWhileOthersFloodIt) {
  std::vector<std::jthread> floods;
  for (int n = 0; n < 3; ++n)
    floods.emplace_back([&](const std::stop_token& stop) {
      NearSide flood(server.endpoint());
      while (!stop.stop_requested()) flood.sendRaw("no message");
    });
  ASSERT_TRUE(eventually([&] { return server.state().garbage > 10000; }));
  hold();
  ASSERT_TRUE(pushes(1.5, 1.5));
  EXPECT_TRUE(eventually([&] { return tray.force().isZero(); }));
}

TEST_F(DeviceServerTest, RefusesInvalidForces) {
  hold();
  client.push(1, std::numeric_limits<double>::infinity(), 0.5);
  client.push(2, 1, 1e9);
  client.push(3, 1, -1);
  client.sendRaw("no message");
  EXPECT_TRUE(eventually([&] { return server.state().garbage == 4; })) << server.state().garbage;
  EXPECT_EQ(server.state().forces, 0U);
  EXPECT_TRUE(tray.force().isZero());
  number = 3;
  EXPECT_TRUE(pushes(-500, -2)) << "the limit of the device";
}

TEST_F(DeviceServerTest, IgnoresForcesDelayedByTheNetwork) {
  test::StallingRelay relay(server.endpoint());
  NetworkDevice device({.endpoint = relay.endpoint(), .wait = 20s});
  ASSERT_TRUE(eventually([&] { return device.write({1, 0, 0}), tray.force().x() == 1; }));
  relay.stall();
  ASSERT_TRUE(eventually([&] { return relay.held() > 0 && tray.force().isZero(); }));
  const std::size_t pushing = relay.held();
  const std::uint64_t followed = server.state().forces;
  device.write({-1, 0, 0});
  std::this_thread::sleep_for(100ms);  // all of the force is outdated now
  relay.let(pushing);
  EXPECT_TRUE(eventually([&] { return server.state().outdated > 0 || !server.state().held; }));
  EXPECT_EQ(server.state().forces, followed);
  EXPECT_EQ(tray.force(), Eigen::Vector3d::Zero());
  relay.flow();
  EXPECT_TRUE(eventually([&] { return tray.force().x() == -1; }));
}

TEST_F(DeviceServerTest, IgnoresForcesThatAnswerNoneOfItsReadings) {
  hold();
  client.push(1, 1, 0.5, 0);
  client.push(2, 1, 0.5, 1'000'000'000);
  EXPECT_TRUE(eventually([&] { return server.state().outdated == 2; })) << server.state().outdated;
  EXPECT_EQ(server.state().forces, 0U);
}

TEST_F(DeviceServerTest, FollowsOnlyTheClientThatHoldsTheDevice) {
  hold();
  NearSide other(server.endpoint());
  other.push(1, 1, 0.5);
  other.greet();
  EXPECT_THAT(other.expect(wire::DeviceMessage::kRefused).refused().reason(),
              HasSubstr("another simulator"));
  EXPECT_EQ(server.state().forces, 0U);
}

TEST_F(DeviceServerTest, RefusesAnotherProtocolWithBothVersions) {
  client.greet(99);
  EXPECT_THAT(client.expect(wire::DeviceMessage::kRefused).refused().reason(), HasSubstr("99"));
}

TEST_F(DeviceServerTest, NamesAnEndpointInUse) {
  test::TrayDevice second;
  test::expectError(ExitCode::failed, [&] { DeviceServer(second, {server.endpoint()}); },
                    {"in use", server.endpoint()});
}

}  // namespace
}  // namespace palpate
