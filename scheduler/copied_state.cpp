#include "scheduler/copied_state.hpp"

#include <fcntl.h>
#include <netdb.h>
#include <poll.h>
#include <spdlog/spdlog.h>
#include <sys/socket.h>

#include <chrono>
#include <memory>

#include "common/base/file_descriptor.hpp"
#include "scheduler/asked_scheduler.hpp"
#include "scheduler/state/state_directory.hpp"

namespace palpate {
namespace {

bool connects(const addrinfo& address) {
  constexpr std::chrono::milliseconds patience{1000};
  const FileDescriptor file(
      socket(address.ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (!file) return false;
  if (connect(file.get(), address.ai_addr, address.ai_addrlen) == 0) return true;
  if (errno != EINPROGRESS) return false;
  pollfd wait{file.get(), POLLOUT, 0};
  int error = 0;
  socklen_t length = sizeof error;
  return poll(&wait, 1, static_cast<int>(patience.count())) == 1 &&
         getsockopt(file.get(), SOL_SOCKET, SO_ERROR, &error, &length) == 0 && error == 0;
}

/// ZeroMQ would wait for it. False too for what is no tcp://HOST:PORT.
bool isSomebodyAt(const std::string& endpoint) {
  constexpr std::string_view tcp = "tcp://";
  const std::size_t colon = endpoint.rfind(':');
  if (!endpoint.starts_with(tcp) || colon < tcp.size()) return false;
  std::string host = endpoint.substr(tcp.size(), colon - tcp.size());
  if (host.size() > 2 && host.front() == '[') host = host.substr(1, host.size() - 2);
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (getaddrinfo(host.c_str(), endpoint.c_str() + colon + 1, &hints, &found) != 0) return false;
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> all(found, freeaddrinfo);
  for (const addrinfo* address = found; address != nullptr; address = address->ai_next)
    if (connects(*address)) return true;
  return false;
}

}  // namespace

void refuseCopyOfLiving(const std::filesystem::path& state, const ContentId& build,
                        const std::optional<KeyFolder>& keys) {
  if (StateDirectory::holder(state)) return;  // who opens it is told
  const auto address = StateDirectory::lastAddress(state);
  if (!address || !isSomebodyAt(address->endpoint)) return;
  const std::string& endpoint = address->endpoint;
  wire::Status status;
  try {
    Reachable there{endpoint, std::nullopt};
    if (address->keys)
      there.keys = std::filesystem::is_directory(*address->keys) ? KeyFolder(*address->keys) : keys;
    status = askStatus(there, endpoint);
  } catch (const Error& error) {
    if (error.exitCode() == ExitCode::interrupted) throw;
    spdlog::warn(
        "whether the scheduler that worked last in {}, or in what that is a copy of, still does at "
        "{} is not known ({}): if so, end it before both compute the same",
        state.string(), endpoint, error.what());
    return;
  }
  if (status.build() != build.hex()) return;
  throw failure(
      "{}: is a copy of the state directory of a scheduler that still works for this build at {}: "
      "end that one (palpate stop {}), copy again, since it went on meanwhile, and start again. To "
      "compute it twice, remove {}*",
      state.string(), endpoint, endpoint, (state / "endpoint").string());
}

}  // namespace palpate
