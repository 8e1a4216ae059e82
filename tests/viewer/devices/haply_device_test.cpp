#include "viewer/devices/haply_device.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <mutex>
#include <nlohmann/json.hpp>

#include "tests/viewer/devices/polling.hpp"
#include "tests/viewer/devices/real_time_threads.hpp"
#include "viewer/devices/haply_message.hpp"
#include "viewer/haptics/real_time.hpp"

namespace palpate {
namespace {

using namespace std::chrono_literals;
namespace asio = boost::asio;
namespace beast = boost::beast;
using nlohmann::json;
using test::eventually;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A message of the service as in its documentation.
json inventory(const std::string& id = "049D") {
  return json::parse(R"({"session_id": 7, "inverse3": [{"device_id": ")" + id + R"(",
    "config": {"type": "inverse3", "handedness": "right", "basis": {"permutation": "XYZ"}},
    "state": {"cursor_position": {"x": 0.01, "y": -0.12, "z": 0.17},
              "cursor_velocity": {"x": 0.0, "y": 0.0, "z": 0.0}, "control_mode": "idle"},
    "status": {"calibrated": true, "power_supply": true}}],
    "wireless_verse_grip": [{"device_id": "6F", "state": {"buttons": {"a": true, "b": false, "c": true}}}]})");
}

/// A Haply Inverse Service on a free port: it sends an inventory, then one answer to every message.
class Service {
 public:
  explicit Service(std::uint16_t port = 0)
      : acceptor_(io_, {asio::ip::address_v4::loopback(), port}) {
    acceptor_.non_blocking(true);
    thread_ = std::thread(&Service::run, this);
  }
  ~Service() {
    stopping_ = true;
    hangUp();
    thread_.join();
  }
  std::uint16_t port() const { return acceptor_.local_endpoint().port(); }
  void answerWith(const std::string& text) {
    const std::lock_guard lock(mutex_);
    answer_ = text;
  }
  json lastReceived() {
    const std::lock_guard lock(mutex_);
    return received_;
  }
  /// From now on it listens without answering.
  void fallSilent() { silent_ = true; }
  /// Closes the connection without a closing handshake.
  void hangUp() {
    const std::lock_guard lock(mutex_);
    if (client_ >= 0) ::shutdown(client_, SHUT_RDWR);
  }

 private:
  void run() {
    while (!stopping_) {
      beast::error_code error;
      asio::ip::tcp::socket socket(io_);
      acceptor_.accept(socket, error);
      if (error) {
        std::this_thread::sleep_for(1ms);
        continue;
      }
      socket.non_blocking(false);
      setClient(socket.native_handle());
      talk(std::move(socket));
    }
  }
  void setClient(int client) {
    const std::lock_guard lock(mutex_);
    client_ = client;
    if (stopping_ && client >= 0) ::shutdown(client, SHUT_RDWR);
  }
  void talk(asio::ip::tcp::socket socket) {
    beast::websocket::stream<asio::ip::tcp::socket> stream(std::move(socket));
    beast::error_code error;
    stream.accept(error);
    stream.text(true);
    while (!error) {
      std::string answer;
      {
        const std::lock_guard lock(mutex_);
        answer = answer_;
      }
      if (!silent_) stream.write(asio::buffer(answer), error);
      if (error) break;
      beast::flat_buffer buffer;
      stream.read(buffer, error);
      if (error) break;
      const std::lock_guard lock(mutex_);
      received_ = json::parse(beast::buffers_to_string(buffer.data()));
    }
    setClient(-1);
  }

  asio::io_context io_;
  asio::ip::tcp::acceptor acceptor_;
  std::atomic<bool> stopping_ = false, silent_ = false;
  std::mutex mutex_;
  std::string answer_ = inventory().dump();
  json received_;
  int client_ = -1;
  std::thread thread_;
};

HaplyDeviceOptions at(std::uint16_t port, const std::string& id = "") {
  return {.id = id, .port = port, .center = {0, 0.15, 0.12}};
}

bool becomes(HaplyDevice& device, DeviceStatus status) {
  return eventually([&] { return device.read().status == status; });
}
bool troubleSays(const HaplyDevice& device, const std::string& words) {
  return eventually([&] { return device.trouble().find(words) != std::string::npos; });
}

TEST(HaplyMessage, PositionsComeInOurAxes) {
  const HaplyState state = readHaplyState(inventory().dump(), "");
  ASSERT_EQ(state.kind, HaplyState::Kind::reading);
  EXPECT_EQ(state.id, "049D");
  EXPECT_EQ(state.reading.position, Eigen::Vector3d(0.01, 0.17, 0.12));
  EXPECT_EQ(state.reading.buttons, 5U);
  EXPECT_THAT(state.trouble, IsEmpty());
}

/// The power force . velocity is equal in both frames, so forces rotate like positions.
TEST(HaplyMessage, ForcesGoOutInTheAxesOfTheService) {
  const json message = json::parse(haplyForceMessage("049D", {1, 2, 3}));
  EXPECT_EQ(message, json::parse(R"({"inverse3": [{"device_id": "049D", "commands":
    {"set_cursor_force": {"values": {"x": 1.0, "y": -3.0, "z": 2.0}}}}]})"));
}

TEST(HaplyMessage, FindsADeviceByItsIdOrListsTheAvailableOnes) {
  json message = inventory("AAAA");
  message["inverse3"].push_back(inventory("BBBB")["inverse3"][0]);
  EXPECT_EQ(readHaplyState(message.dump(), "BBBB").id, "BBBB");
  const HaplyState other = readHaplyState(message.dump(), "CCCC");
  EXPECT_EQ(other.kind, HaplyState::Kind::no_device);
  EXPECT_EQ(other.id, "AAAA, BBBB");
}

TEST(HaplyMessage, AnyTextIsReadWithoutAnException) {
  const std::string whole = inventory().dump();
  for (std::size_t length = 0; length < whole.size(); ++length)
    EXPECT_EQ(readHaplyState(whole.substr(0, length), "").kind, HaplyState::Kind::malformed)
        << length;
  for (const char* text :
       {"[]", "7", "{\"inverse3\":[{\"device_id\":\"A\",\"state\":7}]}",
        "{\"inverse3\":[{\"device_id\":\"A\",\"state\":{\"cursor_position\":{\"x\":null}}}]}"})
    EXPECT_EQ(readHaplyState(text, "").kind, HaplyState::Kind::malformed) << text;
  for (const char* text :
       {"{}", "{\"inverse3\":[]}", "{\"inverse3\":7}", "{\"inverse3\":[null,{}]}"})
    EXPECT_EQ(readHaplyState(text, "").kind, HaplyState::Kind::no_device) << text;
}

TEST(HaplyMessage, ReportsWhatKeepsTheDeviceFromPushing) {
  json message = inventory();
  message["inverse3"][0]["status"]["calibrated"] = false;
  EXPECT_THAT(readHaplyState(message.dump(), "").trouble, HasSubstr("not calibrated"));
  message["inverse3"][0]["status"]["power_supply"] = false;
  EXPECT_THAT(readHaplyState(message.dump(), "").trouble, HasSubstr("power supply"));
}

TEST(HaplyDevice, ReadsAndPushesThroughTheService) {
  Service service;
  HaplyDevice device(at(service.port()));
  ASSERT_TRUE(becomes(device, DeviceStatus::fresh));
  EXPECT_LT((device.read().position - Eigen::Vector3d(0.01, 0.02, 0)).norm(), 1e-12);
  device.write({0.5, 0, 0});
  EXPECT_TRUE(eventually([&] {
    return service.lastReceived() == json::parse(haplyForceMessage("049D", {0.5, 0, 0}));
  }));
  EXPECT_TRUE(eventually([&] { return device.trouble().empty(); }));
  device.halt();
  EXPECT_TRUE(eventually([&] {
    return service.lastReceived() == json::parse(haplyForceMessage("049D", {0, 0, 0}));
  }));
}

TEST(HaplyDevice, HasARealTimeThreadOnRequest) {
  HaplyDevice device({.port = 9});
  const std::string refused = device.askForRealTime();
  if (!refused.empty()) GTEST_SKIP() << refused;
  EXPECT_EQ(test::threadsWith(device_priority), 1);
}

TEST(HaplyDevice, SaysHowToStartAMissingService) {
  std::uint16_t free_port = 0;
  {
    Service service;
    free_port = service.port();
  }
  HaplyDevice device(at(free_port));
  EXPECT_TRUE(troubleSays(device, "haply-inverse-service")) << device.trouble();
  EXPECT_EQ(device.read().status, DeviceStatus::lost);
}

TEST(HaplyDevice, IsLostWhenTheServiceClosesAndComesBackWithIt) {
  Service service;
  HaplyDevice device(at(service.port()));
  ASSERT_TRUE(becomes(device, DeviceStatus::fresh));
  service.hangUp();
  EXPECT_TRUE(becomes(device, DeviceStatus::lost));
  EXPECT_TRUE(becomes(device, DeviceStatus::fresh));
}

TEST(HaplyDevice, GivesZeroForceToAServiceThatStopsAnswering) {
  Service service;
  HaplyDevice device(at(service.port()));
  device.write({1, 0, 0});
  ASSERT_TRUE(eventually([&] {
    return service.lastReceived() == json::parse(haplyForceMessage("049D", {1, 0, 0}));
  }));
  service.fallSilent();
  // The device sends zero force over the open connection. After a reconnection, a service that
  // stays silent gets no force at all.
  EXPECT_TRUE(eventually([&] {
    return service.lastReceived() == json::parse(haplyForceMessage("049D", {0, 0, 0}));
  }));
  EXPECT_TRUE(becomes(device, DeviceStatus::lost));
}

TEST(HaplyDevice, IgnoresMalformedMessagesAndCountsThem) {
  Service service;
  service.answerWith("{\"inverse3\": [{");
  HaplyDevice device(at(service.port()));
  EXPECT_TRUE(troubleSays(device, "invalid messages")) << device.trouble();
  EXPECT_EQ(device.read().status, DeviceStatus::lost);
  service.answerWith(inventory().dump());
  EXPECT_TRUE(becomes(device, DeviceStatus::fresh));
}

TEST(HaplyDevice, IsLostWhileItIsUnplugged) {
  Service service;
  HaplyDevice device(at(service.port(), "049D"));
  ASSERT_TRUE(becomes(device, DeviceStatus::fresh));
  service.answerWith(inventory("OTHER").dump());
  EXPECT_TRUE(becomes(device, DeviceStatus::lost));
  EXPECT_TRUE(troubleSays(device, "one that it has: OTHER")) << device.trouble();
  service.answerWith(inventory().dump());
  EXPECT_TRUE(becomes(device, DeviceStatus::fresh));
}

TEST(HaplyDevice, LeavesTheDeviceWithZeroForce) {
  Service service;
  {
    HaplyDevice device(at(service.port()));
    device.write({1, 0, 0});
    ASSERT_TRUE(eventually([&] {
      return service.lastReceived() == json::parse(haplyForceMessage("049D", {1, 0, 0}));
    }));
  }
  EXPECT_TRUE(eventually([&] {
    return service.lastReceived() == json::parse(haplyForceMessage("049D", {0, 0, 0}));
  }));
}

}  // namespace
}  // namespace palpate
