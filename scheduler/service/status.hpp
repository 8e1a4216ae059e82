#pragma once

#include <chrono>
#include <deque>

#include "scheduler/state/job_store.hpp"

namespace palpate {

/// Adds one point to the counts of `space`, by its tag and, if it failed, its cause.
void addPoint(wire::Status& status, wire::SpaceStatus& space, const PointRecord& point);

/// Returns the counts of all spaces together, under the name "all".
wire::SpaceStatus sumOf(const wire::Status& status);

/// Returns the points and attempts of a build, as its plans have them.
wire::Status statusOf(const Problem& problem, const std::vector<SpacePlan>& plans);
/// Adds the workers (`servers`) and the counters.
void addServers(wire::Status& status, const std::vector<wire::WorkerStatus>& servers,
                const Counters& counters);
/// Returns the status that is stored for the time when no scheduler works there (Progress): points
/// and attempts, `build`, `kernel_family`, and "complete" or "stopped" as `state`.
wire::Status progressOf(const Problem& problem, const ContentId& build,
                        const std::vector<SpacePlan>& plans, const std::string& kernel_family,
                        bool complete);

/// Returns the name of the row of a status that counts a space: its own, or the shared row of all
/// places where an area is measured.
std::string rowNameOf(const ActiveSelection& active);
void setPriorities(wire::Status& status, const std::map<std::string, std::int32_t>& priorities);

void addKeptOut(wire::Status& status, const std::vector<KeptOut>& kept_out);

/// Adds the size of the journal and the free space on the disk of `directory`, 0 if unknown.
void addDisk(wire::Status& status, const std::filesystem::path& directory,
             std::uint64_t journal_bytes);

/// Returns one line of JSON with the field names of proto/palpate.proto and every field.
std::string toJson(const google::protobuf::Message& message);
/// Reads a status written by toJson(); unknown fields are ignored. Throws if the text is not a
/// status, or if its numbers of points are impossible.
wire::Status statusFromJson(const std::string& json);

/// Mean rate over the last two minutes of this run, of equilibria or of all results.
class Pace {
 public:
  using Time = std::chrono::steady_clock::time_point;
  explicit Pace(Time now) : samples_{{now, 0}} {}

  /// `found` counts from construction on. Cheap; call it often.
  void note(Time now, std::int64_t found);
  /// Returns 0 while nothing was found.
  double perSecond(Time now, std::int64_t found) const;

 private:
  struct Sample {
    Time when;
    std::int64_t found;
  };
  std::deque<Sample> samples_;  ///< about one per second, oldest first; never empty
};

}  // namespace palpate
