#include "tests/measure/speed_up/ideal.hpp"

#include <queue>
#include <utility>

#include "common/base/assertion.hpp"

namespace palpate::speed_up {
namespace {

/// The waves of a plan whose lattice is complete.
std::vector<Dependencies::Wave> wavesOf(SpacePlan& plan, const Recording& recording) {
  std::vector<Dependencies::Wave> waves;
  std::vector<Transition> ready = plan.takeReady();
  while (!plan.complete()) {
    Dependencies::Wave wave;
    for (const Transition& first : std::exchange(ready, {})) wave.chains.push_back({first});
    for (std::vector<Transition>& chain : wave.chains)
      for (std::size_t n = 0; n < chain.size(); ++n) {
        const Recording::Solve& solve = recording.find(plan.keyOf(chain[n]));
        const int begun = plan.stagesBegun();
        plan.record(chain[n], solve.outcome, fieldsOf(solve.result));
        const std::vector<Transition> next = plan.takeReady();
        // The last transition of a wave makes the next wave ready; others make the next parent of
        // their target ready.
        std::vector<Transition>& goes_on = plan.stagesBegun() == begun ? chain : ready;
        goes_on.insert(goes_on.end(), next.begin(), next.end());
      }
    waves.push_back(std::move(wave));
  }
  return waves;
}

}  // namespace

Dependencies::Dependencies(const Recording& of) : recording(&of) {
  const Problem& problem = of.problem();
  for (std::uint32_t number = 0; number < problem.active.size(); ++number) {
    SpacePlan plan(problem, number);
    const ActivePatch& patch = problem.active[number];
    Space space{plan.positions(),
                plan.points(),
                Frontier({plan.positions(), plan.points()}, maxAttempts(patch)),
                {},
                {},
                {}};
    space.ready = space.frontier.takeReady();
    while (plan.stage() == Stage::lattice)
      for (const Transition& transition : plan.takeReady()) {
        const Recording::Solve& solve = of.find(plan.keyOf(transition));
        plan.record(transition, solve.outcome, fieldsOf(solve.result));
      }
    space.waves = wavesOf(plan, of);
    for (std::int32_t n = 0; n < plan.size(); ++n)
      space.positions.push_back(plan.positions().point(n));
    spaces.push_back(std::move(space));
  }
}

namespace {

class Schedule {
 public:
  Schedule(const Dependencies& dependencies, std::size_t workers)
      : dependencies_(dependencies), workers_(workers) {
    for (const Dependencies::Space& space : dependencies.spaces) {
      progress_.push_back({space.points, space.frontier, 0, 0});
      for (const Transition& first : space.ready)
        add(static_cast<std::uint32_t>(progress_.size() - 1), first, {});
    }
  }

  Ideal run() {
    Ideal ideal;
    for (begin(); !running_.empty(); begin()) {
      const auto [when, task] = running_.top();
      running_.pop();
      ideal = {now_ = when, task.depth};
      end(task);
    }
    PALPATE_ASSERT(ready_.empty(), "somebody is free as long as nobody works");
    return ideal;
  }

 private:
  /// A transition, its chain, and how many transitions had to end one after the other before it.
  struct Task {
    std::uint32_t space = 0;
    Transition transition = {};
    std::size_t chain = 0, link = 0;
    int depth = 0;
    auto operator<=>(const Task&) const = default;
  };
  using Rank = std::pair<std::int32_t, std::uint32_t>;  ///< parent, space; ordered as in Leases
  struct Progress {
    CompactPoints points;
    Frontier frontier;
    std::size_t waves = 0;  ///< begun
    std::size_t open = 0;   ///< chains in the last wave
  };

  void begin() {
    while (running_.size() < workers_ && !ready_.empty()) {
      const Task task = ready_.begin()->second;
      ready_.erase(ready_.begin());
      running_.emplace(now_ + solveOf(task).seconds, task);
    }
  }

  void end(const Task& task) {
    const std::uint32_t number = task.space;
    Progress& progress = progress_[number];
    if (progress.waves == 0) {
      const auto& [target, parent] = task.transition;
      const Outcome& outcome = solveOf(task).outcome;
      const double max_force = dependencies_.recording->problem().scene.workspace.max_force;
      if (outcome.converged())
        progress.points.solve(target, solvedPoint(parent, outcome, {}, max_force));
      else
        progress.points.addAttempt({target, parent, outcome.failure()});
      progress.frontier.record(task.transition,
                               {dependencies_.spaces[number].lattice, progress.points});
      for (const Transition& next : progress.frontier.takeReady())
        add(number, next, {{}, {}, 0, 0, task.depth});
      if (progress.frontier.complete()) beginWave(number, task.depth);
      return;
    }
    const Dependencies::Wave& wave = dependencies_.spaces[number].waves[progress.waves - 1];
    const std::vector<Transition>& chain = wave.chains[task.chain];
    if (task.link + 1 < chain.size()) {
      return add(number, chain[task.link + 1], {{}, {}, task.chain, task.link + 1, task.depth});
    }
    if (--progress.open == 0) beginWave(number, task.depth);
  }

  void beginWave(std::uint32_t number, int depth) {
    const std::vector<Dependencies::Wave>& waves = dependencies_.spaces[number].waves;
    Progress& progress = progress_[number];
    if (progress.waves++ == waves.size()) return;
    const Dependencies::Wave& wave = waves[progress.waves - 1];
    progress.open = wave.chains.size();
    for (std::size_t chain = 0; chain < wave.chains.size(); ++chain) {
      add(number, wave.chains[chain].front(), {{}, {}, chain, 0, depth});
    }
  }

  void add(std::uint32_t space, const Transition& transition, Task task) {
    task.space = space;
    task.transition = transition;
    ++task.depth;
    ready_.emplace(Rank(transition.parent, space), task);
  }

  const LatticePoint& point(std::uint32_t space, std::int32_t n) const {
    return dependencies_.spaces[space].positions[static_cast<std::size_t>(n)];
  }
  const Recording::Solve& solveOf(const Task& task) const {
    const auto& [target, parent] = task.transition;
    return dependencies_.recording->find(
        {task.space, point(task.space, target), point(task.space, parent)});
  }

  const Dependencies& dependencies_;
  const std::size_t workers_;
  std::vector<Progress> progress_;
  std::set<std::pair<Rank, Task>> ready_;
  using Finish = std::pair<double, Task>;
  std::priority_queue<Finish, std::vector<Finish>, std::greater<>> running_;
  double now_ = 0;
};

}  // namespace

Ideal idealOf(const Dependencies& dependencies, std::size_t workers) {
  return Schedule(dependencies, workers).run();
}

}  // namespace palpate::speed_up
