#pragma once

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <string>
#include <utility>

namespace palpate {

/// Exit codes of every program; part of the interface.
enum class ExitCode { done = 0, failed = 1, usage = 2, partly_failed = 3, interrupted = 130 };

/// Thrown if wrong input or a failing system makes it impossible to continue. A solve that does not
/// converge is not an exception, but returns a Failure (failure.hpp).
///
/// The message gives the problem, its place (file, line, key, id) and the remedy.
class Error : public std::runtime_error {
 public:
  Error(ExitCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  ExitCode exitCode() const { return code_; }

 private:
  ExitCode code_;
};

/// Returns errno as text. Call it directly after the failed call; other calls may change errno.
inline std::string errnoText() {
  return errno == EFBIG ? "the file size limit is reached (ulimit -f)" : std::strerror(errno);
}

/// Returns an Error with exit code 2: the scene, the mesh or the command line is wrong.
template <class... Args>
Error badInput(fmt::format_string<Args...> format, Args&&... args) {
  return {ExitCode::usage, fmt::format(format, std::forward<Args>(args)...)};
}

/// Returns an Error with exit code 1: the input is right, but something else failed (disk, network,
/// library).
template <class... Args>
Error failure(fmt::format_string<Args...> format, Args&&... args) {
  return {ExitCode::failed, fmt::format(format, std::forward<Args>(args)...)};
}

/// Writes a message to stderr. Unlike fmt::print, it does not throw if writing fails, because a log
/// on a full disk must not end a long run.
template <class... Args>
void tell(fmt::format_string<Args...> format, Args&&... args) {
  std::fputs(fmt::format(format, std::forward<Args>(args)...).c_str(), stderr);
}

}  // namespace palpate
