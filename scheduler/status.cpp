#include "scheduler/status.hpp"

#include <google/protobuf/util/json_util.h>

#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "common/base/error.hpp"

namespace palpate {

void addPlans(wire::Status& status, const std::vector<SpacePlan>& plans,
              const std::vector<std::string>& names) {
  std::int32_t ready = 0;
  for (std::size_t n = 0; n < plans.size(); ++n) {
    const SpacePlan& plan = plans[n];
    std::array<std::int32_t, 4> count{};
    for (std::int32_t point = 0; point < plan.size(); ++point) {
      const PointRecord& record = plan.record(point);
      ++count.at(static_cast<std::size_t>(record.tag));
      for (const FailedAttempt& attempt : plan.attempts(point))
        ++(*status.mutable_failed_attempts())[std::string(name(attempt.failure.cause))];
      if (record.tag == Tag::failed)
        ++(*status.mutable_failed_points())[std::string(name(record.cause))];
    }
    wire::SpaceStatus& space = *status.add_spaces();
    space.set_name(names[n]);
    space.set_points(plan.size());
    space.set_unknown(count[static_cast<std::size_t>(Tag::unknown)]);
    space.set_expandable(count[static_cast<std::size_t>(Tag::expandable)]);
    space.set_terminating(count[static_cast<std::size_t>(Tag::terminating)]);
    space.set_failed(count[static_cast<std::size_t>(Tag::failed)]);
    space.set_stage(std::string(name(plan.stage())));
    status.set_may_grow(status.may_grow() || plan.mayGrow());
    ready += plan.open();
  }
  status.set_ready(ready);
}

void addWorker(wire::Status& status, const ServerRow& row) {
  wire::WorkerStatus& worker = *status.add_workers();
  worker.set_worker(row.worker.substr(0, 8));
  worker.set_host(row.host);
  worker.set_pid(row.pid);
  worker.set_kernel_family(row.kernel_family);
  worker.set_state(row.state);
  worker.set_heard_seconds_ago(row.heard_before);
  worker.set_results(static_cast<std::int32_t>(row.results));
}

std::string toJson(const wire::Status& status) {
  google::protobuf::util::JsonPrintOptions options;
  options.always_print_primitive_fields = true;
  options.preserve_proto_field_names = true;
  std::string json;
  if (const auto result = google::protobuf::util::MessageToJsonString(status, &json, options);
      !result.ok())
    throw failure("the status cannot be written as JSON: {}", result.ToString());
  return json;
}

wire::Status statusFromJson(const std::string& json) {
  wire::Status status;
  google::protobuf::util::JsonParseOptions options;
  options.ignore_unknown_fields = true;
  if (const auto result = google::protobuf::util::JsonStringToMessage(json, &status, options);
      !result.ok())
    throw failure("the answer is not a status: {}", result.ToString());
  return status;
}

std::string durationText(double seconds) {
  const auto s = static_cast<std::int64_t>(std::llround(seconds));
  if (s < 120) return fmt::format("{} s", s);
  if (s < 7200) return fmt::format("{} min", (s + 30) / 60);
  return fmt::format("{} h {} min", s / 3600, s % 3600 / 60);
}

std::string progressLine(const wire::Status& status) {
  std::int64_t points = 0, unknown = 0;
  for (const wire::SpaceStatus& space : status.spaces()) {
    points += space.points();
    unknown += space.unknown();
  }
  std::string line =
      fmt::format("{}/{} points, {:.1f}/s, frontier {}, {} worker{}", points - unknown, points,
                  status.configurations_per_second(), status.ready(), status.workers_size(),
                  status.workers_size() == 1 ? "" : "s");
  if (status.has_eta_seconds())
    line += fmt::format(", {}{} left", status.may_grow() ? "an estimated " : "",
                        durationText(status.eta_seconds()));
  if (status.may_grow()) line += ", refinement may ask for more points";
  return line;
}

namespace {

/// All of them, or when they are many those that are being worked on, as far as they fit on a
/// screen, and a sum.
std::vector<wire::SpaceStatus> spacesToShow(const wire::Status& status) {
  constexpr std::size_t most = 24;
  std::vector<wire::SpaceStatus> shown(status.spaces().begin(), status.spaces().end());
  if (shown.size() <= most) return shown;
  wire::SpaceStatus sum;
  int complete = 0;
  for (const wire::SpaceStatus& s : shown) {
    sum.set_points(sum.points() + s.points());
    sum.set_unknown(sum.unknown() + s.unknown());
    sum.set_expandable(sum.expandable() + s.expandable());
    sum.set_terminating(sum.terminating() + s.terminating());
    sum.set_failed(sum.failed() + s.failed());
    complete += s.stage() == "complete" ? 1 : 0;
  }
  sum.set_name(fmt::format("all {}", shown.size()));
  sum.set_stage(fmt::format("{} complete", complete));
  std::erase_if(shown, [](const wire::SpaceStatus& s) {
    return s.stage() == "complete" || s.expandable() == 0;
  });
  if (shown.size() > most) shown.resize(most);
  shown.push_back(sum);
  return shown;
}

void appendCauses(std::string& text, const char* title,
                  const google::protobuf::Map<std::string, std::int32_t>& causes) {
  if (causes.empty()) return;
  const std::map<std::string, std::int32_t> sorted(causes.begin(), causes.end());
  std::string before = fmt::format("{}: ", title);
  for (const auto& [cause, count] : sorted)
    text += fmt::format("{}{} {}", std::exchange(before, ", "), count, cause);
  text += '\n';
}

}  // namespace

std::string describe(const wire::Status& status) {
  std::string text = fmt::format("scene {}, build {}: {}\n\n", status.scene(),
                                 status.build().substr(0, 12), status.state());
  text += fmt::format("{:<16} {:>8} {:>10} {:>11} {:>8} {:>8}  {}\n", "active node", "points",
                      "expandable", "terminating", "failed", "unknown", "stage");
  for (const wire::SpaceStatus& s : spacesToShow(status))
    text += fmt::format("{:<16} {:>8} {:>10} {:>11} {:>8} {:>8}  {}\n", s.name(), s.points(),
                        s.expandable(), s.terminating(), s.failed(), s.unknown(), s.stage());
  text += '\n';
  if (status.state() == "running" || status.state() == "stopping")
    text += progressLine(status) + '\n';
  appendCauses(text, "failed points", status.failed_points());
  appendCauses(text, "failed transitions", status.failed_attempts());
  for (const wire::WorkerStatus& w : status.workers())
    text += fmt::format("worker {} on {}: {}, {} results, heard {:.0f} s ago\n", w.pid(), w.host(),
                        w.state(), w.results(), w.heard_seconds_ago());
  for (const char* alarm : {"divergent_results", "bad_messages", "lost_workers", "refused_workers"})
    if (const auto found = status.counters().find(alarm);
        found != status.counters().end() && found->second > 0)
      text += fmt::format("{}: {}\n", alarm, found->second);
  return text;
}

}  // namespace palpate
