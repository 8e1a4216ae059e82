#include <spdlog/spdlog.h>

#include <algorithm>

#include "common/base/assertion.hpp"
#include "scheduler/service/coordinator.hpp"

// Results that other workers solve again: when a check begins, who is asked, and what follows.

namespace palpate {
namespace {

std::string nameOf(const wire::Provenance& worker) {
  std::string name = "worker " + hexOfId(worker.worker()).substr(0, 8) + " on " + worker.host();
  if (const auto key = PublicKey::fromBytes(worker.key())) name += ", key " + key->shortHex();
  return name;
}

/// Of a result that has a start.
ResultKey solverOfStart(const wire::Result& header) {
  return {header.space(), fromWire(header.parent()), fromWire(header.start_parent())};
}

}  // namespace

SpotChecks::Look Coordinator::lookOf(const TransitionKey& key, const Outcome& outcome) const {
  if (!outcome.converged) return {.failed = true};
  // The rest state was judged by itself (ResultCheck).
  if (key.target == key.parent) return {};
  const SpacePlan& plan = plans_[key.space];
  const Lattice& positions = plan.positions();
  const Eigen::Vector3d way =
      positions.displacement(key.target) - positions.displacement(key.parent);
  return {.oddness = oddnessBeside(plan.point(key.parent).equilibrium, outcome.equilibrium, way)};
}

/// Whatever happens from now on, it is opened once it is recorded.
void Coordinator::noteCheck(const ResultKey& key, bool disputed) {
  due_checks_[key] = disputed;
  store_->tables().writeCheck(key, disputed);
}

void Coordinator::openChecks() {
  std::erase_if(due_checks_, [&](const auto& due) {
    const auto& [key, disputed] = due;
    // Disputes are few, the end waits for them, and one machine may settle them.
    return (disputed || (!isOneMachine() && checks_.hasRoom())) && openCheck(key, disputed);
  });
}

/// Whether it could be opened: not before its plan has it.
bool Coordinator::openCheck(const ResultKey& key, bool disputed) {
  if (checks_.isOpen(key)) return true;
  if (!isRecordedInPlan(key)) return false;
  std::optional<JournalRecord> record;
  try {
    record = store_->find(key);
  } catch (const DamagedRecord&) {
    // Found out, and computed again, before the end.
  }
  wire::Result first;
  if (!record || !first.ParseFromString(record->header)) return false;
  SpotChecks::Start start = {.id = first.start_id(), .solved_by = {}, .steps = first.steps()};
  if (first.has_start_parent()) start.solved_by = solverOfStart(first);
  checks_.open(key, opinionOf(first, first.given_by()), std::move(start), disputed);
  leases_.addCheck(*transitionOf(plans_, key));
  return true;
}

bool Coordinator::isRecordedInPlan(const ResultKey& key) const {
  const auto known = transitionOf(plans_, key);
  // In work once more, since what was recorded is lost: then it is checked when it comes.
  return known && plans_[known->space].isRecorded({known->target, known->parent}) &&
         !group_.has(*known);
}

/// When all is solved: checks of results that no plan asked for in the end, and all of them where
/// no second machine ever came. Damaged results are found before the seal, and checked when they
/// are computed again.
void Coordinator::forgetChecksOfNothing() {
  if (!isOneMachine() && !checks_.hasRoom()) return;
  std::erase_if(due_checks_, [&](const auto& due) {
    const auto& [key, disputed] = due;
    if ((isOneMachine() && !disputed) || !isRecordedInPlan(key)) store_->tables().forgetCheck(key);
    return true;
  });
}

/// A second result of what is recorded: because it was asked for as a check, or its acknowledgement
/// was lost, or a worker taken for dead finished after all.
void Coordinator::compare(Worker& worker, const TransitionKey& key, const wire::Result& first,
                          const wire::Result& second, Time now) {
  const ResultKey name = keyOf(plans_, key);
  const Opinion opinion = opinionOf(second, worker.provenance);
  const bool was_open = checks_.isOpen(name);
  if (!was_open || checks_.apart(name, worker.provenance) == Apart::same_process) {
    if (duplicate(worker, first, second, now)) {
      // Others were given it meanwhile.
      if (first.given_by().worker() != worker.id) worker.overdue_until.reset();
      return;
    }
    if (complete_) return;
    if (first.given_by().worker() == worker.id || (was_open && checks_.contradicts(name, opinion)))
      return contradict(worker, second);
    if (was_open) return;
    noteCheck(name, true);
    openChecks();
    if (!checks_.isOpen(name)) return;
  }
  leases_.finish(key);
  allotment_.noteDelivery(worker, now);
  const auto verdict = checks_.hear(name, opinion);
  if (verdict) return conclude(name, *verdict);
  if (was_open && !ResultCheck::agree(first, second)) differs(worker, first, second, now);
  leases_.addCheck(key);
  store_->tables().writeCheck(name, true);
}

void Coordinator::differs(const Worker& worker, const wire::Result& first,
                          const wire::Result& second, Time now) {
  ++counters_["divergent_results"];
  peer_log_.error(now, "{}: {} found other bits than {}: others are asked who is right",
                  textOf(keyOf(second)), nameOf(worker.provenance), nameOf(first.given_by()));
  if (const auto key = transitionOf(plans_, keyOf(second)))
    chronicle_.disputed(*key, plans_[key->space], first.given_by(), worker.provenance, now);
}

/// Who gives two results of one transition needs no others to be found wrong.
void Coordinator::contradict(const Worker& worker, const wire::Result& result) {
  const std::string reason = fmt::format("it gave two results of {}", textOf(keyOf(result)));
  // Other workers of its machine, and of its key, may have nothing to do with it.
  wire::Provenance neighbour = worker.provenance;
  neighbour.clear_worker();
  findLiars({.right = {neighbour}, .wrong = {worker.provenance}}, reason);
}

void Coordinator::conclude(const ResultKey& key, const SpotChecks::Verdict& verdict) {
  ++counters_["checked_results"];
  if (verdict.wrong.empty()) {
    store_->tables().forgetCheck(key);
    openChecks();
    return finishIfComplete(last_turn_);
  }
  // The check stays in the tables: what is computed again is checked again, and should the liars
  // not be kept out, because this is killed, somebody finds them once more.
  findLiars(verdict, fmt::format("its result of {} differs from what {} others found", textOf(key),
                                 verdict.right.size()));
}

void Coordinator::findLiars(const SpotChecks::Verdict& verdict, const std::string& reason) {
  liars_ = keptOutBy(verdict, store_->keptOut(), reason, settings_.spot_checks.trusted_key);
  counters_["wrong_results"] += std::ssize(liars_);
  store_->tables().writeCounters(counters_);
  for (const KeptOut& liar : liars_) {
    chronicle_.keptOut(liar);
    spdlog::error("{} is kept out ({}): {}; all that it gave is computed again", nameOf(liar.who),
                  name(liar.kind), liar.reason);
  }
}

/// Machines that were here are reckoned with until nothing but checks was left for checks_wait.
bool Coordinator::othersMayCome() const {
  return !only_checks_left_ || last_turn_ - *only_checks_left_ < settings_.checks_wait;
}

std::map<TransitionKey, Apart> Coordinator::wantedOfChecks() const {
  std::map<TransitionKey, Apart> wanted;
  if (leases_.waitingChecks().empty()) return wanted;
  Crowd at_work;
  for (const auto& [id, worker] : registry_.all())
    if (asksForWork(worker)) at_work.add(worker.provenance.key(), worker.provenance.host());
  const Crowd& may_come = othersMayCome() ? heard_ : at_work;
  for (const TransitionKey& key : leases_.waitingChecks())
    wanted.emplace(key, checks_.wanted(keyOf(plans_, key), at_work, may_come));
  return wanted;
}

bool Coordinator::mayCheck(const TransitionKey& key, const Worker& worker, Apart wanted) const {
  const Apart apart = checks_.apart(keyOf(plans_, key), worker.provenance);
  return apart != Apart::same_process && apart >= wanted;
}

/// The build is done but for checks that nobody does: for want of another machine, or because its
/// workers do not ask for work, or do not do what they were given.
void Coordinator::giveUpChecks(Time now) {
  checks_hopeless_ = false;
  if (!handsOut() || group_.size() > 0 || checks_.openCount() == 0 || !leases_.onlyChecksLeft())
    return only_checks_left_.reset();
  if (!only_checks_left_) only_checks_left_ = now;
  checks_hopeless_ = now - *only_checks_left_ >= settings_.worker_lost;
  if (othersMayCome()) return;
  for (auto& [id, worker] : registry_.all())
    if (const auto last = leases_.lastOf(id);
        last && allotment_.isOverdue(worker, last->attempts, now))
      takeBackLast(worker, now);
  bool some = true;
  while (some && !complete()) {
    some = false;
    for (const auto& [key, wanted] : wantedOfChecks())
      if (isHopeless(key, wanted)) {
        giveUp(key);
        some = true;
      }
    finishIfComplete(now);  // which opens others
  }
}

/// And does what it is given, as far as anybody knows.
bool Coordinator::asksForWork(const Worker& worker) const {
  const std::size_t held = leases_.leasedTo(worker.id);
  return held + roomOf(worker) > 0 && (worker.credit > 0 || held > 0);
}

bool Coordinator::isHopeless(const TransitionKey& check, Apart wanted) const {
  if (checks_.isDisputed(keyOf(plans_, check))) return false;
  return checks_hopeless_ || std::ranges::none_of(registry_.all(), [&](const auto& other) {
           return asksForWork(other.second) && mayCheck(check, other.second, wanted);
         });
}

void Coordinator::giveUp(const TransitionKey& check) {
  const ResultKey key = keyOf(plans_, check);
  checks_.close(key);
  leases_.finish(check);
  store_->tables().forgetCheck(key);
  ++counters_["unchecked_results"];
}

}  // namespace palpate
