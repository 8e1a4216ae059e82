#include "viewer/devices/haply_device.hpp"

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>

#include "common/base/error.hpp"
#include "viewer/devices/haply_message.hpp"

namespace palpate {
namespace {

using namespace std::chrono_literals;
namespace asio = boost::asio;
namespace beast = boost::beast;
using Clock = DeviceExchange::Clock;

constexpr auto period = 1ms;
constexpr auto connect_limit = 2s;
/// If no answer arrives within this time, the connection is closed and opened again, and the device
/// counts as lost.
constexpr auto answer_limit = DeviceExchange::silence;
/// Time to send the last message before a connection is closed.
constexpr auto farewell_limit = 20ms;
constexpr auto retry_interval = 500ms;
constexpr auto stop_check = 20ms;
constexpr std::size_t longest_frame = 1 << 20;

constexpr const char* how_to_start =
    "start the Haply Hub, or the service alone: systemctl start haply-inverse-service.service";

/// The web socket. Each call lasts at most until a time limit or a requested stop; then it closes
/// the connection. read() sends `farewell` before it closes the connection.
class Connection {
 public:
  explicit Connection(const std::stop_token& stop) : stop_(stop), socket_(io_) {}

  beast::error_code open(const asio::ip::tcp::endpoint& endpoint) {
    auto error = await([&](auto done) { lowest().async_connect(endpoint, done); }, connect_limit);
    if (error) return error;
    lowest().socket().set_option(asio::ip::tcp::no_delay(true), error);
    socket_.read_message_max(longest_frame);
    socket_.text(true);
    return await(
        [&](auto done) {
          socket_.async_handshake("localhost:" + std::to_string(endpoint.port()), "/", done);
        },
        connect_limit);
  }
  beast::error_code read(std::string& text, const std::string& farewell, Clock::duration limit) {
    buffer_.clear();
    const auto error =
        await([&](auto done) { socket_.async_read(buffer_, done); }, limit, farewell);
    text = beast::buffers_to_string(buffer_.data());
    return error;
  }
  beast::error_code write(const std::string& text) {
    return await([&](auto done) { socket_.async_write(asio::buffer(text), done); }, answer_limit);
  }
  void close() {
    await([&](auto done) { socket_.async_close(beast::websocket::close_code::normal, done); },
          200ms);
  }

 private:
  beast::tcp_stream& lowest() { return beast::get_lowest_layer(socket_); }

  /// Runs an operation for at most `limit`. If the operation is not finished by then, sends
  /// `farewell` and closes the connection.
  template <class Start>
  beast::error_code await(Start start, Clock::duration limit, const std::string& farewell = {}) {
    beast::error_code result = asio::error::timed_out;
    bool done = false;
    start([&](beast::error_code code, auto...) {
      result = code;
      done = true;
    });
    const auto end = Clock::now() + limit;
    io_.restart();
    do {
      io_.run_for(std::min<Clock::duration>(stop_check, end - Clock::now()));
    } while (!done && !stop_.stop_requested() && Clock::now() < end);
    if (done) return result;
    bool said = farewell.empty();
    if (!said)
      socket_.async_write(asio::buffer(farewell),
                          [&](beast::error_code, std::size_t) { said = true; });
    for (const auto last = Clock::now() + farewell_limit; !said && Clock::now() < last;) {
      io_.restart();
      io_.run_for(1ms);
    }
    lowest().close();  // cancels pending operations
    io_.restart();
    io_.run();
    return asio::error::timed_out;
  }

  const std::stop_token stop_;
  asio::io_context io_;
  beast::websocket::stream<beast::tcp_stream> socket_;
  beast::flat_buffer buffer_;
};

}  // namespace

HaplyDevice::HaplyDevice(HaplyDeviceOptions options)
    : options_(std::move(options)), place_(fmt::format("ws://127.0.0.1:{}", options_.port)) {
  traits_ = {.profile = inverse3_profile, .has_buttons = true};
  exchange_->setTrouble("connecting to " + place_);
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

std::string HaplyDevice::name() const {
  return options_.id.empty() ? "Haply Inverse3" : "Haply Inverse3 " + options_.id;
}

void HaplyDevice::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    try {
      serve(stop);
    } catch (const std::exception& error) {
      exchange_->setTrouble(fmt::format("{}: {}", place_, error.what()));
    }
    const auto retry = Clock::now() + retry_interval;
    while (!stop.stop_requested() && Clock::now() < retry) std::this_thread::sleep_for(stop_check);
  }
}

void HaplyDevice::serve(const std::stop_token& stop) {
  Connection connection(stop);
  if (const auto error = connection.open({asio::ip::address_v4::loopback(), options_.port})) {
    exchange_->setTrouble(fmt::format("no Haply Inverse Service at {} ({}): {}", place_,
                                      error.message(), how_to_start));
    return;
  }
  const auto sayGone = [&](const beast::error_code& error) {
    if (stop.stop_requested()) return;
    exchange_->setTrouble(fmt::format("lost the Haply Inverse Service at {} ({}): {}", place_,
                                      error.message(), how_to_start));
  };
  std::string id = options_.id, text;
  std::uint64_t malformed = 0;
  Clock::duration limit = connect_limit;  // for the inventory at first, then for each answer
  for (auto next = Clock::now(); !stop.stop_requested();) {
    const std::string zero = id.empty() ? "" : haplyForceMessage(id, Eigen::Vector3d::Zero());
    if (const auto error = connection.read(text, zero, limit)) return sayGone(error);
    limit = answer_limit;
    HaplyState state = readHaplyState(text, id);
    if (state.kind == HaplyState::Kind::no_device) {
      state.reading.status = DeviceStatus::lost;
      exchange_->deliver(state.reading);
      exchange_->setTrouble(
          fmt::format("the Haply Inverse Service at {} has no Inverse3{}: plug it in{}", place_,
                      id.empty() ? "" : " " + id,
                      state.id.empty() ? "" : ", or choose one that it has: " + state.id));
      return;  // a new connection starts with a new inventory
    }
    malformed += state.kind == HaplyState::Kind::malformed ? 1 : 0;
    if (state.kind == HaplyState::Kind::reading) {
      id = state.id;
      state.reading.position -= options_.center;
      exchange_->deliver(state.reading);
    }
    std::string trouble = state.trouble;
    if (malformed > 0)
      trouble += fmt::format("{}{} invalid messages from {} were ignored",
                             trouble.empty() ? "" : "; ", malformed, place_);
    exchange_->setTrouble(trouble);
    // The service sends one answer per message, so this pause also sets the rate of the answers.
    next = std::max(next + period, Clock::now());
    std::this_thread::sleep_until(next);
    if (const auto error = connection.write(haplyForceMessage(id, exchange_->force())))
      return sayGone(error);
  }
  // Sends zero force even while the thread is being stopped.
  if (!connection.write(haplyForceMessage(id, Eigen::Vector3d::Zero()))) connection.close();
}

}  // namespace palpate
