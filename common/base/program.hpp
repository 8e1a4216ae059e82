#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>

#include "common/base/error.hpp"

// Its header takes seconds to compile: who declares options includes it.
namespace CLI {
class App;
}

namespace palpate {

/// A verb of one of the programs, for instance `check`. `prepare` declares its options on `app` and
/// returns what runs after they were parsed; options live in a std::shared_ptr captured by that
/// function.
struct Verb {
  const char* name;
  const char* summary;  ///< one line, for --help
  std::function<ExitCode()> (*prepare)(CLI::App& app);
};

/// The main() of palpate-scheduler, palpate-worker, palpate-verify, palpate-viewer and palpate-answers: parses, runs
/// the verb, and turns every exception into one line on stderr ("palpate VERB: what happened") and
/// an exit code. Unknown options end with code 2. Also reads the common options --version,
/// -q/--quiet, -v/--verbose and --log-format, which programs that this one starts inherit by their
/// environment (PALPATE_LOG_FORMAT). Logs go to stderr.
int runProgram(int argc, char** argv, const char* description, std::span<const Verb> verbs);

/// Whether other programs read the log (--log-format json): then all that goes to stderr is to be
/// lines of it, and nothing may be drawn there.
bool logIsJson();

/// The program's version, "0.1.0".
const char* version();
/// The commit that it was built from, "1a2b3c4", or "1a2b3c4+changed" where its sources were
/// edited; "unknown" where they were in no git repository.
const char* commit();
/// Version and commit, if that is known: "0.1.0 (1a2b3c4)". Programs of two builds may differ in
/// the last bits of what they compute.
std::string buildName();

/// The program of this name that is installed beside the running one, for instance
/// "palpate-worker". Error when it is not there.
std::filesystem::path programBeside(const std::string& name);

/// True once SIGINT, SIGTERM or SIGHUP (unless that was ignored) came in, after catchInterrupts().
/// A second signal ends the process at once with code 130, unless it follows the first within a
/// second: timeout(1) signals a process and then its group, and Ctrl-C in a terminal reaches
/// children that are told to end by their parent too.
bool interrupted();
/// Error with the exit code of an interrupt, once interrupted(): for work that has replaced nothing
/// yet.
inline void endWhenInterrupted() {
  if (interrupted()) throw Error(ExitCode::interrupted, "interrupted; nothing was written");
}

/// Makes interrupted() see signals from now on; to be called once, by the main thread. Error when
/// the system refuses.
void catchInterrupts();

}  // namespace palpate
