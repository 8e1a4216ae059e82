#include "scheduler/plan/refinement.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "common/interpolation/branch_check.hpp"
#include "common/interpolation/field_error.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/points_in_ball.hpp"
#include "tests/support/sample_dataset.hpp"

namespace palpate {
namespace {

using Eigen::Vector3d;

/// Smooth, with a ridge across the x axis that a coarse lattice does not resolve.
class RidgeEnergy : public test::AnalyticEnergy {
 public:
  double energy(const Vector3d& p) const override {
    return 30 * p.squaredNorm() + 0.02 * std::exp(-square(p.x() / width));
  }
  Vector3d gradient(const Vector3d& p) const override {
    Vector3d g = 60 * p;
    g.x() += -0.04 * p.x() / square(width) * std::exp(-square(p.x() / width));
    return g;
  }
  Eigen::Matrix3d hessian(const Vector3d& p) const override {
    Eigen::Matrix3d h = 60 * Eigen::Matrix3d::Identity();
    const double t = square(p.x() / width);
    h(0, 0) += 0.04 / square(width) * (2 * t - 1) * std::exp(-t);
    return h;
  }

 private:
  static constexpr double width = 0.02;
  static double square(double x) { return x * x; }
};

Scene adaptiveScene(double force_error) {
  Scene scene;
  scene.workspace.radius = 0.06;
  scene.workspace.spacing = 0.03;
  scene.accuracy.force_error = force_error;
  return scene;
}

SpaceTable solvedStart(const Scene& scene, const test::AnalyticEnergy& energy) {
  return test::solvedSpace(uniformLattice(scene), energy);
}

/// Executes a refinement.
SpaceTable refined(const SpaceTable& space, const Refinement& next,
                   const test::AnalyticEnergy& energy) {
  Lattice lattice = space.lattice;
  for (const LatticePoint& point : next.points) lattice.add(point);
  SpaceTable result = test::solvedSpace(lattice, energy);
  result.patch = space.patch;
  result.splits = space.splits;
  result.splits.insert(result.splits.end(), next.splits.begin(), next.splits.end());
  std::sort(result.splits.begin(), result.splits.end(),
            [](const LatticeCell& a, const LatticeCell& b) {
              return a.level != b.level ? a.level < b.level : a.lowest < b.lowest;
            });
  return result;
}

/// Executes refinements until none is left; `see` is called with each round.
SpaceTable refinedToTheEnd(SpaceTable space, const Scene& scene, const test::AnalyticEnergy& energy,
                           const std::function<void(int, const Refinement&)>& see = {}) {
  int rounds = 0;
  for (Refinement next; !(next = nextRefinement(space, scene)).empty(); ++rounds) {
    if (rounds == 12) throw failure("refinement does not end");
    if (see) see(rounds, next);
    space = refined(space, next, energy);
  }
  return space;
}

/// The share of 1000 positions in the ball at which the exact energy confirms the scene's accuracy.
double shareKept(const SpaceTable& space, const Scene& scene, const test::AnalyticEnergy& energy) {
  const CellTree tree(space);
  const std::vector<LatticeEdge> inconsistent = inconsistentEdges(space);
  LocalFits fits(space.lattice.unit());
  const std::vector<EnergyJet> jets =
      energyJets(tree, slotPolynomials(tree, space, inconsistent,
                                       ghostPolynomials(tree, space, inconsistent, fits), fits));
  double kept = 0;
  for (const Vector3d& p : test::pointsInBall(tree.radius(), 1000)) {
    const Vector3d exact = -energy.gradient(p);
    const double error = (evaluateEnergy(tree, jets, tree.find(p)).force - exact).norm();
    if (error <= std::max(scene.accuracy.force_error * exact.norm(), scene.accuracy.force_floor))
      ++kept;
  }
  return kept / 1000;
}

bool hasFailedCorner(const SpaceTable& space, const LatticeCell& cell) {
  const std::int32_t edge = space.lattice.divisions() >> cell.level;
  for (int c = 0; c < 8; ++c) {
    LatticePoint corner = cell.lowest;
    for (std::size_t axis = 0; axis < 3; ++axis) corner[axis] += ((c >> axis) & 1) * edge;
    const auto number = space.lattice.indexOf(corner);
    if (number && space.points[*number].tag == Tag::failed) return true;
  }
  return false;
}

TEST(Refinement, KeepsAnAccurateSpaceUnchanged) {
  const Scene scene = adaptiveScene(0.03);
  const Refinement next =
      nextRefinement(solvedStart(scene, test::PolynomialEnergy(3, 0.06)), scene);
  EXPECT_TRUE(next.empty());
  EXPECT_EQ(next.kept, 1);
}

TEST(Refinement, DoesNotHalveCellsCrossedByAJumpBetweenBranches) {
  const Scene scene = adaptiveScene(0.03);
  SpaceTable space = solvedStart(scene, test::PolynomialEnergy(3, 0.06));
  // Another branch beyond the plane x = 0: forces of tens of newtons that no stiffness explains.
  for (std::int32_t n = 0; n < space.lattice.size(); ++n)
    if (space.lattice.point(n)[0] > 0) space.points[n].equilibrium.force += Vector3d(40, -30, 20);
  ASSERT_FALSE(inconsistentEdges(space).empty());
  const Refinement next = nextRefinement(space, scene);
  EXPECT_LT(next.kept, 1);
  for (const LatticeCell& cell : next.splits) EXPECT_NE(cell.lowest[0], 0) << "crossed by the jump";
}

/// Soft, then stiff for a few millimetres along x, then soft again: the forces at the ends of a
/// coarse edge across this look like those of two branches.
class StepEnergy : public test::AnalyticEnergy {
 public:
  double energy(const Vector3d& p) const override {
    return 30 * p.squaredNorm() +
           force * (width * std::log(std::cosh((p.x() - middle) / width)) + p.x() * before -
                    width * std::log(std::cosh(middle / width)));
  }
  Vector3d gradient(const Vector3d& p) const override {
    return 60 * p + force * (std::tanh((p.x() - middle) / width) + before) * Vector3d::UnitX();
  }
  Eigen::Matrix3d hessian(const Vector3d& p) const override {
    Eigen::Matrix3d h = 60 * Eigen::Matrix3d::Identity();
    h(0, 0) += force / width / std::pow(std::cosh((p.x() - middle) / width), 2);
    return h;
  }

 private:
  static constexpr double middle = 0.015, width = 0.004, force = 2;
  const double before = std::tanh(middle / width);
};

TEST(Refinement, HalvesAFingersCellsOnceAtADoubtfulJump) {
  const Scene scene = adaptiveScene(0.03);
  const StepEnergy energy;
  SpaceTable space = solvedStart(scene, energy);
  ASSERT_FALSE(inconsistentEdges(space).empty()) << "it looks like a jump";
  const auto splits_there = [](const Refinement& next) {
    return std::ranges::any_of(next.splits,
                               [](const LatticeCell& cell) { return cell.lowest[0] == 0; });
  };
  EXPECT_FALSE(splits_there(nextRefinement(space, scene)));
  space.patch.finger = Finger{Vector3d::Zero(), 0.03};
  EXPECT_LT(nextRefinement(space, scene).kept, 0.9);
  space = refinedToTheEnd(space, scene, energy, [&](int round, const Refinement& next) {
    EXPECT_TRUE(round > 0 || splits_there(next));
  });
  EXPECT_GE(nextRefinement(space, scene).kept, 0.99);
}

TEST(Refinement, EndsWithTheRequestedAccuracy) {
  const Scene scene = adaptiveScene(0.03);
  const RidgeEnergy energy;
  ASSERT_LT(shareKept(solvedStart(scene, energy), scene, energy), 0.9);
  const SpaceTable space = refinedToTheEnd(solvedStart(scene, energy), scene, energy);
  EXPECT_GE(nextRefinement(space, scene).kept, 0.998);
  EXPECT_GE(shareKept(space, scene, energy), 0.998) << "the energy itself says so";
  EXPECT_LT(space.lattice.size(), 1000)
      << "a uniform lattice of the finest spacing has 16 times as many";
}

TEST(Refinement, PredictsThePointsOfLaterRounds) {
  const RidgeEnergy energy;
  for (const double force_error : {0.01, 0.005, 0.003}) {
    const Scene scene = adaptiveScene(force_error);
    double foretold = 0, asked = 0;
    const SpaceTable space = refinedToTheEnd(solvedStart(scene, energy), scene, energy,
                                             [&](int round, const Refinement& next) {
                                               if (round == 0)
                                                 foretold = next.later;
                                               else
                                                 asked += static_cast<double>(next.points.size());
                                             });
    EXPECT_GT(asked, 100);
    EXPECT_GT(foretold, asked / 3.5) << force_error;
    EXPECT_LT(foretold, asked * 3.5) << force_error;
    EXPECT_EQ(nextRefinement(space, scene).later, 0);
  }
}

TEST(Refinement, AsksForNewPointsOnly) {
  const Scene scene = adaptiveScene(0.03);
  const RidgeEnergy energy;
  SpaceTable space = solvedStart(scene, energy);
  for (int round = 0; round < 3; ++round) {
    const Refinement next = nextRefinement(space, scene);
    for (const LatticePoint& point : next.points) EXPECT_FALSE(space.lattice.indexOf(point));
    space = refined(space, next, energy);
  }
}

TEST(Refinement, SplitsNoMoreThanAllowed) {
  Scene scene = adaptiveScene(1e-5);
  scene.accuracy.force_floor = 1e-6;
  scene.accuracy.levels = 1;
  const RidgeEnergy energy;
  const SpaceTable space =
      refinedToTheEnd(solvedStart(scene, energy), scene, energy, [](int, const Refinement& next) {
        for (const LatticeCell& cell : next.splits) EXPECT_EQ(cell.level, 0);
      });
  EXPECT_LT(nextRefinement(space, scene).kept, 1) << "says that the accuracy was not reached";
}

TEST(Refinement, KeepsTerminatingCellsUnchanged) {
  const Scene scene = adaptiveScene(0.001);
  SpaceTable space = solvedStart(scene, RidgeEnergy());
  for (PointRecord& point : space.points) point.tag = Tag::terminating;
  EXPECT_TRUE(nextRefinement(space, scene).empty());
}

TEST(Refinement, WorksWithOneConfigurationOnly) {
  const Scene scene = adaptiveScene(0.03);
  SpaceTable space = solvedStart(scene, RidgeEnergy());
  for (std::int32_t n = 1; n < space.lattice.size(); ++n) space.points[n].tag = Tag::failed;
  EXPECT_NO_THROW(nextRefinement(space, scene));
}

TEST(Refinement, ForAFingerConsidersOnlyPushesWithinTheForceLimit) {
  Scene scene = adaptiveScene(0.001);
  SpaceTable space = solvedStart(scene, RidgeEnergy());
  EXPECT_FALSE(nextRefinement(space, scene).empty());
  space.patch.finger = Finger{Vector3d::Zero(), 0.02};
  EXPECT_FALSE(nextRefinement(space, scene).empty());
  scene.workspace.max_force = 1e-6;
  EXPECT_TRUE(nextRefinement(space, scene).empty());
}

TEST(Refinement, ForAFingerHalvesCellsOnceWhereAnswersEnd) {
  Scene scene = adaptiveScene(1e-5);
  scene.accuracy.force_floor = 1e-6;
  scene.accuracy.levels = 3;
  const RidgeEnergy energy;
  SpaceTable space = solvedStart(scene, energy);
  space.patch.finger = Finger{Vector3d::Zero(), 0.02};
  bool halved_beside_the_end = false, halved_twice_elsewhere = false;
  for (int round = 0; round < 4; ++round) {
    for (std::int32_t n = 0; n < space.lattice.size(); ++n)
      if (space.lattice.displacement(n).z() > 0.04) space.points[n].tag = Tag::failed;
    const Refinement next = nextRefinement(space, scene);
    for (const LatticeCell& cell : next.splits) {
      const bool at_the_end = hasFailedCorner(space, cell);
      halved_beside_the_end |= cell.level == 0 && at_the_end;
      halved_twice_elsewhere |= cell.level > 0;
      EXPECT_FALSE(cell.level > 0 && at_the_end) << "traces the edge of the answers";
    }
    space = refined(space, next, energy);
  }
  EXPECT_TRUE(halved_beside_the_end);
  EXPECT_TRUE(halved_twice_elsewhere);
}

TEST(Refinement, ForAFingerHalvesCellsAtRestUntilCornersAreKnown) {
  Scene scene = adaptiveScene(0.03);
  scene.accuracy.force_floor = 100;
  scene.accuracy.levels = 4;
  const test::PolynomialEnergy energy(3, 0.06);
  SpaceTable space = solvedStart(scene, energy);
  space.patch.finger = Finger{Vector3d::Zero(), 0.02};
  ASSERT_TRUE(nextRefinement(space, scene).empty()) << "accurate as it is";
  // Stiff along z: the force limit is reached within a sixth of the first cells.
  const auto failBeyond = [](SpaceTable& table) {
    for (std::int32_t n = 0; n < table.lattice.size(); ++n)
      if (table.lattice.displacement(n).z() > 0.005) table.points[n].tag = Tag::failed;
  };
  int finest = 0;
  for (int round = 0; round < 6; ++round) {
    failBeyond(space);
    const Refinement next = nextRefinement(space, scene);
    for (const LatticeCell& cell : next.splits) finest = std::max(finest, cell.level + 1);
    space = refined(space, next, energy);
  }
  failBeyond(space);
  EXPECT_EQ(finest, 3) << "cells of 30 mm / 8 resolve the known points; no fourth split is needed";
  EXPECT_TRUE(nextRefinement(space, scene).empty());
}

TEST(Refinement, RefusesUniformScenesAndLattices) {
  const Scene scene = adaptiveScene(0.03);
  SpaceTable space = solvedStart(scene, RidgeEnergy());
  Scene uniform = scene;
  uniform.accuracy.force_error = 0;
  test::expectError(ExitCode::failed, [&] { nextRefinement(space, uniform); },
                    {"accuracy.force_error"});
  space.lattice = Lattice(0.06, 0.03);
  test::expectError(ExitCode::failed, [&] { nextRefinement(space, scene); },
                    {"1 divisions", "1024"});
}

}  // namespace
}  // namespace palpate
