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

std::string textOf(const ResultKey& key) {
  const auto& [space, target, parent] = key;
  return fmt::format("space {}, point ({}, {}, {}) from ({}, {}, {})", space, target[0], target[1],
                     target[2], parent[0], parent[1], parent[2]);
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

/// Those that an earlier run left.
void Coordinator::reopenChecks() {
  for (const auto& [key, disputed] : store_->tables().checks()) {
    if (const auto first = recordedInPlan(key))
      openCheck(key, *first, disputed);
    else
      store_->tables().forgetCheck(key);
  }
}

/// Nothing when it is not recorded, or not yet in its plan, since what led there is computed again,
/// or when the tables name what there cannot be.
std::optional<wire::Result> Coordinator::recordedInPlan(const TransitionKey& key) const {
  if (key.space >= plans_.size()) return std::nullopt;
  const SpacePlan& plan = plans_[key.space];
  for (const std::int32_t n : {key.target, key.parent})
    if (n < 0 || n >= plan.size()) return std::nullopt;
  if (plan.isOpen({key.target, key.parent})) return std::nullopt;
  try {
    const auto record = store_->find(resultKeyOf(key));
    wire::Result result;
    if (record && result.ParseFromString(record->header) && hasStart(key, result.start_id()))
      return result;
  } catch (const DamagedRecord&) {
    // Found out, and computed again, when it is needed.
  }
  return std::nullopt;
}

/// Whether what the transition starts from is still what it was.
bool Coordinator::hasStart(const TransitionKey& key, const std::string& start_id) const {
  const SpacePlan& plan = plans_[key.space];
  const bool is_solved = key.target == key.parent || isSolved(plan.point(key.parent).tag);
  return is_solved && start_id == startIdOf(plan, {key.target, key.parent});
}

void Coordinator::openCheck(const TransitionKey& key, const wire::Result& first, bool disputed) {
  // Another equilibrium of the start may have taken its place with this very result.
  if (!hasStart(key, first.start_id()) || (!checks_.hasRoom() && !disputed)) return;
  const TransitionKey solver_of_start = {key.space, key.parent,
                                         plans_[key.space].point(key.parent).parent};
  checks_.open(key, opinionOf(first, first.given_by()), {first.start_id(), solver_of_start},
               disputed);
  leases_.addCheck(key);
  store_->tables().writeCheck(key, disputed);
}

/// What a result that is odd was reached from may be what is wrong.
void Coordinator::openCheckOfStart(const TransitionKey& key) {
  const TransitionKey start = {key.space, key.parent, plans_[key.space].point(key.parent).parent};
  if (key.target == key.parent || checks_.wasOpened(start)) return;
  const auto record = store_->find(resultKeyOf(start));
  PALPATE_ASSERT(record, "a plan moves on with recorded results only");
  wire::Result first;
  const bool readable = first.ParseFromString(record->header);
  PALPATE_ASSERT(readable, "what is recorded was read when it was found, or written by us");
  openCheck(start, first);
}

/// A second result of what is recorded: because it was asked for as a check, or its acknowledgement
/// was lost, or a worker taken for dead finished after all.
void Coordinator::compare(const Worker& worker, const TransitionKey& key, const wire::Result& first,
                          const wire::Result& second, Time now) {
  const wire::Provenance who = worker.provenance();
  const bool was_open = checks_.isOpen(key);
  if (!was_open) {
    duplicate(worker, first, second, now);
    if (ResultCheck::agree(first, second)) return;
    openCheck(key, first, true);
    if (!checks_.isOpen(key) || !checks_.isNew(key, who)) return;
  } else if (!checks_.isNew(key, who)) {
    return duplicate(worker, first, second, now);
  }
  leases_.finish(key);
  const auto verdict = checks_.hear(key, opinionOf(second, who));
  if (verdict) return conclude(key, *verdict);
  if (was_open) differs(worker, first, second, now);
  leases_.addCheck(key);
  store_->tables().writeCheck(key, true);
}

void Coordinator::differs(const Worker& worker, const wire::Result& first,
                          const wire::Result& second, Time now) {
  ++counters_["divergent_results"];
  peer_log_.error(now, "{}: {} found other bits than {}: others are asked who is right",
                  textOf(palpate::keyOf(second)), nameOf(worker.provenance()),
                  nameOf(first.given_by()));
}

void Coordinator::conclude(const TransitionKey& key, const SpotChecks::Verdict& verdict) {
  store_->tables().forgetCheck(key);
  ++counters_["checked_results"];
  if (verdict.wrong.empty()) return finishIfComplete(last_turn_);
  const std::string reason = fmt::format("its result of {} differs from what {} others found",
                                         textOf(resultKeyOf(key)), verdict.right.size());
  counters_["wrong_results"] += std::ssize(verdict.wrong);
  store_->tables().writeCounters(counters_);
  std::vector<KeptOut> liars = keptOutBy(verdict, store_->keptOut(), reason);
  for (const KeptOut& liar : liars)
    spdlog::error("{} is kept out ({}): {}; all that it gave is computed again", nameOf(liar.who),
                  name(liar.kind), liar.reason);
  throw LiarsFound(std::move(liars));
}

void Coordinator::closeCheck(const TransitionKey& key) {
  checks_.close(key);
  leases_.finish(key);
  store_->tables().forgetCheck(key);
  ++counters_["unchecked_results"];
}

/// Somebody who did not solve it, and of another machine where there is one.
bool Coordinator::mayCheck(const TransitionKey& key, const Worker& worker) const {
  const wire::Provenance who = worker.provenance();
  if (!checks_.isNew(key, who)) return false;
  return checks_.isElsewhere(key, who) ||
         std::ranges::none_of(registry_.all(), [&](const auto& other) {
           return checks_.isElsewhere(key, other.second.provenance());
         });
}

/// The build is done but for checks that nobody does: for want of another worker, or because those
/// that are there do not ask for work.
void Coordinator::giveUpChecks(Time now) {
  checks_hopeless_ = false;
  if (complete() || group_.size() > 0 || !leases_.stuck() || leases_.waitingChecks().empty())
    return only_checks_left_.reset();
  if (!only_checks_left_) only_checks_left_ = now;
  const std::set<TransitionKey> waiting = leases_.waitingChecks();
  const bool somebody_may = std::ranges::any_of(waiting, [&](const TransitionKey& key) {
    return std::ranges::any_of(registry_.all(),
                               [&](const auto& other) { return mayCheck(key, other.second); });
  });
  checks_hopeless_ = (!somebody_may && !registry_.all().empty()) ||
                     now - *only_checks_left_ >= settings_.worker_lost;
  if (!checks_hopeless_) return;
  for (const TransitionKey& key : waiting)
    if (!checks_.isDisputed(key)) closeCheck(key);
  finishIfComplete(now);
}

}  // namespace palpate
