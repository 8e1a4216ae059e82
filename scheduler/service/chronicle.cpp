#include "scheduler/service/chronicle.hpp"

namespace palpate {
namespace {

/// Returns the short id that a status shows.
std::string shortIdOf(std::string_view id) { return hexOf(id).substr(0, 8); }

std::string nameOf(const wire::Provenance& worker) {
  std::string name = "worker " + shortIdOf(worker.worker()) + " on " + worker.host();
  if (const auto key = PublicKey::fromBytes(worker.key())) name += ", key " + key->shortHex();
  return name;
}

Event eventOf(EventWord word, const Worker& worker) {
  return Event(word)
      .with("worker", shortIdOf(worker.id))
      .with("host", worker.provenance.host())
      .with("pid", worker.pid);
}

std::array<double, 3> inSpacings(const LatticePoint& point, double divisions) {
  return {point[0] / divisions, point[1] / divisions, point[2] / divisions};
}

}  // namespace

std::optional<std::int64_t> LineBudget::spend(Time now) {
  const std::int64_t earned = std::max<std::int64_t>(0, (now - filled_) / interval);
  filled_ += earned * interval;
  lines_ = std::min(burst, lines_ + earned);
  if (lines_ == 0) {
    ++left_out_;
    return std::nullopt;
  }
  --lines_;
  return std::exchange(left_out_, 0);
}

void Chronicle::joined(const Worker& worker) {
  if (!mayTell()) return;
  spdlog::info("worker {} on {} joined ({} kernels)", worker.pid, worker.provenance.host(),
               worker.kernel_family);
  Event event = eventOf("worker_joined", worker).with("kernel_family", worker.kernel_family);
  if (const auto key = PublicKey::fromBytes(worker.provenance.key()))
    event.with("key", key->shortHex());
  add(event);
}

void Chronicle::left(const Worker& worker, const std::string& reason) {
  if (!mayTell()) return;
  spdlog::info("worker {} on {} left: {}", worker.pid, worker.provenance.host(), reason);
  add(eventOf("worker_left", worker).with("reason", reason).with("results", worker.results));
}

void Chronicle::lost(const Worker& worker, const char* how, std::size_t targets) {
  if (!mayTell()) return;
  spdlog::warn("worker {} on {} is {}; other workers get its {} solves", worker.pid,
               worker.provenance.host(), how, targets);
  add(eventOf("worker_lost", worker)
          .with("how", how)
          .with("targets", targets)
          .with("results", worker.results));
}

void Chronicle::ended(const Worker& worker, std::size_t targets) {
  if (!mayTell()) return;
  spdlog::warn("worker {} on {} ended unexpectedly; other workers get its {} solves", worker.pid,
               worker.provenance.host(), targets);
  add(eventOf("worker_ended", worker).with("targets", targets).with("results", worker.results));
}

void Chronicle::refused(const std::string& host, std::uint32_t pid, const std::string& reason) {
  if (!mayTell()) return;
  spdlog::warn("worker {} on {} was refused: {}", pid, host, reason);
  add(Event("worker_refused").with("host", host).with("pid", pid).with("reason", reason));
}

void Chronicle::begin(const std::vector<SpacePlan>& plans) {
  stages_.clear();
  for (const SpacePlan& plan : plans) {
    stages_.push_back(plan.stage());
    divisions_ = plan.positions().divisions();
  }
}

void Chronicle::wentOn(std::uint32_t space, const SpacePlan& plan) {
  if (std::exchange(stages_[space], plan.stage()) == plan.stage()) return;
  add(Event("stage")
          .with("space", problem_->scene.active[space].name)
          .with("stage", name(plan.stage())));
}

void Chronicle::failed(const ResultKey& key, const Failure& failure,
                       const wire::Provenance& giver) {
  Event event = of("failed_attempt", key)
                    .with("cause", name(failure.cause))
                    .with("step_reached", failure.step_reached);
  if (failure.residual > 0) event.with("residual", failure.residual);
  if (failure.element >= 0)
    event.with("element", failure.element).with("element_det_f", failure.element_det_F);
  if (failure.cause == Cause::wrong_inertia)
    event.with("negative_pivots", failure.negative_pivots)
        .with("expected_negative_pivots", failure.expected_negative_pivots);
  if (failure.mumps_infog1 != 0)
    event.with("mumps_infog1", failure.mumps_infog1).with("mumps_infog2", failure.mumps_infog2);
  add(event.with("worker", shortIdOf(giver.worker())).with("host", giver.host()));
}

void Chronicle::setAside(const ResultKey& key, int deaths) {
  spdlog::error(
      "{}: {} workers died on this transition; it is set aside, and the build continues without it",
      textOf(key), deaths);
  add(of("set_aside", key).with("deaths", deaths));
}

void Chronicle::retried(std::int64_t transitions, const std::string& cause) {
  Event event = Event("retried").with("transitions", transitions);
  if (!cause.empty()) event.with("cause", cause);
  add(event);
}

void Chronicle::prioritized(const std::string& space, std::int32_t priority) {
  add(Event("priority").with("space", space).with("priority", priority));
}

void Chronicle::paused(bool paused) {
  spdlog::info(paused ? "paused: workers get no work until palpate resume" : "resumed");
  add(paused ? Event("paused") : Event("resumed"));
}

void Chronicle::disputed(const ResultKey& key, const wire::Provenance& one,
                         const wire::Provenance& other) {
  if (!mayTell()) return;
  spdlog::error("{}: the results of {} and {} differ; further workers solve the transition",
                textOf(key), nameOf(other), nameOf(one));
  add(of("disputed", key)
          .with("worker", shortIdOf(one.worker()))
          .with("host", one.host())
          .with("other_worker", shortIdOf(other.worker()))
          .with("other_host", other.host()));
}

void Chronicle::keptOut(const KeptOut& liar) {
  spdlog::error("{}: this {} is excluded: {}; all its results are computed again", nameOf(liar.who),
                name(liar.kind), liar.reason);
  Event event = Event("kept_out")
                    .with("kind", name(liar.kind))
                    .with("worker", shortIdOf(liar.who.worker()))
                    .with("host", liar.who.host());
  if (const auto key = PublicKey::fromBytes(liar.who.key())) event.with("key", key->shortHex());
  add(event.with("reason", liar.reason));
}

void Chronicle::completed(std::int64_t recorded, double seconds) {
  add(Event("completed").with("recorded", recorded).with("seconds", seconds));
}

void Chronicle::flush() {
  if (log_ != nullptr) log_->flush();
}

void Chronicle::add(const Event& event) {
  if (log_ != nullptr) log_->add(event);
}

bool Chronicle::mayTell() {
  const auto left_out = budget_.spend(clock_);
  if (left_out.value_or(0) > 0) {
    spdlog::warn(
        "too many workers join, leave or are refused: {} log lines about them were omitted; "
        "palpate status shows the numbers",
        *left_out);
    add(Event("left_out").with("events", *left_out));
  }
  return left_out.has_value();
}

bool Chronicle::mayLog() {
  const auto left_out = lines_.spend(clock_);
  if (left_out.value_or(0) > 0)
    spdlog::warn("{} log lines about connections and about idle or overdue workers were omitted",
                 *left_out);
  return left_out.has_value();
}

Event Chronicle::of(EventWord word, const ResultKey& key) const {
  return Event(word)
      .with("space", problem_->scene.active[key.space].name)
      .with("point", inSpacings(key.target, divisions_))
      .with("parent", inSpacings(key.parent, divisions_));
}

}  // namespace palpate
