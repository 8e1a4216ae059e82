#include "common/base/program.hpp"

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <cctype>
#include <csignal>
#include <cstdint>
#include <ctime>
#include <vector>

#include "common/base/log_lines.hpp"

namespace palpate {
namespace {

bool log_is_json = false;  ///< set when the command line is parsed
constexpr const char* log_format_variable = "PALPATE_LOG_FORMAT";

/// Signals at most this far apart, ms, are assumed to have one cause (interrupted()).
constexpr std::int64_t same_interrupt = 1000;

/// Time of the first signal, CLOCK_MONOTONIC, ms; 0 before that signal.
std::atomic<std::int64_t> first_interrupt = 0;
static_assert(decltype(first_interrupt)::is_always_lock_free, "signal handlers must not wait");

void onInterrupt(int) {
  timespec time{};
  clock_gettime(CLOCK_MONOTONIC, &time);
  const std::int64_t now = 1000 * std::int64_t{time.tv_sec} + time.tv_nsec / 1000000;
  std::int64_t first = 0;
  if (!first_interrupt.compare_exchange_strong(first, now) && now - first > same_interrupt)
    _exit(static_cast<int>(ExitCode::interrupted));
}

void logToStderr(int verbosity, const std::string& verb) {
  // Log to stderr, because other programs read results from stdout.
  auto logger = spdlog::stderr_color_mt("palpate");
  if (log_is_json)
    logger->set_formatter(jsonLines(program_invocation_short_name, verb));
  else
    logger->set_pattern("%Y-%m-%d %H:%M:%S %^%l%$ %v");
  spdlog::set_default_logger(logger);
  spdlog::set_level(verbosity < 0   ? spdlog::level::warn
                    : verbosity > 0 ? spdlog::level::debug
                                    : spdlog::level::info);
}

/// Prints the error that ends a verb, on one line.
void tellError(const std::string& verb, const std::string& what) {
  if (log_is_json)
    spdlog::critical("{}", what);
  else
    tell("palpate {}: {}\n", verb, what);
}

/// Error if the limit of file descriptors is very low. Without a free descriptor ZeroMQ aborts, and
/// other libraries fail with unclear messages.
void refuseFewDescriptors() {
  constexpr rlim_t fewest = 64;
  struct rlimit limit {};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) throw failure("getrlimit failed: {}", errnoText());
  if (limit.rlim_cur < fewest)
    throw failure(
        "this process may open only {} files and connections, but needs {}; run: ulimit -n {}",
        limit.rlim_cur, fewest, 1024);
}

ExitCode runVerb(const std::string& verb, const std::function<ExitCode()>& run) {
  try {
    refuseFewDescriptors();
    // Let writes beyond the file size limit fail. By default SIGXFSZ kills the process.
    std::signal(SIGXFSZ, SIG_IGN);
    const ExitCode code = run();
    // Flush now, because only this shows whether all output was written.
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
      throw failure("cannot write the answer to standard output; is the disk full?");
    return code;
  } catch (const Error& error) {
    tellError(verb, error.what());
    return error.exitCode();
  } catch (const std::bad_alloc&) {
    tellError(verb,
              "out of memory; close other programs, raise the memory limit, or use a coarser mesh");
    return ExitCode::failed;
  } catch (const std::exception& error) {
    tellError(verb, std::string("unexpected: ") + error.what());
    return ExitCode::failed;
  }
}

/// Adds the meaning of the exit codes to the verb's --help, unless its text already explains them.
void sayExitCodes(CLI::App& verb) {
  const std::string own = verb.get_footer();
  if (own.find("Exit codes:") != std::string::npos) return;
  verb.footer(own + (own.empty() ? "" : "\n") +
              "Exit codes: 0 done, 1 failed, 2 wrong usage or scene, 130 interrupted.");
}

int refuseUsage(const CLI::App& app, const CLI::ParseError& error) {
  const auto chosen = app.get_subcommands();
  const std::string command = "palpate" + (chosen.empty() ? "" : " " + chosen.front()->get_name());
  tell("{}: {}; see {} --help\n", command, error.what(), command);
  return static_cast<int>(ExitCode::usage);
}

/// Returns the arguments, the last one first, as CLI11 takes them. Replaces arguments such as "-.5"
/// by "-0.5", because CLI11 would read "-.5" as an option.
std::vector<std::string> argumentsForParser(int argc, char** argv) {
  std::vector<std::string> arguments(std::reverse_iterator(argv + argc),
                                     std::reverse_iterator(argv + 1));
  for (std::string& argument : arguments)
    if (argument.size() > 2 && argument.starts_with("-.") &&
        std::isdigit(static_cast<unsigned char>(argument[2])))
      argument.insert(1, "0");
  return arguments;
}

}  // namespace

bool logIsJson() { return log_is_json; }

const char* version() { return PALPATE_VERSION; }

std::string buildName() {
  const std::string_view of = commit();
  return of == "unknown" ? version() : fmt::format("{} ({})", version(), of);
}

std::filesystem::path programBeside(const std::string& name) {
  std::filesystem::path program =
      std::filesystem::read_symlink("/proc/self/exe").parent_path() / name;
  if (access(program.c_str(), X_OK) != 0)
    throw failure("{}: not found; is Palpate completely installed?", program.string());
  return program;
}

bool interrupted() { return first_interrupt != 0; }

void catchInterrupts() {
  struct sigaction action {};
  action.sa_handler = onInterrupt;
  sigemptyset(&action.sa_mask);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction before {};
    // Keep SIGHUP ignored if nohup ignored it, so that the program outlives the terminal.
    if (sigaction(signal, nullptr, &before) == 0 && signal == SIGHUP &&
        before.sa_handler == SIG_IGN)
      continue;
    if (sigaction(signal, &action, nullptr) != 0)
      throw failure("signal {} cannot be caught: {}", signal, errnoText());
  }
}

int runProgram(int argc, char** argv, const char* description, std::span<const Verb> verbs) {
  CLI::App app{description, "palpate"};
  app.set_version_flag("--version", std::string("palpate ") + version());
  app.require_subcommand(1);

  bool quiet = false, verbose = false;
  std::string chosen, log_format = "text";
  std::function<ExitCode()> run;
  for (const Verb& verb : verbs) {
    CLI::App* sub = app.add_subcommand(verb.name, verb.summary);
    sub->add_flag("-q,--quiet", quiet, "Log only warnings and errors");
    sub->add_flag("-v,--verbose", verbose, "Log more details");
    sub->add_option("--log-format", log_format, "Log format on stderr: text or json [text]")
        ->check(CLI::IsMember({"text", "json"}))
        ->envname(log_format_variable)
        ->type_name("WORD");
    auto prepared = verb.prepare(*sub);
    sayExitCodes(*sub);
    sub->callback([&chosen, &run, prepared, name = verb.name] {
      chosen = name;
      run = prepared;
    });
  }
  try {
    app.parse(argumentsForParser(argc, argv));
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() != 0) return refuseUsage(app, error);
    app.exit(error);  // prints the text of --help or --version
    return static_cast<int>(ExitCode::done);
  }
  log_is_json = log_format == "json";
  setenv(log_format_variable, log_format.c_str(), 1);
  logToStderr(verbose ? 1 : quiet ? -1 : 0, chosen);
  return static_cast<int>(runVerb(chosen, run));
}

}  // namespace palpate
