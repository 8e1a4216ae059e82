#pragma once

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

namespace palpate::test {

/// Receives the messages of a service to systemd. Processes and ServiceManagers that start while
/// this object exists find it at $NOTIFY_SOCKET. The socket is the file `notify` in a folder.
class NotifySocket {
 public:
  explicit NotifySocket(const std::filesystem::path& folder)
      : path_((folder / "notify").string()),
        socket_(socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    if (path_.size() >= sizeof address.sun_path) {
      ADD_FAILURE() << path_ << " is too long for a socket";
      return;
    }
    std::ranges::copy(path_, address.sun_path);
    EXPECT_EQ(bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    setenv("NOTIFY_SOCKET", path_.c_str(), 1);
  }
  ~NotifySocket() {
    unsetenv("NOTIFY_SOCKET");
    if (socket_ >= 0) close(socket_);
  }
  NotifySocket(const NotifySocket&) = delete;
  NotifySocket& operator=(const NotifySocket&) = delete;

  /// The messages since the last call.
  std::vector<std::string> heard() const {
    std::vector<std::string> all;
    std::array<char, 4096> bytes{};
    for (;;) {
      const ssize_t length = recv(socket_, bytes.data(), bytes.size(), 0);
      if (length < 0) return all;
      all.emplace_back(bytes.data(), static_cast<std::size_t>(length));
    }
  }
  /// Removes the socket, as if the manager were gone.
  void remove() const { std::filesystem::remove(path_); }

 private:
  std::string path_;
  int socket_;
};

}  // namespace palpate::test
