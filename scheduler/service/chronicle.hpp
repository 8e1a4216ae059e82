#pragma once

#include <spdlog/spdlog.h>

#include "scheduler/events/event_log.hpp"
#include "scheduler/plan/leases.hpp"
#include "scheduler/plan/space_plan.hpp"
#include "scheduler/service/worker_registry.hpp"

namespace palpate {

/// Limits the log lines and events that peers cause. Peers can join and leave as often as they
/// like, and the lines about them must not fill the disk. One thread.
class LineBudget {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// A thousand workers may start at once; after that, one line per second is allowed.
  static constexpr std::int64_t burst = 1000;
  static constexpr std::chrono::seconds interval{1};

  explicit LineBudget(Time now) : filled_(now) {}

  /// Call before each line. Returns the number of lines that were left out since the last accepted
  /// line. Returns none if this line must be left out too.
  std::optional<std::int64_t> spend(Time now);

 private:
  Time filled_;  ///< lines_ includes the lines allowed up to this time
  std::int64_t lines_ = burst;
  std::int64_t left_out_ = 0;
};

/// Reports to users what happens in a coordinator, as log lines and as events (docs/commands.md).
/// Limits the reports that workers cause by joining and leaving (LineBudget). One thread.
class Chronicle {
 public:
  using Time = LineBudget::Time;

  /// `log` may be null: no events are then written. All arguments must outlive this object.
  Chronicle(const Problem& problem, EventLog* log, const Time& clock)
      : problem_(&problem), log_(log), clock_(clock), budget_(clock), lines_(clock) {}

  // Log lines that peers cause and that have no event. Their number is limited (mayLog).
  template <class... Args>
  void info(spdlog::format_string_t<Args...> text, Args&&... args) {
    if (mayLog()) spdlog::info(text, std::forward<Args>(args)...);
  }
  template <class... Args>
  void warn(spdlog::format_string_t<Args...> text, Args&&... args) {
    if (mayLog()) spdlog::warn(text, std::forward<Args>(args)...);
  }

  // Workers.
  void joined(const Worker& worker);
  void left(const Worker& worker, const std::string& reason);
  /// `how` is "silent" or "unreachable"; `targets` is the number of targets that the worker held.
  void lost(const Worker& worker, const char* how, std::size_t targets);
  void ended(const Worker& worker, std::size_t targets);
  void refused(const std::string& host, std::uint32_t pid, const std::string& reason);

  // Work.
  /// Notes the current stages of the plans without reporting them.
  void begin(const std::vector<SpacePlan>& plans);
  /// Reports an event if the plan has entered another stage.
  void wentOn(std::uint32_t space, const SpacePlan& plan);
  void failed(const ResultKey& key, const Failure& failure, const wire::Provenance& giver);
  void setAside(const ResultKey& key, int deaths);
  /// `cause` is the cause of the failures that are tried again; empty for set-aside transitions.
  void retried(std::int64_t transitions, const std::string& cause = "");
  void prioritized(const std::string& space, std::int32_t priority);
  void paused(bool paused);
  void disputed(const ResultKey& key, const wire::Provenance& one, const wire::Provenance& other);
  void keptOut(const KeptOut& liar);
  void completed(std::int64_t recorded, double seconds);

  /// Writes the events that were added so far, if possible.
  void flush();

 private:
  void add(const Event& event);
  /// Returns true if the limit allows another report that a peer caused. If earlier reports were
  /// left out, first reports how many.
  bool mayTell();
  /// Does the same as mayTell() for log lines without an event, which have a budget of their own,
  /// so that they never displace events.
  bool mayLog();
  Event of(EventWord word, const ResultKey& key) const;

  const Problem* problem_;
  EventLog* log_;
  const Time& clock_;
  LineBudget budget_, lines_;
  std::vector<Stage> stages_;
  double divisions_ = 1;  ///< lattice coordinates per spacing
};

}  // namespace palpate
