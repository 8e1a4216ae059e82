#pragma once

#include <algorithm>
#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>

namespace palpate::test {

/// A relay between one client and a server that can stall in the direction of the server, as a
/// network does: data sent meanwhile are held and delivered later. The other direction never
/// stalls.
class StallingRelay {
 public:
  /// server: tcp://127.0.0.1:PORT
  explicit StallingRelay(const std::string& server)
      : port_(static_cast<std::uint16_t>(std::stoi(server.substr(server.rfind(':') + 1)))),
        acceptor_(io_, {boost::asio::ip::address_v4::loopback(), 0}) {
    acceptor_.non_blocking(true);
    thread_ = std::thread(&StallingRelay::run, this);
  }
  ~StallingRelay() {
    stopping_ = true;
    thread_.join();
  }
  StallingRelay(const StallingRelay&) = delete;
  StallingRelay& operator=(const StallingRelay&) = delete;

  std::string endpoint() const {
    return "tcp://127.0.0.1:" + std::to_string(acceptor_.local_endpoint().port());
  }
  void stall() { allow(0); }
  void flow() { allow(SIZE_MAX); }
  /// Delivers this many of the held bytes and keeps stalling.
  void let(std::size_t bytes) { allow(bytes); }
  std::size_t held() const {
    const std::lock_guard lock(mutex_);
    return held_.size();
  }

 private:
  using Socket = boost::asio::ip::tcp::socket;

  void allow(std::size_t bytes) {
    const std::lock_guard lock(mutex_);
    allowed_ = bytes;
  }
  void run() {
    boost::system::error_code error = boost::asio::error::would_block;
    Socket client(io_), server(io_);
    while (error && !stopping_) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      acceptor_.accept(client, error);
    }
    server.connect({boost::asio::ip::address_v4::loopback(), port_}, error);
    if (error) return;
    client.non_blocking(true);
    server.non_blocking(true);
    std::string back;
    while (!stopping_) {
      pass(server, client, back, SIZE_MAX);
      {
        const std::lock_guard lock(mutex_);
        const std::size_t sent = pass(client, server, held_, allowed_);
        if (allowed_ != SIZE_MAX) allowed_ -= sent;
      }
      std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
  }
  /// Returns the number of bytes sent.
  static std::size_t pass(Socket& from, Socket& to, std::string& between, std::size_t most) {
    char bytes[4096];
    boost::system::error_code error;
    const std::size_t came = from.read_some(boost::asio::buffer(bytes), error);
    between.append(bytes, came);
    const std::size_t sent =
        between.empty() || most == 0
            ? 0
            : to.write_some(boost::asio::buffer(between.data(), std::min(most, between.size())),
                            error);
    between.erase(0, sent);
    return sent;
  }

  const std::uint16_t port_;
  boost::asio::io_context io_;
  boost::asio::ip::tcp::acceptor acceptor_;
  std::atomic<bool> stopping_ = false;
  mutable std::mutex mutex_;
  std::string held_;
  std::size_t allowed_ = SIZE_MAX;
  std::thread thread_;
};

}  // namespace palpate::test
