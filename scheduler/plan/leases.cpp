#include "scheduler/plan/leases.hpp"

#include <algorithm>

#include "common/base/assertion.hpp"

namespace palpate {

void Leases::setPriority(std::uint32_t space, std::int32_t priority) {
  auto waiting = std::exchange(waiting_, {});
  priorities_[space] = priority;
  for (auto& [start, targets] : waiting)
    waiting_.emplace(startOf(start.space, start.parent), std::move(targets));
}

Leases::Start Leases::startOf(std::uint32_t space, const LatticePoint& parent) const {
  const auto found = priorities_.find(space);
  return {found == priorities_.end() ? 0 : -found->second, squaredNorm(parent), parent, space};
}

void Leases::add(const ResultKey& key, const Losses& before) {
  const auto [where, fresh] = entries_.try_emplace(key);
  PALPATE_ASSERT(fresh, "a transition must become ready only once");
  where->second.losses = before;
  putBack(key, where->second);
}

std::optional<Handout> Leases::handOut(const std::string& worker, std::size_t workers,
                                       std::size_t most) {
  PALPATE_ASSERT(most > 0, "a job must be allowed at least one transition");
  if (waiting_count_ == 0) return std::nullopt;
  const std::size_t share = 2 * std::max<std::size_t>(workers, 1);
  // Hand out half of an even share, so that the last jobs of a stage are small and end together.
  const std::size_t limit = std::clamp<std::size_t>((waiting_count_ + share - 1) / share, 1,
                                                    std::min(most, max_targets_per_job));

  const auto [start, targets] = *waiting_.begin();
  Handout handout{++last_job_, {}};
  for (const LatticePoint& target : targets) {
    const ResultKey key{start.space, target, start.parent};
    // A suspect is handed out alone, so that the next death identifies it.
    const bool alone = entries_.at(key).losses.suspected >= losses_before_alone;
    if (alone && !handout.targets.empty()) break;
    lease(key, worker, handout.job);
    handout.targets.push_back(key);
    if (alone || handout.targets.size() == limit) break;
  }
  PALPATE_ASSERT(!handout.targets.empty(), "a start configuration must have a waiting transition");
  return handout;
}

void Leases::lease(const ResultKey& key, const std::string& worker, std::uint64_t job) {
  takeFromWaiting(key);
  Entry& entry = entries_.at(key);
  PALPATE_ASSERT(entry.worker.empty(), "a waiting transition must not have a worker");
  entry.worker = worker;
  entry.job = job;
  ++entry.losses.attempts;
  Held& held = by_worker_[worker];
  held.jobs[job].push_back(key);
  ++held.targets;
  ++leased_count_;
  leased_checks_ += entry.is_check;
}

void Leases::addCheck(const ResultKey& key) {
  const auto [where, fresh] = entries_.try_emplace(key);
  PALPATE_ASSERT(fresh, "a transition must not be leased or checked twice");
  where->second.is_check = true;
  putBack(key, where->second);
}

std::optional<Handout> Leases::handOutCheck(const std::string& worker, const May& may) {
  const auto found = std::ranges::find_if(waiting_checks_, may);
  if (found == waiting_checks_.end()) return std::nullopt;
  const ResultKey key = *found;
  Handout handout{++last_job_, {key}};
  lease(key, worker, handout.job);
  return handout;
}

void Leases::finish(const ResultKey& key) {
  const auto found = entries_.find(key);
  PALPATE_ASSERT(found != entries_.end(), "a finished transition must have been leased or waiting");
  const Entry& entry = found->second;
  // A late result of a lost worker ends the lease of the worker that has the transition now.
  if (!entry.worker.empty()) {
    Held& held = by_worker_.at(entry.worker);
    auto& open = held.jobs.at(entry.job);
    std::erase(open, key);
    if (open.empty()) held.jobs.erase(entry.job);
    noteEnd(held, entry);
  } else {
    takeFromWaiting(key);
  }
  entries_.erase(found);
}

void Leases::giveBack(const std::string& worker) {
  for (const auto& [job, keys] : endLeases(worker))
    for (const ResultKey& key : keys) putBack(key, entries_.at(key));
}

std::optional<Leases::Last> Leases::lastOf(const std::string& worker) const {
  const Jobs& jobs = jobsOf(worker);
  if (jobs.empty()) return std::nullopt;
  const Entry& last = entries_.at(jobs.rbegin()->second.back());
  return Last{last.losses.attempts, last.is_check};
}

void Leases::giveBackLast(const std::string& worker) {
  Held& held = by_worker_.at(worker);
  PALPATE_ASSERT(!held.jobs.empty(), "the worker must have a lease");
  const auto job = std::prev(held.jobs.end());
  const ResultKey last = job->second.back();
  job->second.pop_back();
  if (job->second.empty()) held.jobs.erase(job);
  Entry& entry = entries_.at(last);
  noteEnd(held, entry);
  putBack(last, entry);
}

Leases::Suspects Leases::suspectsOf(const std::string& worker,
                                    std::optional<ResultKey> solving) const {
  Suspects suspects{.named = solving, .next = {}};
  if (const Jobs& jobs = jobsOf(worker); !jobs.empty()) {
    // The worker may have died in a solve that began after its last heartbeat: the next transition
    // in order is as suspect as the named one.
    suspects.next = jobs.begin()->second.front();
    suspects.alone = entries_.at(*suspects.next).losses.suspected >= losses_before_alone;
  }
  return suspects;
}

std::vector<std::pair<ResultKey, Losses>> Leases::blame(const Suspects& suspects) {
  std::vector<std::pair<ResultKey, Losses>> known;
  // The end of one process is one death. It is attributed to the transition that the worker named,
  // if that one is still open, or else to a `next` that was handed out alone.
  const bool is_named = suspects.named && entries_.contains(*suspects.named);
  for (const auto& key : std::set{suspects.named, suspects.next}) {
    const auto found = key ? entries_.find(*key) : entries_.end();
    if (found == entries_.end()) continue;
    Entry& entry = found->second;
    const bool waits = entry.worker.empty() && !isAside(entry);
    ++entry.losses.suspected;
    if (is_named ? key == suspects.named : suspects.alone) ++entry.losses.deaths;
    if (waits && isAside(entry)) takeFromWaiting(*key);
    known.emplace_back(*key, entry.losses);
  }
  return known;
}

std::vector<ResultKey> Leases::aside() const {
  std::vector<ResultKey> aside;
  for (const auto& [key, entry] : entries_)
    if (isAside(entry)) aside.push_back(key);
  return aside;
}

void Leases::retry() {
  for (auto& [key, entry] : entries_) {
    const bool was_aside = isAside(entry);
    entry.losses = {.attempts = entry.losses.attempts};
    if (was_aside) putBack(key, entry);
  }
}

const Leases::Jobs& Leases::jobsOf(const std::string& worker) const {
  static const Jobs none;
  const auto found = by_worker_.find(worker);
  return found == by_worker_.end() ? none : found->second.jobs;
}

std::size_t Leases::leasedTo(const std::string& worker) const {
  const auto found = by_worker_.find(worker);
  return found == by_worker_.end() ? 0 : found->second.targets;
}

std::vector<ResultKey> Leases::openOf(const std::string& worker, std::uint64_t job) const {
  const auto& jobs = jobsOf(worker);
  const auto found = jobs.find(job);
  return found == jobs.end() ? std::vector<ResultKey>() : found->second;
}

void Leases::putBack(const ResultKey& key, Entry& entry) {
  entry.worker.clear();
  if (isAside(entry)) return;
  if (entry.is_check) {
    waiting_checks_.insert(key);
    return;
  }
  waiting_[startOf(key.space, key.parent)].insert(key.target);
  ++waiting_count_;
}

void Leases::takeFromWaiting(const ResultKey& key) {
  if (waiting_checks_.erase(key) == 1) return;
  const auto group = waiting_.find(startOf(key.space, key.parent));
  // A set-aside transition is not among the waiting ones.
  if (group == waiting_.end() || group->second.erase(key.target) == 0) return;
  if (group->second.empty()) waiting_.erase(group);
  --waiting_count_;
}

void Leases::noteEnd(Held& held, const Entry& entry) {
  PALPATE_ASSERT(held.targets > 0 && leased_count_ > 0, "every lease must be counted");
  --held.targets;
  --leased_count_;
  leased_checks_ -= entry.is_check;
}

Leases::Jobs Leases::endLeases(const std::string& worker) {
  // The worker may have no entry: this is also called for workers that never had a job.
  Held held = std::exchange(by_worker_[worker], {});
  by_worker_.erase(worker);
  for (const auto& [job, keys] : held.jobs)
    for (const ResultKey& key : keys) {
      Entry& entry = entries_.at(key);
      noteEnd(held, entry);
      entry.worker.clear();
    }
  return std::move(held.jobs);
}

}  // namespace palpate
