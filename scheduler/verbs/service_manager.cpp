#include "scheduler/verbs/service_manager.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdlib>

#include "common/base/error.hpp"
#include "common/base/file_descriptor.hpp"
#include "common/base/number_in.hpp"

namespace palpate {
namespace {

using std::chrono::microseconds;

constexpr std::chrono::seconds between_status{5};

std::string takeVariable(const char* name) {
  const char* value = std::getenv(name);
  std::string text = value == nullptr ? "" : value;
  unsetenv(name);
  return text;
}

}  // namespace

ServiceManager::ServiceManager() : socket_(takeVariable("NOTIFY_SOCKET")) {
  const std::int64_t pid = numberIn<std::int64_t>(takeVariable("WATCHDOG_PID")).value_or(0);
  const microseconds watchdog(numberIn<std::int64_t>(takeVariable("WATCHDOG_USEC")).value_or(0));
  // The watchdog may be meant for a parent of this process.
  if (pid == 0 || pid == getpid()) watchdog_ = std::max(watchdog, microseconds(0));
}

void ServiceManager::mayTake(std::chrono::seconds longest, const std::string& what) {
  const std::int64_t time = microseconds(longest).count();
  sendAndWatch(fmt::format("STATUS={}\nEXTEND_TIMEOUT_USEC={}", what, time), longest);
}

void ServiceManager::ready() { sendAndWatch("READY=1", watchdog_); }

/// Sends `lines`, and sets the watchdog interval to `longest`.
void ServiceManager::sendAndWatch(const std::string& lines, microseconds longest) {
  send(watchdog_.count() > 0 ? fmt::format("{}\nWATCHDOG_USEC={}", lines, longest.count()) : lines);
}

void ServiceManager::alive(Clock::time_point now, const std::function<std::string()>& status) {
  if (!isThere()) return;
  if (watchdog_.count() > 0 && now >= next_sign_) {
    next_sign_ = now + watchdog_ / 2;
    send("WATCHDOG=1");
  }
  if (now < next_status_) return;
  next_status_ = now + between_status;
  send("STATUS=" + status());
}

void ServiceManager::stopping() { send("STOPPING=1"); }

void ServiceManager::send(const std::string& lines) {
  if (!isThere() || failed_) return;
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (socket_.size() >= sizeof address.sun_path) {
    errno = ENAMETOOLONG;
    failed_ = true;
  } else {
    std::ranges::copy(socket_, address.sun_path);
    // An abstract socket name begins with a zero byte.
    if (socket_.front() == '@') address.sun_path[0] = '\0';
    const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + socket_.size());
    const FileDescriptor from(socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    failed_ = !from || sendto(from.get(), lines.data(), lines.size(), MSG_NOSIGNAL,
                              reinterpret_cast<const sockaddr*>(&address), length) < 0;
  }
  if (failed_)
    spdlog::warn("cannot send messages to the service manager at {}: {}", socket_, errnoText());
}

}  // namespace palpate
