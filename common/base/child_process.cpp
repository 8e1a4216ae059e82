#include "common/base/child_process.hpp"

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>
#include <thread>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "common/base/whole_file.hpp"

namespace palpate {
namespace {

/// Runs in the child between vfork and exec, so it makes only async-signal-safe calls, and changes
/// no memory but its own variables.
[[noreturn]] void become(pid_t parent, char* const* arguments, const ChildSettings& settings) {
  for (int number = 0; const int file : settings.files) {
    if (file != number && dup2(file, number) < 0) _exit(126);
    ++number;
  }
  if (prctl(PR_SET_PDEATHSIG, settings.death_signal) != 0 || getppid() != parent) _exit(126);
  // A process group of its own keeps Ctrl-C from the child: its parent handles Ctrl-C.
  if (setpgid(0, 0) != 0) _exit(126);
  execvp(settings.program != nullptr ? settings.program : arguments[0], arguments);
  const int error = errno;
  // If the write fails, there is no way left to report the error.
  if (settings.error_pipe >= 0 && write(settings.error_pipe, &error, sizeof error) < 0) _exit(125);
  _exit(127);
}

}  // namespace

pid_t startChild(std::vector<std::string> words, const ChildSettings& settings) {
  PALPATE_ASSERT(!words.empty(), "a command must begin with its program");
  // Allocate now, because the child must not allocate between vfork and exec.
  std::vector<char*> arguments;
  for (std::string& argument : words) arguments.push_back(argument.data());
  arguments.push_back(nullptr);
  const pid_t parent = getpid();
  // fork() would write-protect all memory of this process. In a client, the ticks would then wait
  // for milliseconds.
  const pid_t child = vfork();  // NOLINT(clang-analyzer-security.insecureAPI.vfork)
  if (child < 0) throw failure("{} cannot be run: {}", words.front(), errnoText());
  // Linux allows async-signal-safe calls here. NOLINTNEXTLINE(clang-analyzer-unix.Vfork)
  if (child == 0) become(parent, arguments.data(), settings);
  return child;
}

ChildProcess::~ChildProcess() {
  if (status_) return;
  kill(pid_, SIGKILL);  // the number cannot belong to another process before waitFor()
  waitFor(pid_);
}

bool ChildProcess::running() {
  if (status_) return false;
  int status = 0;
  const pid_t done = waitpid(pid_, &status, WNOHANG);
  if (done == 0 || (done < 0 && errno == EINTR)) return true;
  PALPATE_ASSERT(done == pid_, "no other part of this process may wait for this child");
  status_ = status;
  return false;
}

int ChildProcess::signal() const {
  const int status = status_.value();
  return WIFSIGNALED(status) ? WTERMSIG(status) : 0;
}

int ChildProcess::exitCode() const {
  const int status = status_.value();
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

std::string ChildProcess::how() const {
  if (const int number = signal(); number != 0)
    return fmt::format("signal {} ({})", number, strsignal(number));
  return fmt::format("exit code {}", exitCode());
}

void ChildProcess::send(int signal) {
  if (running()) kill(pid_, signal);
}

void ChildProcess::terminate(std::chrono::milliseconds grace) {
  send(SIGTERM);
  const auto deadline = std::chrono::steady_clock::now() + grace;
  while (running() && std::chrono::steady_clock::now() < deadline)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  // Wait without a time limit: no process survives SIGKILL.
  send(SIGKILL);
  if (!status_) status_ = waitFor(pid_);
}

std::vector<std::string> commandLine() {
  const std::string line = readText("/proc/self/cmdline", "command line");
  std::vector<std::string> words;
  for (std::size_t at = 0; at < line.size(); at += words.back().size() + 1)
    words.emplace_back(line.data() + at);
  return words;
}

int waitFor(pid_t child) {
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

}  // namespace palpate
