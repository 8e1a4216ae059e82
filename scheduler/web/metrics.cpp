#include "scheduler/web/metrics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/program.hpp"
#include "scheduler/service/status.hpp"

namespace palpate {
namespace {

/// A series for each tag of each space: of more spaces, one for all of them.
constexpr int most_spaces = 100;

using Labels = std::vector<std::pair<std::string_view, std::string>>;

/// The text, one metric after another.
class Exposition {
 public:
  void begin(std::string_view name, std::string_view type, std::string_view help) {
    name_ = name;
    text_ += fmt::format("# HELP {} {}\n# TYPE {} {}\n", name, help, name, type);
  }
  void sample(const Labels& labels, double value) {
    text_ += name_;
    for (std::size_t n = 0; n < labels.size(); ++n)
      text_ += fmt::format("{}{}=\"{}\"", n == 0 ? "{" : ",", labels[n].first,
                           escapedLabel(labels[n].second));
    text_ += fmt::format("{} {}\n", labels.empty() ? "" : "}", value);
  }
  void gauge(std::string_view name, std::string_view help, double value) {
    begin(name, "gauge", help);
    sample({}, value);
  }
  void counter(std::string_view name, std::string_view help, double value) {
    begin(name, "counter", help);
    sample({}, value);
  }
  std::string take() { return std::move(text_); }

 private:
  std::string name_, text_;
};

std::vector<wire::SpaceStatus> spacesOf(const wire::Status& status) {
  if (status.spaces_size() <= most_spaces) return {status.spaces().begin(), status.spaces().end()};
  return {sumOf(status)};
}

void addWork(Exposition& out, const wire::Status& status) {
  out.begin("palpate_points", "gauge", "Lattice points by space and tag.");
  for (const wire::SpaceStatus& space : spacesOf(status))
    for (const auto& [tag, count] : {std::pair{"unknown", space.unknown()},
                                     {"expandable", space.expandable()},
                                     {"terminating", space.terminating()},
                                     {"failed", space.failed()}})
      out.sample({{"space", space.name()}, {"tag", tag}}, count);
  std::map<std::string, int> stages;
  for (const wire::SpaceStatus& space : status.spaces()) ++stages[space.stage()];
  out.begin("palpate_spaces", "gauge", "Spaces by the stage they are in.");
  for (const auto& [stage, count] : stages) out.sample({{"stage", stage}}, count);
  out.gauge("palpate_ready_transitions", "Size of the frontier: what could be solved now.",
            status.ready());
  out.counter("palpate_results_total", "Results recorded by this run of the scheduler.",
              status.recorded());
  out.gauge("palpate_configurations_per_second", "Equilibria found per second, of two minutes.",
            status.configurations_per_second());
  if (status.has_eta_seconds())
    out.gauge("palpate_eta_seconds", "Time left, where it can be told.", status.eta_seconds());
  if (status.has_eta_low_seconds())
    out.gauge("palpate_eta_low_seconds", "The time left is expected above this.",
              status.eta_low_seconds());
  if (status.has_eta_high_seconds())
    out.gauge("palpate_eta_high_seconds", "The time left is expected below this.",
              status.eta_high_seconds());
}

void addFailures(Exposition& out, const wire::Status& status) {
  using Causes = google::protobuf::Map<std::string, std::int32_t>;
  const auto byCause = [&](const char* name, const char* help, const Causes& causes) {
    out.begin(name, "gauge", help);
    for (const auto& [cause, count] : std::map(causes.begin(), causes.end()))
      out.sample({{"cause", cause}}, count);
  };
  byCause("palpate_failed_attempts", "Transitions that failed, by cause.",
          status.failed_attempts());
  byCause("palpate_failed_points", "Points that failed, by cause.", status.failed_points());
  out.gauge("palpate_set_aside_transitions", "Transitions that workers ended on.",
            status.set_aside());
  out.gauge("palpate_open_checks", "Results that other workers are to solve again.",
            status.checks_open());
  out.gauge("palpate_disputed_results", "Results that two workers found differently.",
            status.disputed());
  out.gauge("palpate_kept_out", "Workers, machines and keys whose results were wrong.",
            status.kept_out_size());
}

void addWorkers(Exposition& out, const wire::Status& status) {
  std::map<std::pair<std::string, std::string>, int> workers;
  for (const wire::WorkerStatus& worker : status.workers())
    ++workers[{worker.host(), worker.state()}];
  out.begin("palpate_workers", "gauge", "Workers by host and state.");
  for (const auto& [who, count] : workers)
    out.sample({{"host", who.first}, {"state", who.second}}, count);
}

/// Those of docs/state.md: 0 where nothing of the kind ever happened.
void addCounters(Exposition& out, const wire::Status& status) {
  constexpr std::array<std::pair<const char*, const char*>, 13> counters = {
      {{"runs", "Starts of a scheduler in this directory."},
       {"lost_workers", "Workers that went without a word."},
       {"refused_workers", "Workers that were refused."},
       {"duplicate_results", "Results that were recorded already."},
       {"divergent_results", "Second results with other bits: a machine computes wrongly."},
       {"unwanted_results", "Results that nobody asked for."},
       {"bad_messages", "Messages that were dropped."},
       {"checked_results", "Results that others confirmed or refuted."},
       {"unchecked_results", "Checks that were given up for want of another machine."},
       {"wrong_results", "Those who were found to lie."},
       {"overdue_targets", "Targets that were given to others while somebody held them."},
       {"closed_connections", "Connections that were closed because they cost too much."},
       {"unread_answers", "Questions left unanswered because answers lay unread."}}};
  for (const auto& [counter, help] : counters) {
    const auto found = status.counters().find(counter);
    out.counter(fmt::format("palpate_{}_total", counter), help,
                found == status.counters().end() ? 0 : found->second);
  }
}

void addService(Exposition& out, const wire::Status& status, double age) {
  out.begin("palpate_info", "gauge", "1; its labels say which build this is.");
  out.sample({{"scene", status.scene()},
              {"build", status.build()},
              {"version", version()},
              {"kernel_family", status.kernel_family()}},
             1);
  out.begin("palpate_state", "gauge", "1 for the state the scheduler is in.");
  for (const char* state : {"running", "stopping", "complete"})
    out.sample({{"state", state}}, status.state() == state ? 1 : 0);
  out.gauge("palpate_paused", "1 while nothing is handed out, as an operator asked.",
            status.paused() ? 1 : 0);
  out.gauge("palpate_run_seconds", "Since this run of the scheduler began.", status.seconds());
  out.gauge("palpate_status_age_seconds",
            "Since the scheduler said all this: it grows while it reads or seals.", age);
  out.gauge("palpate_journal_bytes", "Size of the journal.",
            static_cast<double>(status.journal_bytes()));
  out.gauge("palpate_disk_free_bytes", "What the disk of the state directory has left.",
            static_cast<double>(status.disk_free_bytes()));
}

}  // namespace

std::string escapedLabel(std::string_view value) {
  std::string escaped;
  for (const char c : value) {
    if (c == '\\' || c == '"') escaped += '\\';
    escaped += c == '\n' ? std::string("\\n") : std::string(1, c);
  }
  return escaped;
}

std::string metricsOf(const wire::Status& status, double age) {
  Exposition out;
  addService(out, status, age);
  addWork(out, status);
  addFailures(out, status);
  addWorkers(out, status);
  addCounters(out, status);
  return out.take();
}

}  // namespace palpate
