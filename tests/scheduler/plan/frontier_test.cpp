#include "scheduler/plan/frontier.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <random>

#include "tests/support/expect_error.hpp"

namespace palpate {
namespace {

/// The force of the equilibrium that a transition reaches; empty if it fails.
using Physics = std::function<std::optional<double>(Transition)>;

constexpr double max_force = 8;

std::uint64_t mix(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

/// A random body in which a transition always ends in the same way: `failing` percent do not
/// converge, and `strong` percent of the points are beyond max_force.
Physics randomPhysics(std::uint64_t seed, unsigned failing, unsigned strong) {
  return [=](Transition t) {
    const std::uint64_t way = mix(seed * 1000003 + static_cast<std::uint64_t>(t.target) * 65537 +
                                  static_cast<std::uint64_t>(t.parent));
    const std::uint64_t point = mix(seed + 17 * static_cast<std::uint64_t>(t.target));
    if (t.target != 0 && way % 100 < failing) return std::optional<double>();
    return std::optional(t.target != 0 && point % 100 < strong ? 2 * max_force : 1);
  };
}

/// A frontier and its input.
struct Front {
  explicit Front(const Lattice& of, int budget = max_attempts_per_point)
      : lattice(of), points(of.size()), frontier({lattice, points}, budget) {}

  void record(const Transition& transition, std::optional<double> force) {
    PointRecord found;
    found.tag = tagOf(force.value_or(0), max_force);
    found.parent = transition.parent;
    if (force)
      points.solve(transition.target, found);
    else
      points.addAttempt({transition.target, transition.parent, {}});
    frontier.record(transition, {lattice, points});
  }
  Tag tag(std::int32_t point) const {
    const Tag known = points.tag(point);
    return known == Tag::unknown && frontier.complete() ? Tag::failed : known;
  }

  Lattice lattice;
  CompactPoints points;
  Frontier frontier;
};

/// Everything that becomes part of a dataset.
struct Answer {
  std::vector<Tag> tags;
  std::vector<std::int32_t> parents;
  std::vector<std::vector<std::int32_t>> attempts;
  bool operator==(const Answer&) const = default;
};

/// `recorded`: all transitions; those of a point in the order of trying.
Answer answerOf(const Front& front, const std::vector<Transition>& recorded,
                const Physics& physics) {
  const auto size = static_cast<std::size_t>(front.lattice.size());
  Answer answer{
      {}, std::vector<std::int32_t>(size, -1), std::vector<std::vector<std::int32_t>>(size)};
  for (std::int32_t n = 0; n < front.lattice.size(); ++n) answer.tags.push_back(front.tag(n));
  for (const Transition& t : recorded)
    if (physics(t))
      answer.parents[t.target] = t.parent;
    else
      answer.attempts[t.target].push_back(t.parent);
  return answer;
}

/// The same rules, implemented slowly and simply: points in order of their norm, one round after
/// the other.
Answer referenceAnswer(const Lattice& lattice, const Physics& physics, std::size_t budget) {
  const auto size = static_cast<std::size_t>(lattice.size());
  Answer a{std::vector<Tag>(size, Tag::unknown), std::vector<std::int32_t>(size, -1),
           std::vector<std::vector<std::int32_t>>(size)};
  const auto tryFrom = [&](std::int32_t x, std::int32_t parent) {
    const std::optional<double> force = physics({x, parent});
    if (!force) {
      a.attempts[x].push_back(parent);
      return false;
    }
    a.tags[x] = *force > max_force ? Tag::terminating : Tag::expandable;
    a.parents[x] = parent;
    return true;
  };
  const auto walk = [&](std::int32_t x, const std::vector<Tag>& tags, bool only_nearer) {
    for (const std::int32_t c : lattice.neighbours(x)) {
      if (only_nearer && squaredNorm(lattice.point(c)) >= squaredNorm(lattice.point(x))) continue;
      if (tags[c] != Tag::expandable ||
          std::count(a.attempts[x].begin(), a.attempts[x].end(), c) > 0)
        continue;
      if (a.attempts[x].size() >= (only_nearer ? (budget + 1) / 2 : budget) || tryFrom(x, c))
        return;
    }
  };
  tryFrom(0, 0);
  for (std::int32_t x = 1; x < lattice.size(); ++x) walk(x, a.tags, true);
  for (std::vector<Tag> before, now = a.tags; before != now; now = a.tags) {
    before = a.tags;
    std::size_t tries = 0, tries_before = 0;
    for (const auto& list : a.attempts) tries_before += list.size();
    for (std::int32_t x = 0; x < lattice.size(); ++x)
      if (before[x] == Tag::unknown) walk(x, before, false);
    for (const auto& list : a.attempts) tries += list.size();
    if (tries == tries_before && before == a.tags) break;
  }
  std::replace(a.tags.begin(), a.tags.end(), Tag::unknown, Tag::failed);
  return a;
}

/// Solves with up to `in_flight` transitions at a time, which end in random order. Occasionally the
/// scheduler restarts, forgets the transitions in flight and replays the records, also in random
/// order.
Answer solve(const Lattice& lattice, const Physics& physics, std::size_t in_flight, unsigned seed,
             bool restarts, int budget = max_attempts_per_point) {
  std::mt19937 random(seed);
  std::vector<Transition> recorded;
  Front front(lattice, budget);
  std::vector<Transition> ready = front.frontier.takeReady();
  const auto pick = [&](std::size_t size) { return random() % size; };
  while (!front.frontier.complete()) {
    const std::size_t n = pick(std::min(ready.size(), in_flight));
    const Transition done = ready[n];
    ready.erase(ready.begin() + static_cast<std::ptrdiff_t>(n));
    front.record(done, physics(done));
    recorded.push_back(done);
    if (restarts && random() % 40 == 0) {
      front = Front(lattice, budget);
      ready.clear();
      std::vector<Transition> left = recorded;
      while (!left.empty()) {
        const auto known = std::find_if(left.begin(), left.end(), [&](const Transition& t) {
          return front.frontier.isOpen(t);
        });
        if (known == left.end())
          throw failure("a recorded transition is not asked for after a restart");
        front.record(*known, physics(*known));
        std::swap(*known, left.back());
        left.pop_back();
      }
      for (const Transition& t : front.frontier.takeReady())
        if (front.frontier.isOpen(t)) ready.push_back(t);
    }
    for (const Transition& t : front.frontier.takeReady()) ready.push_back(t);
    if (random() % 3 == 0) std::shuffle(ready.begin(), ready.end(), random);
  }
  return answerOf(front, recorded, physics);
}

TEST(Frontier, BeginsWithTheOriginAloneAndThenOffersItsNeighbours) {
  const Lattice lattice(3, 1);
  Front front(lattice);
  EXPECT_EQ(front.frontier.takeReady(), (std::vector<Transition>{{0, 0}}));
  EXPECT_TRUE(front.frontier.takeReady().empty());
  front.record({0, 0}, 0);
  const auto ready = front.frontier.takeReady();
  EXPECT_EQ(ready.size(), 6u) << "the axis neighbours; a diagonal one waits for its nearer "
                                 "neighbour, which is closer to it";
  for (const Transition& t : ready) EXPECT_EQ(t.parent, 0);
}

TEST(Frontier, GivesTheSameAnswerForEveryOrderOfCompletion) {
  const Lattice lattice(4, 1);
  for (unsigned seed = 0; seed < 40; ++seed) {
    const Physics physics = randomPhysics(seed, 10 * (seed % 8), 5 * (seed % 5));
    const Answer expected = referenceAnswer(lattice, physics, max_attempts_per_point);
    EXPECT_EQ(solve(lattice, physics, 1, seed, false), expected) << "one at a time, seed " << seed;
    EXPECT_EQ(solve(lattice, physics, 7, seed + 1, false), expected)
        << "a few at a time, seed " << seed;
    EXPECT_EQ(solve(lattice, physics, 1000, seed + 2, false), expected)
        << "all at a time, seed " << seed;
    EXPECT_EQ(solve(lattice, physics, 20, seed + 3, true), expected)
        << "with restarts, seed " << seed;
  }
}

TEST(Frontier, KeepsToAnyBudget) {
  const Lattice lattice(3, 1);
  for (const int budget : {1, 2, 5, 26})
    for (unsigned seed = 0; seed < 10; ++seed) {
      const Physics physics = randomPhysics(seed, 80, 0);
      const Answer answer = solve(lattice, physics, 9, seed, true, budget);
      EXPECT_EQ(answer, referenceAnswer(lattice, physics, static_cast<std::size_t>(budget)));
      for (const auto& attempts : answer.attempts)
        EXPECT_LE(attempts.size(), static_cast<std::size_t>(budget));
    }
}

TEST(Frontier, DoesNotExpandBeyondAShellOfTooLargeForces) {
  const Lattice lattice(4, 1);
  const Physics shell = [&](Transition t) {
    return std::optional(squaredNorm(lattice.point(t.target)) >= 4 ? max_force + 1 : 1);
  };
  const Answer answer = solve(lattice, shell, 8, 3, true);
  for (std::int32_t n = 0; n < lattice.size(); ++n) {
    const auto neighbours = lattice.neighbours(n);
    const bool reachable = std::any_of(neighbours.begin(), neighbours.end(), [&](std::int32_t m) {
      return squaredNorm(lattice.point(m)) < 4;
    });
    const bool inside = squaredNorm(lattice.point(n)) < 4;
    EXPECT_EQ(answer.tags[n], inside      ? Tag::expandable
                              : reachable ? Tag::terminating
                                          : Tag::failed)
        << n;
  }
}

TEST(Frontier, GoesAroundAWallAndReachesTheSideBehindItLater) {
  const Lattice lattice(5, 1);
  // No transition crosses from x = 1 to x = 2 except at y >= 3.
  const Physics wall = [&](Transition t) {
    const LatticePoint &to = lattice.point(t.target), &from = lattice.point(t.parent);
    const bool crosses = std::max(to[0], from[0]) == 2 && std::min(to[0], from[0]) == 1;
    return crosses && std::max(to[1], from[1]) < 3 ? std::nullopt : std::optional(1.0);
  };
  const Answer answer = solve(lattice, wall, 16, 5, true);
  EXPECT_EQ(answer, referenceAnswer(lattice, wall, max_attempts_per_point));
  const std::int32_t behind = *lattice.indexOf({2, 2, 0});
  EXPECT_EQ(answer.tags[behind], Tag::expandable);
  EXPECT_GE(lattice.point(answer.parents[behind])[0], 2)
      << "it is reached from its own side of the wall";
  EXPECT_FALSE(answer.attempts[behind].empty());
}

TEST(Frontier, EndsAtOnceWhenTheOriginFails) {
  const Lattice lattice(3, 1);
  Front front(lattice);
  EXPECT_EQ(front.tag(1), Tag::unknown) << "nothing is unreachable before the end";
  front.record({0, 0}, std::nullopt);
  EXPECT_TRUE(front.frontier.complete());
  for (std::int32_t n = 0; n < lattice.size(); ++n) EXPECT_EQ(front.tag(n), Tag::failed);
}

TEST(Frontier, RefusesUnrequestedResults) {
  const Lattice lattice(3, 1);
  Front front(lattice);
  test::expectError(ExitCode::failed,
                    [&] {
                      front.record({3, 0}, 1);
                    },
                    {"point 3", "not requested"});
  front.record({0, 0}, 0);
  test::expectError(ExitCode::failed, [&] { front.record({0, 0}, 0); }, {"not requested"});
}

}  // namespace
}  // namespace palpate
