#pragma once

#include <spdlog/spdlog.h>

#include "scheduler/events/event_log.hpp"
#include "scheduler/plan/leases.hpp"
#include "scheduler/plan/space_plan.hpp"
#include "scheduler/service/line_budget.hpp"
#include "scheduler/service/worker_registry.hpp"

namespace palpate {

/// What happens in a coordinator, for people: lines of its log, and events (docs/commands.md), of
/// which it knows what fields each has. What workers cause by coming and going stays within a
/// budget. One thread.
class Chronicle {
 public:
  using Time = LineBudget::Time;

  /// Without `log`, which may be null, there are no events; all must outlive this object.
  Chronicle(const Problem& problem, EventLog* log, const Time& clock)
      : problem_(&problem), log_(log), clock_(clock), budget_(clock) {}

  // Lines that peers cause and that are no event.
  template <class... Args>
  void info(spdlog::format_string_t<Args...> text, Args&&... args) {
    if (mayTell()) spdlog::info(text, std::forward<Args>(args)...);
  }
  template <class... Args>
  void warn(spdlog::format_string_t<Args...> text, Args&&... args) {
    if (mayTell()) spdlog::warn(text, std::forward<Args>(args)...);
  }

  // Of workers.
  void joined(const Worker& worker);
  void left(const Worker& worker, const std::string& reason);
  /// `how`: "silent" or "unreachable"; so many targets were in its hands.
  void lost(const Worker& worker, const char* how, std::size_t targets);
  void ended(const Worker& worker, std::size_t targets);
  void refused(const std::string& host, std::uint32_t pid, const std::string& reason);

  // Of the work.
  /// The stages that plans are in from now on without anything having happened.
  void begin(const std::vector<SpacePlan>& plans);
  /// The plan of a space went on: an event when that is a stage further.
  void wentOn(std::uint32_t space, const SpacePlan& plan);
  void failed(const ResultKey& key, const Failure& failure, const wire::Provenance& giver);
  void setAside(const ResultKey& key, int deaths);
  /// `cause` of what failed; empty: what was set aside.
  void retried(std::int64_t transitions, const std::string& cause = "");
  void prioritized(const std::string& space, std::int32_t priority);
  void paused(bool paused);
  void disputed(const ResultKey& key, const wire::Provenance& one, const wire::Provenance& other);
  void keptOut(const KeptOut& liar);
  void completed(std::int64_t recorded, double seconds);

  /// What happened so far is written, if it can be.
  void flush();

 private:
  void add(const Event& event);
  /// Whether there is room for what workers cause at will. What was left out before is told first.
  bool mayTell();
  Event of(EventWord word, const ResultKey& key) const;

  const Problem* problem_;
  EventLog* log_;
  const Time& clock_;
  LineBudget budget_;
  std::vector<Stage> stages_;
  double divisions_ = 1;  ///< coordinates of a point in a spacing
};

}  // namespace palpate
