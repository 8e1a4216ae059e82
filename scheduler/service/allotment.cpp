#include "scheduler/service/allotment.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

using Seconds = std::chrono::duration<double>;

/// Number of targets for a worker that has delivered nothing: one to solve and one to follow.
constexpr std::size_t newcomers_hold = 2;
/// Largest number of targets of any worker: two jobs.
constexpr std::size_t workers_hold = 2 * max_targets_per_job;
/// Weights of the latest value in the running mean over all workers, and in that of one worker.
constexpr double weight_of_all = 1.0 / 64, weight_of_one = 1.0 / 16;

void follow(double& mean, double latest, double weight) {
  mean = mean <= 0 ? latest : mean + weight * (latest - mean);
}

}  // namespace

std::size_t Allotment::limitOf(const Worker& worker, Time now) const {
  if (worker.overdue_until && now < *worker.overdue_until) return 0;
  std::size_t most = workers_hold;
  // A worker that is slow, or delivers only from time to time, gets fewer targets than others,
  // because it would otherwise finish last.
  if (between_results_ > 0 && worker.between_results > between_results_)
    most = static_cast<std::size_t>(static_cast<double>(most) * between_results_ /
                                    worker.between_results);
  most = std::max(most, newcomers_hold);
  return std::clamp<std::size_t>(worker.earned, newcomers_hold, most);
}

void Allotment::noteDelivery(Worker& worker, Time now) {
  const double taken = Seconds(now - worker.moved).count();
  follow(between_results_, taken, weight_of_all);
  follow(worker.between_results, taken, weight_of_one);
  worker.moved = now;
  worker.overdue_until.reset();
  ++worker.earned;
}

bool Allotment::isOverdue(const Worker& worker, std::uint32_t attempts, Time now) const {
  const auto held = now - worker.moved;
  if (between_results_ <= 0) return held >= settings_.overdue_without_any;
  // If other workers were slow with this target too, the target may be the cause: double the time
  // for each earlier hand-out.
  constexpr std::uint32_t most_doubled = 3;
  const double times = std::exp2(std::min(attempts, most_doubled + 1) - 1.0);
  return held >= times * std::max<Seconds>(settings_.overdue_at_least,
                                           Seconds(settings_.overdue_factor * between_results_));
}

void Allotment::noteOverdue(Worker& worker, Time now) const {
  worker.overdue_until = now + settings_.overdue_pause;
  worker.earned = 0;
}

}  // namespace palpate
