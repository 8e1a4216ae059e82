
#include "common/base/error.hpp"
#include "common/base/index.hpp"
#include "common/base/number_text.hpp"
#include "common/base/required_option.hpp"
#include "common/base/text.hpp"
#include "scheduler/builds/asked_scheduler.hpp"
#include "scheduler/builds/recorded_build.hpp"
#include "scheduler/verbs/verbs.hpp"

// Orders to a scheduler, or to the next scheduler of a state directory: `palpate stop`, `pause`,
// `resume`, `priority` and `retry`.

namespace palpate {
namespace {

void stop(const Asked& asked) {
  wire::Message question;
  question.mutable_stop_request();
  if (!order(asked, question, wire::Message::kStopReply))
    throw failure("{}: no scheduler is running there", asked.where);
  fmt::print("{}: stopping; the command that started the build continues it\n", asked.where);
}

// ---- pause, resume ----

struct PauseOptions : Asked {
  void addTo(CLI::App& app) {
    Asked::addTo(app);
    app.footer("A pause survives restarts of the scheduler.");
  }
};

template <bool paused>
void setPaused(const PauseOptions& asked) {
  wire::Message question;
  question.mutable_pause_request()->set_paused(paused);
  const bool works = order(asked, question, wire::Message::kPauseReply).has_value();
  if (!works) {
    // Refuse a directory that is not a state directory: StateDirectory would turn it into one.
    const StoredTables there{std::filesystem::path(asked.where)};
    Tables(StateDirectory(asked.where)).writePaused(paused);
  }
  fmt::print("{}: {}{}\n", asked.where, works ? "" : "the next build there ",
             !paused ? "continues"
             : works ? "paused; workers finish their assigned work and wait for palpate resume"
                     : "waits for palpate resume");
}

// ---- priority ----

struct PriorityOptions {
  Asked asked;
  std::string space;
  std::int32_t priority = 0;

  void addTo(CLI::App& app) {
    asked.addTo(app);
    addRequired(app, "SPACE", space, "Name of the space, as status prints it");
    addRequired(app, "PRIORITY", priority,
                "Priority, initially 0; spaces with a higher priority are computed first");
    app.footer("Priorities do not change the dataset.");
  }
};

/// Sets the priority in a state directory in which no scheduler runs.
void setStoredPriority(const PriorityOptions& options) {
  const auto names = mapped(progressIn(options.asked.where).spaces(), &wire::SpaceStatus::name);
  if (std::ranges::find(names, options.space) == names.end())
    throw badInput("{}: no space named {}; spaces: {}", options.asked.where, options.space,
                   fmt::join(names, ", "));
  Tables(StateDirectory(options.asked.where)).writePriority(options.space, options.priority);
}

void setPriority(const PriorityOptions& options) {
  wire::Message question;
  question.mutable_priority_request()->set_space(options.space);
  question.mutable_priority_request()->set_priority(options.priority);
  const auto answer = order(options.asked, question, wire::Message::kPriorityReply);
  if (!answer)
    setStoredPriority(options);
  else if (const std::string& objection = answer->priority_reply().objection(); !objection.empty())
    throw badInput("{}: {}", options.asked.where, printable(objection, 600));
  fmt::print("{}: {} has priority {} {}\n", options.asked.where, options.space, options.priority,
             answer ? "from now on" : "in the next build there");
}

// ---- retry ----

std::vector<std::string> namesOfCauses() {
  std::vector<std::string> names;
  for (std::uint32_t value = 0; causeOf(value); ++value)
    if (stopsTransitions(*causeOf(value))) names.emplace_back(name(*causeOf(value)));
  return names;
}

struct RetryOptions {
  Asked asked;
  std::string failed;  ///< name of a cause; if empty, retries set-aside transitions

  void addTo(CLI::App& app) {
    asked.addTo(app);
    app.add_option("--failed", failed,
                   "Repeat attempts that failed with this cause; useful if a machine was at fault")
        ->check(CLI::IsMember(namesOfCauses()));
    app.footer(
        "A solve is set aside after five workers died on it; the build continues without it.");
  }
};

/// Retries in a state directory in which no scheduler runs. Returns the number of transitions.
std::int64_t retryStored(const RetryOptions& options) {
  // Refuse a directory that is not a state directory: StateDirectory would turn it into one.
  const StoredTables there{std::filesystem::path(options.asked.where)};
  const StateDirectory directory(options.asked.where);
  const RecordedBuild build(options.asked.where);
  if (options.failed.empty()) return Tables(directory).forgetLosses();
  const std::vector<ResultKey> failed = failedWith(build.plans(), *causeNamed(options.failed));
  if (!failed.empty()) JobStore(directory, build.problem()).drop(failed);
  return std::ssize(failed);
}

void retry(const RetryOptions& options) {
  wire::Message question;
  question.mutable_retry_request()->set_cause(options.failed);
  const auto answer = order(options.asked, question, wire::Message::kRetryReply);
  const auto count = answer ? answer->retry_reply().transitions() : retryStored(options);
  fmt::print("{}: {} {} {}\n", options.asked.where,
             answer ? "retrying" : "the next build will retry", counted(count, "solve"),
             options.failed.empty() ? "set aside" : "that failed with " + options.failed);
}

}  // namespace

const Verb pause_verb = {"pause", "Give workers no work until resume; they stay connected",
                         prepareVerb<PauseOptions, setPaused<true>>};

const Verb resume_verb = {"resume", "Continue a paused build",
                          prepareVerb<PauseOptions, setPaused<false>>};

const Verb priority_verb = {"priority", "Compute one active node before others",
                            prepareVerb<PriorityOptions, setPriority>};

const Verb retry_verb = {"retry", "Repeat solves that were set aside or failed with a given cause",
                         prepareVerb<RetryOptions, retry>};

const Verb stop_verb = {
    "stop", "Let workers finish their solves, then end the build; it can continue later",
    prepareVerb<Asked, stop>};

}  // namespace palpate
