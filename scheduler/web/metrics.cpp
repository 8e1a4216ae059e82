#include "scheduler/web/metrics.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <map>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/program.hpp"
#include "scheduler/service/status.hpp"

namespace palpate {
namespace {

/// If there are more spaces than this, the metrics of points are given only for all spaces
/// together.
constexpr int most_spaces = 100;

using Labels = std::vector<std::pair<std::string_view, std::string>>;
/// The values of one metric, sorted by labels.
using Series = std::map<Labels, double>;

/// A metric with a single value.
struct Gauge {
  const char* name;
  const char* help;
  std::optional<double> value;  ///< nullopt if unknown
};

/// The counters of docs/internals/state.md with their help. They are exported as
/// palpate_NAME_total; a missing counter is 0.
constexpr auto counter_help = std::to_array<std::pair<const char*, const char*>>(
    {{"runs", "Starts of a scheduler in this directory."},
     {"lost_workers", "Workers that ended or fell silent without notice."},
     {"refused_workers", "Workers that were refused."},
     {"duplicate_results", "Results of transitions that already had a recorded result."},
     {"divergent_results", "Second results with different bits: a machine computes wrongly."},
     {"unwanted_results", "Results that the scheduler did not request."},
     {"bad_messages", "Invalid messages, which were dropped."},
     {"checked_results", "Results that other workers confirmed or refuted."},
     {"unchecked_results", "Checks that were given up because no other machine was available."},
     {"wrong_results", "Workers, machines or keys excluded because a result was wrong."},
     {"overdue_targets", "Overdue solves that were also given to another worker."},
     {"closed_connections", "Connections closed because of too large or too many messages."},
     {"unread_answers", "Requests not answered because the client left earlier answers unread."}});

std::vector<Gauge> gaugesOf(const wire::Status& status, double age) {
  const auto ifKnown = [](bool known, double value) {
    return known ? std::optional(value) : std::nullopt;
  };
  return {
      {"palpate_paused", "1 while an operator has paused the build.",
       static_cast<double>(status.paused())},
      {"palpate_run_seconds", "Seconds since this run of the scheduler began.", status.seconds()},
      {"palpate_status_age_seconds",
       "Age of these values; grows while the scheduler reads or seals.", age},
      {"palpate_journal_bytes", "Size of the journal.",
       static_cast<double>(status.journal_bytes())},
      {"palpate_disk_free_bytes", "Free space on the disk of the state directory.",
       static_cast<double>(status.disk_free_bytes())},
      {"palpate_ready_transitions", "Transitions that are ready to be solved.", status.ready()},
      {"palpate_configurations_per_second",
       "Equilibria found per second, averaged over two minutes.",
       status.configurations_per_second()},
      {"palpate_eta_seconds", "Estimated time left; absent if unknown.",
       ifKnown(status.has_eta_seconds(), status.eta_seconds())},
      {"palpate_eta_low_seconds", "Lower estimate of the time left.",
       ifKnown(status.has_eta_low_seconds(), status.eta_low_seconds())},
      {"palpate_eta_high_seconds", "Upper estimate of the time left.",
       ifKnown(status.has_eta_high_seconds(), status.eta_high_seconds())},
      {"palpate_set_aside_transitions", "Transitions that wait for palpate retry.",
       status.set_aside()},
      {"palpate_open_checks", "Results that other workers are to solve again.",
       status.checks_open()},
      {"palpate_disputed_results", "Results about which two workers disagree.", status.disputed()},
      {"palpate_kept_out", "Workers, machines and keys excluded because of wrong results.",
       status.kept_out_size()}};
}

std::string metric(std::string_view name, const char* type, std::string_view help,
                   const Series& series) {
  std::string text = fmt::format("# HELP {0} {1}\n# TYPE {0} {2}\n", name, help, type);
  for (const auto& [labels, value] : series) {
    std::vector<std::string> words;
    for (const auto& [label, word] : labels)
      words.push_back(fmt::format("{}=\"{}\"", label, escapedLabel(word)));
    const std::string all = fmt::format("{}", fmt::join(words, ","));
    text += fmt::format("{}{} {}\n", name, all.empty() ? "" : '{' + all + '}', value);
  }
  return text;
}

Series single(double value) { return {{Labels{}, value}}; }

Series pointsOf(const wire::Status& status) {
  Series points;
  const auto add = [&](const wire::SpaceStatus& space) {
    for (const auto& [tag, count] : {std::pair{"unknown", space.unknown()},
                                     {"expandable", space.expandable()},
                                     {"terminating", space.terminating()},
                                     {"failed", space.failed()}})
      points[{{"space", space.name()}, {"tag", tag}}] = count;
  };
  if (status.spaces_size() > most_spaces)
    add(sumOf(status));
  else
    for (const wire::SpaceStatus& space : status.spaces()) add(space);
  return points;
}

Series byCause(const google::protobuf::Map<std::string, std::int32_t>& causes) {
  Series counts;
  for (const auto& [cause, count] : causes) counts[{{"cause", cause}}] = count;
  return counts;
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
  Series states, stages, workers;
  for (const char* state : {"running", "stopping", "complete"})
    states[{{"state", state}}] = status.state() == state ? 1 : 0;
  for (const wire::SpaceStatus& space : status.spaces()) ++stages[{{"stage", space.stage()}}];
  for (const wire::WorkerStatus& worker : status.workers())
    ++workers[{{"host", worker.host()}, {"state", worker.state()}}];
  const Labels build = {{"scene", status.scene()},
                        {"build", status.build()},
                        {"version", version()},
                        {"kernel_family", status.kernel_family()}};
  std::string text =
      metric("palpate_info", "gauge", "Always 1; the labels identify the build.",
             Series{{build, 1}}) +
      metric("palpate_state", "gauge", "1 for the current state of the scheduler.", states) +
      metric("palpate_points", "gauge", "Lattice points by space and tag.", pointsOf(status)) +
      metric("palpate_spaces", "gauge", "Spaces by stage.", stages) +
      metric("palpate_workers", "gauge", "Workers by host and state.", workers) +
      metric("palpate_failed_attempts", "gauge", "Transitions that failed, by cause.",
             byCause(status.failed_attempts())) +
      metric("palpate_failed_points", "gauge", "Points that failed, by cause.",
             byCause(status.failed_points())) +
      metric("palpate_results_total", "counter", "Results recorded by this run of the scheduler.",
             single(status.recorded()));
  for (const auto& [name, help, value] : gaugesOf(status, age))
    if (value) text += metric(name, "gauge", help, single(*value));
  for (const auto& [counter, help] : counter_help) {
    const auto found = status.counters().find(counter);
    text += metric(fmt::format("palpate_{}_total", counter), "counter", help,
                   single(found == status.counters().end() ? 0 : found->second));
  }
  return text;
}

}  // namespace palpate
