#include "scheduler/service/status.hpp"

#include <google/protobuf/util/json_util.h>

#include <limits>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "scheduler/service/worker_registry.hpp"

namespace palpate {

namespace {

void addCounts(wire::SpaceStatus& row, const PointCounts& counts) {
  row.set_unknown(row.unknown() + counts.of(Tag::unknown));
  row.set_expandable(row.expandable() + counts.of(Tag::expandable));
  row.set_terminating(row.terminating() + counts.of(Tag::terminating));
  row.set_failed(row.failed() + counts.of(Tag::failed));
  row.set_points(row.unknown() + row.expandable() + row.terminating() + row.failed());
}

void addCauses(google::protobuf::Map<std::string, std::int32_t>& causes,
               const CountsOfCauses& counts) {
  for (std::size_t cause = 0; cause < counts.size(); ++cause)
    if (counts[cause] > 0)
      causes[std::string(name(static_cast<Cause>(cause)))] +=
          static_cast<std::int32_t>(counts[cause]);
}

/// Returns the row that counts an active node. All places where an area is measured share one row,
/// in which each place counts as one point.
wire::SpaceStatus& rowFor(wire::Status& status, const ActiveSelection& active) {
  const std::string name = rowNameOf(active);
  if (active.isProbe())
    for (wire::SpaceStatus& row : *status.mutable_spaces())
      if (row.name() == name) return row;
  status.add_spaces()->set_name(name);
  return *status.mutable_spaces()->rbegin();
}

/// Returns true if the counts of all spaces, and their sums, are possible for a build.
bool countsMakeSense(const wire::Status& status) {
  std::int64_t sum = 0;
  for (const wire::SpaceStatus& space : status.spaces()) {
    std::int64_t points = 0;
    for (const std::int32_t count :
         {space.unknown(), space.expandable(), space.terminating(), space.failed()}) {
      if (count < 0) return false;
      points += count;
    }
    if (points > space.points()) return false;
    sum += space.points();
  }
  return sum <= std::numeric_limits<std::int32_t>::max();
}

/// Removes the unknown fields in which protobuf's JSON parser keeps parts of an unknown object.
/// Message::DiscardUnknownFields is not used, because library code would then access maps, whose
/// layout differs under the thread sanitizer.
void discardUnknownFields(wire::Status& status) {
  const auto discard = [](google::protobuf::Message& message) {
    message.GetReflection()->MutableUnknownFields(&message)->Clear();
  };
  discard(status);
  for (wire::SpaceStatus& row : *status.mutable_spaces()) discard(row);
  for (wire::WorkerStatus& row : *status.mutable_workers()) discard(row);
  for (wire::KeptOut& row : *status.mutable_kept_out()) discard(row);
}

}  // namespace

void addPoint(wire::Status& status, wire::SpaceStatus& space, const PointRecord& point) {
  PointCounts one;
  one.of_tag[static_cast<std::size_t>(point.tag)] = 1;
  addCounts(space, one);
  if (point.tag == Tag::failed) ++(*status.mutable_failed_points())[std::string(name(point.cause))];
}

wire::SpaceStatus sumOf(const wire::Status& status) {
  wire::SpaceStatus sum;
  sum.set_name("all");
  for (const wire::SpaceStatus& space : status.spaces())
    addCounts(sum, {.of_tag = {space.unknown(), space.expandable(), space.terminating(),
                               space.failed()}});
  return sum;
}

std::string rowNameOf(const ActiveSelection& active) {
  return active.isProbe() ? "probes of " + active.probe_of : active.name;
}

void setPriorities(wire::Status& status, const std::map<std::string, std::int32_t>& priorities) {
  for (wire::SpaceStatus& row : *status.mutable_spaces())
    if (const auto found = priorities.find(row.name()); found != priorities.end())
      row.set_priority(found->second);
}

wire::Status statusOf(const Problem& problem, const std::vector<SpacePlan>& plans) {
  PALPATE_ASSERT(plans.size() == problem.active.size(), "each active node must have a plan");
  wire::Status status;
  status.set_scene(problem.scene.name);
  for (std::size_t p = 0; p < plans.size(); ++p) {
    const SpacePlan& plan = plans[p];
    const ActiveSelection& active = problem.scene.active[p];
    wire::SpaceStatus& row = rowFor(status, active);
    // A row that counts several plans shows the stage of an incomplete one, if there is any.
    if (row.stage().empty() || plan.stage() != Stage::complete)
      row.set_stage(std::string(name(plan.stage())));
    const CompactPoints& points = plan.points();
    // A place where an area is measured counts as one point, its probe; its rest position is left
    // out. Before its probe exists, the place counts as an unknown point.
    if (active.isProbe() && plan.size() == 1)
      addPoint(status, row, {});
    else if (!active.isProbe())
      addCounts(row, points.uniform());
    addCounts(row, points.added());
    CountsOfCauses failed = points.failedPoints();
    if (active.isProbe() && points.tag(0) == Tag::failed)
      --failed[static_cast<std::size_t>(points.cause(0))];
    addCauses(*status.mutable_failed_points(), failed);
    addCauses(*status.mutable_failed_attempts(), points.failedAttempts());
    status.set_may_grow(status.may_grow() || plan.mayGrow());
    status.set_ready(status.ready() + plan.openCount());
  }
  return status;
}

wire::Status progressOf(const Problem& problem, const ContentId& build,
                        const std::vector<SpacePlan>& plans, const std::string& kernel_family,
                        bool complete) {
  wire::Status status = statusOf(problem, plans);
  status.set_build(build.hex());
  status.set_kernel_family(kernel_family);
  status.set_state(complete ? "complete" : "stopped");
  return status;
}

void addServers(wire::Status& status, const std::vector<wire::WorkerStatus>& servers,
                const Counters& counters) {
  for (const wire::WorkerStatus& row : servers) {
    wire::WorkerStatus& worker = *status.add_workers();
    worker = row;
    // Shorten the id to as many digits as users need to tell workers apart.
    worker.set_worker(row.worker().substr(0, 8));
  }
  for (const auto& [name, value] : counters)
    (*status.mutable_counters())[name] = static_cast<std::int32_t>(value);
}

void addKeptOut(wire::Status& status, const std::vector<KeptOut>& kept_out) {
  for (const auto& [kind, who, reason] : kept_out) {
    wire::KeptOut& row = *status.add_kept_out();
    row.set_kind(std::string(name(kind)));
    if (kind == KeptOut::Kind::process) row.set_worker(hexOf(who.worker()));
    if (kind != KeptOut::Kind::key) row.set_host(who.host());
    if (const auto key = PublicKey::fromBytes(who.key())) row.set_key(key->hex());
    row.set_reason(reason);
  }
}

void addDisk(wire::Status& status, const std::filesystem::path& directory,
             std::uint64_t journal_bytes) {
  std::error_code unknown;
  const std::filesystem::space_info disk = std::filesystem::space(directory, unknown);
  status.set_journal_bytes(journal_bytes);
  status.set_disk_free_bytes(unknown ? 0 : disk.available);
}

std::string toJson(const google::protobuf::Message& message) {
  google::protobuf::util::JsonPrintOptions options;
  // Print every field: scripts then need not know which fields may be missing.
  options.always_print_primitive_fields = true;
  options.preserve_proto_field_names = true;
  std::string json;
  if (const auto result = google::protobuf::util::MessageToJsonString(message, &json, options);
      !result.ok())
    throw failure("cannot write a {} as JSON: {}", message.GetTypeName(), result.ToString());
  return json;
}

wire::Status statusFromJson(const std::string& json, const std::string& source) {
  wire::Status status;
  google::protobuf::util::JsonParseOptions options;
  // A newer scheduler may have more fields.
  options.ignore_unknown_fields = true;
  if (const auto result = google::protobuf::util::JsonStringToMessage(json, &status, options);
      !result.ok())
    throw failure("{}: not a status that this version can read: {}", source, result.ToString());
  discardUnknownFields(status);
  if (!countsMakeSense(status))
    throw failure("{}: not a status: its numbers of points are inconsistent", source);
  return status;
}

}  // namespace palpate
