#include "scheduler/service/chronicle.hpp"

namespace palpate {
namespace {

/// As people see them elsewhere (status).
std::string shortIdOf(std::string_view id) { return hexOfId(id).substr(0, 8); }

Event eventOf(EventKind kind, const Worker& worker) {
  Event event(kind);
  event.with("worker", shortIdOf(worker.id))
      .with("host", worker.host)
      .with("pid", std::int64_t{worker.pid});
  return event;
}

std::array<double, 3> inSpacings(const Lattice& positions, std::int32_t number) {
  const LatticePoint point = positions.point(number);
  const double divisions = positions.divisions();
  return {point[0] / divisions, point[1] / divisions, point[2] / divisions};
}

}  // namespace

void Chronicle::joined(const Worker& worker, Time now) {
  Event event = eventOf(EventKind::worker_joined, worker);
  event.with("kernel_family", worker.kernel_family);
  if (worker.key) event.with("key", worker.key->shortHex());
  addWithin(event, now);
}

void Chronicle::left(const Worker& worker, const std::string& reason, Time now) {
  addWithin(eventOf(EventKind::worker_left, worker)
                .with("reason", reason)
                .with("results", std::int64_t{worker.results}),
            now);
}

void Chronicle::lost(const Worker& worker, const char* how, std::size_t targets, Time now) {
  addWithin(eventOf(EventKind::worker_lost, worker)
                .with("how", how)
                .with("targets", static_cast<std::int64_t>(targets))
                .with("results", std::int64_t{worker.results}),
            now);
}

void Chronicle::ended(const Worker& worker, std::size_t targets, Time now) {
  addWithin(eventOf(EventKind::worker_ended, worker)
                .with("targets", static_cast<std::int64_t>(targets))
                .with("results", std::int64_t{worker.results}),
            now);
}

void Chronicle::refused(const std::string& host, std::uint32_t pid, const std::string& reason,
                        Time now) {
  addWithin(Event(EventKind::worker_refused)
                .with("host", host)
                .with("pid", std::int64_t{pid})
                .with("reason", reason),
            now);
}

void Chronicle::begin(const std::vector<SpacePlan>& plans) {
  stages_.clear();
  for (const SpacePlan& plan : plans) stages_.push_back(plan.stage());
}

void Chronicle::wentOn(std::uint32_t space, const SpacePlan& plan) {
  if (std::exchange(stages_[space], plan.stage()) == plan.stage()) return;
  add(Event(EventKind::stage)
          .with("space", problem_->scene.active[space].name)
          .with("stage", name(plan.stage())));
}

void Chronicle::failed(const TransitionKey& key, const SpacePlan& plan, const Failure& failure,
                       const wire::Provenance& giver) {
  if (log_ == nullptr) return;
  Event event = of(EventKind::failed_attempt, key, plan);
  event.with("cause", name(failure.cause)).with("step_reached", failure.step_reached);
  if (failure.residual > 0) event.with("residual", failure.residual);
  if (failure.element >= 0)
    event.with("element", std::int64_t{failure.element})
        .with("element_det_f", failure.element_det_F);
  if (failure.cause == Cause::wrong_inertia)
    event.with("negative_pivots", std::int64_t{failure.negative_pivots})
        .with("expected_negative_pivots", std::int64_t{failure.expected_negative_pivots});
  if (failure.mumps_infog1 != 0)
    event.with("mumps_infog1", std::int64_t{failure.mumps_infog1})
        .with("mumps_infog2", std::int64_t{failure.mumps_infog2});
  add(event.with("worker", shortIdOf(giver.worker())).with("host", giver.host()));
}

void Chronicle::setAside(const TransitionKey& key, const SpacePlan& plan, int deaths) {
  add(of(EventKind::set_aside, key, plan).with("deaths", std::int64_t{deaths}));
}

void Chronicle::retried(std::int64_t transitions, const std::string& cause) {
  Event event(EventKind::retried);
  event.with("transitions", transitions);
  if (!cause.empty()) event.with("cause", cause);
  add(event);
}

void Chronicle::prioritized(const std::string& space, std::int32_t priority) {
  add(Event(EventKind::priority).with("space", space).with("priority", std::int64_t{priority}));
}

void Chronicle::paused(bool paused) { add(Event(paused ? EventKind::paused : EventKind::resumed)); }

void Chronicle::disputed(const TransitionKey& key, const SpacePlan& plan,
                         const wire::Provenance& one, const wire::Provenance& other, Time now) {
  addWithin(of(EventKind::disputed, key, plan)
                .with("worker", shortIdOf(one.worker()))
                .with("host", one.host())
                .with("other_worker", shortIdOf(other.worker()))
                .with("other_host", other.host()),
            now);
}

void Chronicle::keptOut(const KeptOut& liar) {
  Event event(EventKind::kept_out);
  event.with("kind", name(liar.kind)).with("worker", shortIdOf(liar.who.worker()));
  event.with("host", liar.who.host());
  if (const auto key = PublicKey::fromBytes(liar.who.key())) event.with("key", key->shortHex());
  add(event.with("reason", liar.reason));
}

void Chronicle::completed(std::int64_t recorded, double seconds) {
  add(Event(EventKind::completed).with("recorded", recorded).with("seconds", seconds));
}

void Chronicle::flush() {
  if (log_ != nullptr) log_->flush();
}

void Chronicle::add(const Event& event) {
  if (log_ != nullptr) log_->add(event);
}

void Chronicle::addWithin(const Event& event, Time now) {
  if (log_ == nullptr || !budget_.spend(now)) return;
  if (const std::int64_t events = budget_.takeLeftOut(); events > 0)
    log_->add(Event(EventKind::left_out).with("events", events));
  log_->add(event);
}

Event Chronicle::of(EventKind kind, const TransitionKey& key, const SpacePlan& plan) const {
  const Lattice& positions = plan.positions();
  Event event(kind);
  event.with("space", problem_->scene.active[key.space].name)
      .with("point", inSpacings(positions, key.target))
      .with("parent", inSpacings(positions, key.parent));
  return event;
}

}  // namespace palpate
