#pragma once

#include <chrono>
#include <deque>

#include "scheduler/state/job_store.hpp"

namespace palpate {

/// Counts one point of `space` more, by its tag and, when it failed, by its cause.
void addPoint(wire::Status& status, wire::SpaceStatus& space, const PointRecord& point);

/// The counts of all spaces together, under the name "all".
wire::SpaceStatus sumOf(const wire::Status& status);

/// Where a build is, as its plans tell: points and attempts.
wire::Status statusOf(const Problem& problem, const std::vector<SpacePlan>& plans);
/// Adds the workers (`servers`) and the counters.
void addServers(wire::Status& status, const std::vector<wire::WorkerStatus>& servers,
                const Counters& counters);
/// What is kept for when no scheduler works there (Progress): points and attempts, `build`,
/// `kernel_family` and, as `state`, "complete" or "stopped".
wire::Status progressOf(const Problem& problem, const ContentId& build,
                        const std::vector<SpacePlan>& plans, const std::string& kernel_family,
                        bool complete);

/// The row of a status that a space is counted in: its own, or that of all places where an area is
/// measured.
std::string rowNameOf(const ActiveSelection& active);
void setPriorities(wire::Status& status, const std::map<std::string, std::int32_t>& priorities);

void addKeptOut(wire::Status& status, const std::vector<KeptOut>& kept_out);

/// The size of the journal in `directory`, and what its disk has left; 0 where that cannot be
/// known.
void addDisk(wire::Status& status, const std::filesystem::path& directory,
             std::uint64_t journal_bytes);

/// One line of JSON with the field names of proto/palpate.proto and every field in it.
std::string toJson(const google::protobuf::Message& message);
/// The status that toJson wrote; unknown fields are passed over. Error when the text is not one, or
/// its numbers of points cannot be.
wire::Status statusFromJson(const std::string& json);

/// How fast a build goes: equilibria found per second, over the last two minutes of this run.
class Pace {
 public:
  using Time = std::chrono::steady_clock::time_point;
  explicit Pace(Time now) : samples_{{now, 0}} {}

  /// `found`: equilibria since construction. Cheap; call it often.
  void note(Time now, std::int64_t found);
  /// 0 before anything was found.
  double perSecond(Time now, std::int64_t found) const;

 private:
  struct Sample {
    Time when;
    std::int64_t found;
  };
  std::deque<Sample> samples_;  ///< about one a second, oldest first; never empty
};

}  // namespace palpate
