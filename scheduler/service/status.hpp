#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "common/problem/problem.hpp"
#include "proto/palpate.pb.h"
#include "scheduler/plan/space_plan.hpp"
#include "scheduler/state/job_store.hpp"

namespace palpate {

/// Counts one point more, with this tag.
void addPoint(wire::SpaceStatus& space, Tag tag);

/// Where a build is, as its plans, servers and counters tell: everything but `build` and `state`,
/// and what only a running scheduler knows (recorded, seconds, rate, time left).
wire::Status statusOf(const Problem& problem, const std::vector<SpacePlan>& plans,
                      const std::vector<ServerRow>& servers,
                      const std::map<std::string, std::int64_t>& counters);

/// One line of JSON with the field names of proto/palpate.proto and every field in it.
std::string toJson(const google::protobuf::Message& message);
/// The status that toJson wrote; unknown fields are passed over. Error when the text is not one.
wire::Status statusFromJson(const std::string& json);

}  // namespace palpate
