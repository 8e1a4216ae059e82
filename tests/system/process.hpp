#pragma once

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <iterator>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

namespace palpate::test {

/// Waits until `condition` holds. A test that has to wait a minute is broken, not slow.
inline bool eventually(const std::function<bool()>& condition,
                       std::chrono::seconds limit = std::chrono::minutes(1)) {
  const auto deadline = std::chrono::steady_clock::now() + limit;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

/// Returns the readable part of a file, because files in /proc disappear with their process.
inline std::string contentOf(const std::filesystem::path& file) {
  std::ostringstream content;
  content << std::ifstream(file, std::ios::binary).rdbuf();
  return content.str();
}

/// The address of the scheduler that works in `state`; empty if it is not announced yet.
inline std::string endpointAnnouncedIn(const std::filesystem::path& state) {
  const std::string address = contentOf(state / "endpoint");
  return address.substr(0, address.find('\n'));
}

/// A process of a project program, or of a system program given by its full path, with its output
/// in a file. Killed when this object is destroyed.
class Process {
 public:
  Process(const std::string& program, std::vector<std::string> arguments,
          const std::filesystem::path& directory)
      : output_(directory / (std::filesystem::path(program).filename().string() + "-" +
                             std::to_string(++started_) + ".log")) {
    // A full path replaces the folder of the project.
    arguments.insert(arguments.begin(), std::filesystem::path(PALPATE_BIN_DIR) / program);
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    pid_ = fork();
    if (pid_ != 0) return;
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    // Do not use the keys of the user who runs the tests.
    setenv("PALPATE_KEYS", (directory / "keys").c_str(), 1);
    const int out = open(output_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    if (out < 0 || dup2(out, STDOUT_FILENO) < 0 || dup2(out, STDERR_FILENO) < 0 ||
        chdir(directory.c_str()) != 0)
      _exit(126);
    execv(argv[0], argv.data());
    _exit(127);
  }
  ~Process() {
    if (pid_ > 0) stop(SIGKILL);
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  pid_t pid() const { return pid_; }
  bool running() {
    if (pid_ <= 0) return false;
    siginfo_t info{};
    return waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT) == 0 &&
           info.si_pid == 0;
  }
  void signal(int number) const { kill(pid_, number); }
  /// Returns the exit code, or 128 + the signal that ended the process. A process that does not end
  /// within `limit`, which is less than the time limit of a test, is reported and killed.
  int wait(std::chrono::seconds limit = std::chrono::minutes(10)) {
    if (!eventually([&] { return !running(); }, limit)) {
      std::cerr << "process " << pid_ << " did not end within " << limit.count()
                << " s and is killed; it said:\n"
                << output() << std::endl;
      signal(SIGKILL);
    }
    int status = 0;
    waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }
  int stop(int number) {
    signal(number);
    return wait();
  }
  std::string output() const { return contentOf(output_); }
  /// Returns the child processes in any order.
  std::vector<pid_t> children() const { return childrenOf(pid_); }
  /// Returns the workers of `palpate build`, which its child watches.
  std::vector<pid_t> workers() const {
    std::vector<pid_t> all;
    for (const pid_t supervisor : children())
      for (const pid_t worker : childrenOf(supervisor)) all.push_back(worker);
    return all;
  }

 private:
  static std::vector<pid_t> childrenOf(pid_t parent) {
    const std::string name = std::to_string(parent);
    std::ifstream file("/proc/" + name + "/task/" + name + "/children");
    return {std::istream_iterator<pid_t>(file), {}};
  }

  inline static int started_ = 0;
  std::filesystem::path output_;
  pid_t pid_ = -1;
};

/// Returns whether the process prints these words, now or soon.
inline bool says(const Process& process, const std::string& words) {
  return eventually([&] { return process.output().find(words) != std::string::npos; });
}

}  // namespace palpate::test
