#include "scheduler/service/status.hpp"

#include <google/protobuf/util/json_util.h>

#include "common/base/error.hpp"

namespace palpate {

void addPoint(wire::SpaceStatus& space, Tag tag) {
  space.set_points(space.points() + 1);
  switch (tag) {
    case Tag::unknown:
      return space.set_unknown(space.unknown() + 1);
    case Tag::expandable:
      return space.set_expandable(space.expandable() + 1);
    case Tag::terminating:
      return space.set_terminating(space.terminating() + 1);
    case Tag::failed:
      return space.set_failed(space.failed() + 1);
  }
}

namespace {

void addPlan(wire::Status& status, const std::string& name_of_node, const SpacePlan& plan) {
  wire::SpaceStatus& space = *status.add_spaces();
  space.set_name(name_of_node);
  space.set_stage(std::string(name(plan.stage())));
  for (std::int32_t n = 0; n < plan.size(); ++n) {
    const PointRecord& point = plan.point(n);
    addPoint(space, point.tag);
    for (const FailedAttempt& attempt : plan.attempts(n))
      ++(*status.mutable_failed_attempts())[std::string(name(attempt.failure.cause))];
    if (point.tag == Tag::failed)
      ++(*status.mutable_failed_points())[std::string(name(point.cause))];
  }
  status.set_may_grow(status.may_grow() || plan.mayGrow());
  status.set_ready(status.ready() + plan.openCount());
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

}  // namespace

wire::Status statusOf(const Problem& problem, const std::vector<SpacePlan>& plans,
                      const std::vector<ServerRow>& servers,
                      const std::map<std::string, std::int64_t>& counters) {
  wire::Status status;
  status.set_scene(problem.scene.name);
  for (std::size_t n = 0; n < plans.size(); ++n) addPlan(status, problem.active[n].name, plans[n]);
  for (const ServerRow& row : servers) addWorker(status, row);
  for (const auto& [name, value] : counters)
    (*status.mutable_counters())[name] = static_cast<std::int32_t>(value);
  return status;
}

std::string toJson(const google::protobuf::Message& message) {
  google::protobuf::util::JsonPrintOptions options;
  options.always_print_primitive_fields = true;
  options.preserve_proto_field_names = true;
  std::string json;
  if (const auto result = google::protobuf::util::MessageToJsonString(message, &json, options);
      !result.ok())
    throw failure("a {} cannot be written as JSON: {}", message.GetTypeName(), result.ToString());
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

}  // namespace palpate
