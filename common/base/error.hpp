#pragma once

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <string>
#include <utility>

namespace palpate {

/// Process exit codes of every program (contract).
enum class ExitCode { done = 0, failed = 1, usage = 2, partly_failed = 3, interrupted = 130 };

/// What the user gave, or what the machine did, made it impossible to go on. Thrown, never for
/// expected numerical failure: that is a Failure (failure.hpp) and travels as a value.
///
/// The message says what happened, where (file, line, key, id) and what to do about it.
class Error : public std::runtime_error {
 public:
  Error(ExitCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  ExitCode exitCode() const { return code_; }

 private:
  ExitCode code_;
};

/// What errno says, in words. Before anything else is called: that may change it.
inline std::string errnoText() {
  return errno == EFBIG ? "the limit of file sizes is reached (ulimit -f)" : std::strerror(errno);
}

/// The scene, the mesh or the command line is wrong; the process ends with exit code 2.
template <class... Args>
Error badInput(fmt::format_string<Args...> format, Args&&... args) {
  return {ExitCode::usage, fmt::format(format, std::forward<Args>(args)...)};
}

/// The input was right and something else went wrong (disk, network, library); exit code 1.
template <class... Args>
Error failure(fmt::format_string<Args...> format, Args&&... args) {
  return {ExitCode::failed, fmt::format(format, std::forward<Args>(args)...)};
}

/// Writes to stderr for people. Unlike fmt::print it does not throw where that finds no room: the
/// full disk behind a log must not end a night's work.
template <class... Args>
void tell(fmt::format_string<Args...> format, Args&&... args) {
  std::fputs(fmt::format(format, std::forward<Args>(args)...).c_str(), stderr);
}

}  // namespace palpate
