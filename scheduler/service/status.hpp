#pragma once

#include "scheduler/state/job_store.hpp"

namespace palpate {

/// Adds one point to the counts of `space`, by its tag and, if it failed, its cause.
void addPoint(wire::Status& status, wire::SpaceStatus& space, const PointRecord& point);

/// Returns the counts of all spaces together, under the name "all".
wire::SpaceStatus sumOf(const wire::Status& status);

/// Returns a status with the counts of points and attempts in the plans of a build.
wire::Status statusOf(const Problem& problem, const std::vector<SpacePlan>& plans);
/// Adds the workers (`servers`) and the counters.
void addServers(wire::Status& status, const std::vector<wire::WorkerStatus>& servers,
                const Counters& counters);
/// Returns the status that is stored in the tables (Progress) and shown when no scheduler runs:
/// that of statusOf() with `build`, `kernel_family`, and "complete" or "stopped" as `state`.
wire::Status progressOf(const Problem& problem, const ContentId& build,
                        const std::vector<SpacePlan>& plans, const std::string& kernel_family,
                        bool complete);

/// Returns the name of the status row that counts a space. All places where a finger's area is
/// measured share one row; every other space has its own.
std::string rowNameOf(const ActiveSelection& active);
void setPriorities(wire::Status& status, const std::map<std::string, std::int32_t>& priorities);

void addKeptOut(wire::Status& status, const std::vector<KeptOut>& kept_out);

/// Adds the size of the journal and the free space on the disk of `directory`, 0 if unknown.
void addDisk(wire::Status& status, const std::filesystem::path& directory,
             std::uint64_t journal_bytes);

/// Formats a message as one line of JSON, with the field names of proto/palpate.proto. Includes
/// fields that have their default value.
std::string toJson(const google::protobuf::Message& message);
/// Reads a status written by toJson(); unknown fields are ignored. Throws if the text is not a
/// status, or if its numbers of points are impossible. `source` names its origin in errors.
wire::Status statusFromJson(const std::string& json, const std::string& source);

}  // namespace palpate
