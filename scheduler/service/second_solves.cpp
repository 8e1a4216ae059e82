#include "scheduler/service/second_solves.hpp"

#include <algorithm>

#include "common/base/assertion.hpp"
#include "scheduler/service/result_check.hpp"

namespace palpate {
namespace {

/// Returns the key of the recorded result that holds the fields from which this result started. The
/// result must not have started from the rest state.
ResultKey solverOfStart(const wire::Result& header) {
  return {header.space(), fromWire(header.parent()), fromWire(header.start_parent())};
}

}  // namespace

SecondSolves::SecondSolves(ServiceState& state, Workers& workers)
    : state_(state),
      workers_(workers),
      checks_(state.settings.spot_checks, state.tables.secret()),
      due_(state.tables.checks()) {}

bool SecondSolves::pick(const ResultKey& key, const Outcome& outcome) {
  SpotChecks::Look look = {.failed = !outcome.converged()};
  // The rest state has no parent to compare with. ResultCheck has judged it.
  if (outcome.converged() && key.target != key.parent) {
    const SpacePlan& plan = state_.plans[key.space];
    const Lattice& positions = plan.positions();
    look.oddness =
        oddnessBeside(plan.points().equilibrium(plan.find(key)->parent), outcome.equilibrium(),
                      positions.displacementOf(key.target) - positions.displacementOf(key.parent));
  }
  return checks_.pick(key, look);
}

void SecondSolves::note(const ResultKey& key, bool disputed) {
  due_[key] = disputed;
  state_.tables.writeCheck(key, disputed);
}

void SecondSolves::openDue() {
  std::erase_if(due_, [&](const auto& due) {
    const auto& [key, disputed] = due;
    // Disputed checks need neither room nor a second machine: they are few, the end of the build
    // waits for them, and one machine may settle them.
    return (disputed || (!workers_.isOneMachine() && checks_.hasRoom())) && open(key, disputed);
  });
}

/// Opens a check and returns true. Returns false if the result is not recorded in its plan yet, or
/// cannot be read.
bool SecondSolves::open(const ResultKey& key, bool disputed) {
  if (checks_.isOpen(key)) return true;
  if (!isRecordedInPlan(key)) return false;
  std::optional<JournalRecord> record;
  try {
    record = state_.store.find(key);
  } catch (const DamagedRecord&) {
    // Before the build ends, the damage is found and the result computed again.
  }
  wire::Result first;
  if (!record || !first.ParseFromString(record->header)) return false;
  PALPATE_ASSERT(keyOf(first) == key, "a result must be recorded under its own key");
  SpotChecks::Start start = {.id = first.start_id(), .solved_by = {}, .steps = first.steps()};
  if (first.has_start_parent()) start.solved_by = solverOfStart(first);
  checks_.open(key, opinionOf(first, first.given_by()), std::move(start), disputed);
  workers_.leases.addCheck(key);
  return true;
}

bool SecondSolves::isRecordedInPlan(const ResultKey& key) const {
  const std::optional<Transition> known = findIn(state_.plans, key);
  // If the result is in the group, it is being recorded again after a loss, and is checked only
  // after that.
  return known && state_.plans[key.space].isRecorded(*known) && !state_.group.has(key);
}

void SecondSolves::forgetUnneeded() {
  if (!workers_.isOneMachine() && !checks_.hasRoom()) return;
  std::erase_if(due_, [&](const auto& due) {
    const auto& [key, disputed] = due;
    if ((workers_.isOneMachine() && !disputed) || !isRecordedInPlan(key))
      state_.tables.forgetCheck(key);
    return true;
  });
}

bool SecondSolves::compare(Worker& worker, const wire::Result& first, const wire::Result& second) {
  const ResultKey key = keyOf(second);
  const Opinion opinion = opinionOf(second, worker.provenance);
  const bool was_open = checks_.isOpen(key);
  if (!was_open || checks_.apart(key, worker.provenance) == Apart::same_process) {
    if (isSame(worker, first, second)) {
      // If another worker gave the first result, the target was handed out again because this
      // worker was overdue. Now that it has delivered, it is no longer overdue.
      if (first.given_by().worker() != worker.id) worker.overdue_until.reset();
      return false;
    }
    if (state_.complete) return false;
    if (first.given_by().worker() == worker.id || (was_open && checks_.contradicts(key, opinion)))
      contradict(worker, second);
    if (was_open || !state_.liars.empty()) return false;
    note(key, true);
    openDue();
    if (!checks_.isOpen(key)) return false;
  }
  workers_.leases.finish(key);
  workers_.allotment.noteDelivery(worker, state_.now);
  const auto verdict = checks_.hear(key, opinion);
  if (!verdict) {
    if (was_open && !ResultCheck::agree(first, second)) differs(worker, first, second);
    workers_.leases.addCheck(key);
    state_.tables.writeCheck(key, true);
    return false;
  }
  ++state_.counters["checked_results"];
  if (verdict->wrong.empty()) {
    state_.tables.forgetCheck(key);
    return true;
  }
  // Keep the check in the tables, so that the result that is computed again is checked too. If this
  // process is killed before the wrong workers are excluded, the check finds them again.
  findLiars(*verdict, fmt::format("its result of {} differs from that of {} other workers",
                                  textOf(key), verdict->right.size()));
  return false;
}

bool SecondSolves::isSame(const Worker& worker, const wire::Result& first,
                          const wire::Result& second) {
  ++state_.counters["duplicate_results"];
  if (ResultCheck::agree(first, second)) return true;
  differs(worker, first, second);
  return false;
}

void SecondSolves::differs(const Worker& worker, const wire::Result& first,
                           const wire::Result& second) {
  ++state_.counters["divergent_results"];
  state_.chronicle.disputed(keyOf(second), first.given_by(), worker.provenance);
}

void SecondSolves::contradict(const Worker& worker, const wire::Result& result) {
  const std::string reason = fmt::format("it gave differing results of {}", textOf(keyOf(result)));
  // Count the rest of its machine as right, so that at first only this process is excluded: other
  // workers on the machine, or with the key, may be honest.
  wire::Provenance neighbour = worker.provenance;
  neighbour.clear_worker();
  findLiars({.right = {neighbour}, .wrong = {worker.provenance}}, reason);
}

void SecondSolves::findLiars(const SpotChecks::Verdict& verdict, const std::string& reason) {
  state_.liars =
      keptOutBy(verdict, state_.store.keptOut(), reason, state_.settings.spot_checks.trusted_key);
  state_.counters["wrong_results"] += std::ssize(state_.liars);
  state_.tables.writeCounters(state_.counters);
  for (const KeptOut& liar : state_.liars) state_.chronicle.keptOut(liar);
}

/// Returns true while checks still wait for machines that worked on this build before and may
/// connect again. Their time is over once only checks have been left for as long as checks_wait.
bool SecondSolves::othersMayCome() const {
  return !only_these_left_ || state_.now - *only_these_left_ < state_.settings.checks_wait;
}

std::map<ResultKey, Apart> SecondSolves::wanted() const {
  std::map<ResultKey, Apart> wanted;
  if (workers_.leases.waitingChecks().empty()) return wanted;
  Crowd at_work;
  for (const auto& [id, worker] : workers_.registry.all())
    if (workers_.asksForWork(worker))
      at_work.add(worker.provenance.key(), worker.provenance.host());
  const Crowd& may_come = othersMayCome() ? workers_.heard : at_work;
  for (const ResultKey& key : workers_.leases.waitingChecks())
    wanted.emplace(key, checks_.wanted(key, at_work, may_come));
  return wanted;
}

bool SecondSolves::mayTake(const Worker& worker, const ResultKey& key, Apart wanted) const {
  const Apart apart = checks_.apart(key, worker.provenance);
  return apart != Apart::same_process && apart >= wanted;
}

void SecondSolves::watch() {
  hopeless_ = false;
  if (!state_.handsOut() || state_.group.size() > 0 || checks_.openCount() == 0 ||
      !workers_.leases.onlyChecksLeft())
    return only_these_left_.reset();
  if (!only_these_left_) only_these_left_ = state_.now;
  hopeless_ = state_.now - *only_these_left_ >= state_.settings.worker_lost;
  if (othersMayCome()) return;
  for (auto& [id, worker] : workers_.registry.all())
    if (const auto last = workers_.leases.lastOf(id);
        last && workers_.allotment.isOverdue(worker, last->attempts, state_.now))
      workers_.reassignLast(worker);
}

bool SecondSolves::giveUp() {
  if (othersMayCome() || state_.complete) return false;
  bool some = false;
  for (const auto& [key, apart] : wanted()) {
    if (!isHopeless(key, apart)) continue;
    checks_.close(key);
    workers_.leases.finish(key);
    state_.tables.forgetCheck(key);
    ++state_.counters["unchecked_results"];
    some = true;
  }
  return some;
}

bool SecondSolves::isHopeless(const ResultKey& key, Apart wanted) const {
  if (checks_.isDisputed(key)) return false;
  return hopeless_ || std::ranges::none_of(workers_.registry.all(), [&](const auto& other) {
           return workers_.asksForWork(other.second) && mayTake(other.second, key, wanted);
         });
}

}  // namespace palpate
