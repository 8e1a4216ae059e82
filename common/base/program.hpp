#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "common/base/error.hpp"

// CLI11 takes seconds to compile, so only files that declare options include it.
namespace CLI {
class App;
}

namespace palpate {

/// A verb of a program, such as `check`. `prepare` declares the verb's options on `app`. It returns
/// the function that owns the options and runs the verb after the command line is parsed.
struct Verb {
  const char* name;
  const char* summary;  ///< one line, for --help
  std::function<ExitCode()> (*prepare)(CLI::App& app);
};

/// Verb::prepare for a verb whose options are a struct with the member `addTo(CLI::App&)`. The
/// returned function calls `run(options, streams...)`. Its exit code is the result of `run`, or
/// "done" if `run` returns nothing.
template <class Options, auto run, auto&... streams>
std::function<ExitCode()> prepareVerb(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  options->addTo(app);
  return [options] {
    if constexpr (!std::is_void_v<decltype(run(*options, streams...))>)
      return run(*options, streams...);
    else
      run(*options, streams...);
    return ExitCode::done;
  };
}

/// The main() of palpate-scheduler, palpate-worker, palpate-verify, palpate-viewer and
/// palpate-answers. Parses the command line, including the common options --version, -q/--quiet,
/// -v/--verbose and --log-format, and runs the verb. An exception ends the program with an exit
/// code and one line on stderr ("palpate VERB: MESSAGE"). Unknown options give exit code 2. Logs go
/// to stderr. Programs that this one starts inherit --log-format through the environment
/// (PALPATE_LOG_FORMAT).
int runProgram(int argc, char** argv, const char* description, std::span<const Verb> verbs);

/// Returns whether the log is JSON for other programs (--log-format json). If so, write nothing but
/// log lines to stderr, not even a progress display.
bool logIsJson();

/// Returns the version of the program, such as "0.1.0".
const char* version();
/// Returns the commit of the build, such as "1a2b3c4", or "1a2b3c4+changed" for edited sources;
/// "unknown" outside a git repository.
const char* commit();
/// Returns the version and, if known, the commit: "0.1.0 (1a2b3c4)". Two builds of one version may
/// compute results that differ by rounding; the commit tells them apart.
std::string buildName();

/// Returns the path of the program `name` ("palpate-worker") in the folder of the running program.
/// Error if there is no such program in that folder.
std::filesystem::path programBeside(const std::string& name);

/// Returns whether SIGINT, SIGTERM or SIGHUP has arrived since catchInterrupts() was called. SIGHUP
/// stays ignored if it was ignored at the start. A second signal ends the process at once with code
/// 130, unless it arrives within a second of the first. Two signals within a second usually have
/// one cause. For example, timeout(1) signals a process and then its group, and after Ctrl-C a
/// child gets a signal from the terminal and another one from its parent.
bool interrupted();
/// Throws an Error with the exit code of an interrupt if interrupted(). Call it only before any
/// file is replaced: the message says that nothing was written.
inline void endWhenInterrupted() {
  if (interrupted()) throw Error(ExitCode::interrupted, "interrupted; nothing was written");
}

/// Makes interrupted() see signals from now on. Call once, from the main thread. Error if the
/// system refuses.
void catchInterrupts();

}  // namespace palpate
