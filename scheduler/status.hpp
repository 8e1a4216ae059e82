#pragma once

#include <string>
#include <vector>

#include "proto/palpate.pb.h"
#include "scheduler/plan/space_plan.hpp"
#include "scheduler/state/job_store.hpp"

namespace palpate {

/// Fills spaces, ready, may_grow, failed_attempts and failed_points. `names` are those of the
/// active nodes, parallel to `plans`.
void addPlans(wire::Status& status, const std::vector<SpacePlan>& plans,
              const std::vector<std::string>& names);
void addWorker(wire::Status& status, const ServerRow& row);

/// A Status as the JSON of StatusReply, and back. Error when the text is not one.
std::string toJson(const wire::Status& status);
wire::Status statusFromJson(const std::string& json);

/// The status as a page of text for people, with a line feed at the end.
std::string describe(const wire::Status& status);

/// One line for a progress display: "312/515 points, 28.1/s, frontier 40, 2 workers, 7 s left".
std::string progressLine(const wire::Status& status);

/// "7 s", "12 min", "3 h 20 min".
std::string durationText(double seconds);

}  // namespace palpate
