#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>

#include "common/base/error.hpp"

// CLI11 takes seconds to compile, so only files that declare options include it.
namespace CLI {
class App;
}

namespace palpate {

/// A verb of a program, such as `check`. `prepare` declares its options on `app` and returns the
/// function that runs after parsing. That function captures the options in a std::shared_ptr.
struct Verb {
  const char* name;
  const char* summary;  ///< one line, for --help
  std::function<ExitCode()> (*prepare)(CLI::App& app);
};

/// The main() of palpate-scheduler, palpate-worker, palpate-verify, palpate-viewer and
/// palpate-answers. It parses the command line and runs the verb. Every exception becomes an exit
/// code and one line on stderr ("palpate VERB: MESSAGE"). Exit code 2 stands for unknown options.
/// It also reads the common options --version, -q/--quiet, -v/--verbose and --log-format. Programs
/// that this one starts inherit --log-format through the environment (PALPATE_LOG_FORMAT). Logs go
/// to stderr.
int runProgram(int argc, char** argv, const char* description, std::span<const Verb> verbs);

/// Returns whether the log is JSON for other programs (--log-format json). Everything on stderr
/// must then be log lines, and nothing may be drawn there.
bool logIsJson();

/// Returns the version of the program, such as "0.1.0".
const char* version();
/// Returns the commit of the build, such as "1a2b3c4", or "1a2b3c4+changed" for edited sources;
/// "unknown" outside a git repository.
const char* commit();
/// Returns version and commit, if known: "0.1.0 (1a2b3c4)". Results of two builds may differ in
/// their last bits.
std::string buildName();

/// Returns the path of the program `name` ("palpate-worker") in the folder of the running one.
/// Error if it is not there.
std::filesystem::path programBeside(const std::string& name);

/// Returns true after SIGINT, SIGTERM or SIGHUP (unless that was ignored at start), once
/// catchInterrupts() was called. A second signal ends the process at once with code 130, unless it
/// follows the first within a second. Such pairs have one cause: timeout(1) signals a process and
/// then its group, and Ctrl-C in a terminal also reaches children that their parent stops.
bool interrupted();
/// Error with the exit code of an interrupt if interrupted(). For work that has not replaced any
/// file yet.
inline void endWhenInterrupted() {
  if (interrupted()) throw Error(ExitCode::interrupted, "interrupted; nothing was written");
}

/// Makes interrupted() see signals from now on. Call once, from the main thread. Error if the
/// system refuses.
void catchInterrupts();

}  // namespace palpate
