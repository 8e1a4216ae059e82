#pragma once

#include <signal.h>
#include <stdlib.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <string>

#include "common/base/error.hpp"

namespace palpate::test {

/// An Xvfb on a display of its choice, with OpenGL in software. While this object exists, the
/// environment of this process points to it. Xvfb ends with the object or the process.
class VirtualScreen {
 public:
  VirtualScreen() {
    setenv("LIBGL_ALWAYS_SOFTWARE", "1", 1);
    int ends[2] = {-1, -1};
    if (pipe(ends) != 0) throw failure("cannot make a pipe for Xvfb");
    process_ = fork();
    if (process_ == 0) become(ends);
    close(ends[1]);
    name_ = ":" + firstLine(ends[0]);
    close(ends[0]);
    if (name_ == ":") throw failure("Xvfb did not start; install the package xvfb");
    setenv("DISPLAY", name_.c_str(), 1);
  }
  ~VirtualScreen() {
    unsetenv("DISPLAY");
    kill(process_, SIGTERM);
    waitpid(process_, nullptr, 0);
  }
  VirtualScreen(const VirtualScreen&) = delete;
  VirtualScreen& operator=(const VirtualScreen&) = delete;

  const std::string& name() const { return name_; }  ///< ":7"

 private:
  [[noreturn]] static void become(const int (&ends)[2]) {
    close(ends[0]);
    prctl(PR_SET_PDEATHSIG, SIGTERM);  // a test that crashes leaves nothing behind
    const std::string out = std::to_string(ends[1]);
    execlp("Xvfb", "Xvfb", "-displayfd", out.c_str(), "-screen", "0", "1600x1000x24", "-nolisten",
           "tcp", "-noreset", static_cast<char*>(nullptr));
    _exit(127);
  }
  /// Empty if the pipe ends before a line.
  static std::string firstLine(int descriptor) {
    std::string line;
    for (char c = 0; read(descriptor, &c, 1) == 1 && c != '\n';) line += c;
    return line;
  }

  pid_t process_ = -1;
  std::string name_;
};

}  // namespace palpate::test
