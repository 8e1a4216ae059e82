#include "scheduler/fleet/launches.hpp"

#include <algorithm>
#include <limits>

#include "common/base/assertion.hpp"

namespace palpate {

void Backoff::failed(Time now) {
  constexpr int most = 6;
  failures_ = std::min(failures_ + 1, most);
  until_ = now + pause();
}

std::chrono::seconds Backoff::pause() const { return first_ * (1 << std::max(failures_ - 1, 0)); }

Launches::Change Launches::see(const std::vector<Ended>& ended, const std::vector<Running>& running,
                               Time now) {
  const bool was_held = held();
  const bool failed = countNew(ended, now);
  believe(running, now);
  Change change{.held = false, .left_out = leaveOut(running)};
  if (held() && (failed || !was_held)) {
    backoff_.failed(now);
    change.held = true;
  }
  if (!held()) backoff_.succeeded();
  PALPATE_ASSERT(in_a_row_ >= 0 && last_failures_.size() <= most_in_a_row,
                 "every listed failure must be counted");
  return change;
}

/// Counts the jobs that ended since the last call. Returns true if one failed early on a node that
/// is not excluded.
bool Launches::countNew(const std::vector<Ended>& ended, Time now) {
  std::set<std::string> seen;
  bool failed = false;
  for (const Ended& end : ended) {
    // A requeued job ends again under the same id.
    const std::string name = end.id + ' ' + end.when;
    seen.insert(name);
    if (seen_.contains(name) || bad_nodes_.contains(end.node)) continue;
    if (end.how == Ended::How::from_outside) continue;
    if (end.how == Ended::How::well || end.age >= early) {
      in_a_row_ = 0;
      on_a_node_.erase(end.node);
      last_failures_.clear();
      continue;
    }
    failed = true;
    last_failure_ = now;
    ++in_a_row_;
    ++on_a_node_[end.node];
    last_failures_.push_back(end);
    if (last_failures_.size() > most_in_a_row) last_failures_.pop_front();
  }
  seen_ = std::move(seen);
  return failed;
}

bool Launches::works(const Running& job) const {
  return job.age >= early && !bad_nodes_.contains(job.node);
}

/// Forgets the failures if a job that started after the last one survives: the cause is then gone.
void Launches::believe(const std::vector<Running>& running, Time now) {
  for (const Running& job : running) {
    if (!works(job) || now - job.age <= last_failure_) continue;
    in_a_row_ = 0;
    on_a_node_.erase(job.node);
    last_failures_.clear();
  }
}

std::vector<std::string> Launches::leaveOut(const std::vector<Running>& running) {
  std::vector<std::string> left_out;
  for (const auto& entry : on_a_node_) {
    const std::string& node = entry.first;
    const int failures = entry.second;
    const auto worksElsewhere = [&](const Running& job) { return works(job) && job.node != node; };
    if (node.empty() || failures < most_on_a_node || std::ranges::none_of(running, worksElsewhere))
      continue;
    bad_nodes_.insert(node);
    in_a_row_ = std::max(0, in_a_row_ - failures);
    left_out.push_back(node);
  }
  for (const std::string& node : left_out) on_a_node_.erase(node);
  return left_out;
}

int Launches::mostUnproven(Time now) const {
  if (!held()) return std::numeric_limits<int>::max();
  return backoff_.over(now) ? 1 : 0;
}

}  // namespace palpate
