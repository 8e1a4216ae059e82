#include "scheduler/fleet/worker_pool.hpp"

#include <signal.h>
#include <sys/wait.h>

#include <thread>

#include "common/base/error.hpp"

namespace palpate {
namespace {

std::string describeStatus(int status) {
  if (WIFSIGNALED(status))
    return fmt::format("signal {} ({})", WTERMSIG(status), strsignal(WTERMSIG(status)));
  return fmt::format("exit code {}", WEXITSTATUS(status));
}

}  // namespace

std::vector<WorkerPool::Ended> WorkerPool::reap() {
  std::vector<Ended> ended;
  std::erase_if(running_, [&](pid_t pid) {
    int status = 0;
    const pid_t done = waitpid(pid, &status, WNOHANG);
    if (done == 0 || (done < 0 && errno == EINTR)) return false;
    ended.push_back({pid, done > 0 ? describeStatus(status) : std::string(errnoText())});
    return true;
  });
  return ended;
}

void WorkerPool::terminate(std::chrono::milliseconds grace) {
  const auto signalAll = [&](int number) {
    for (const pid_t pid : running_) kill(pid, number);
  };
  signalAll(SIGTERM);
  const auto deadline = std::chrono::steady_clock::now() + grace;
  while (reap(), !running_.empty() && std::chrono::steady_clock::now() < deadline)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  // Wait without a time limit: no process survives SIGKILL.
  signalAll(SIGKILL);
  for (const pid_t pid : running_) waitFor(pid);
  running_.clear();
}

}  // namespace palpate
