#include "viewer/fields/slot_terms.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/viewer/fields/uneven_spaces.hpp"

namespace palpate {
namespace {

using test::refinedSpace;
using test::solvedSpace;
using test::StiffeningEnergy;

Eigen::Vector3d placeOf(const CellTree& tree, const std::vector<SlotTerm>& terms) {
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  for (const SlotTerm& term : terms) place += term.factor * tree.displacement(term.slot);
  return place;
}

/// One and the place itself: linear functions are what both say of them.
TEST(SlotTerms, ContinueLinearFunctionsToEverySlotFromSolvedOnesAlone) {
  SpaceTable space = refinedSpace(0.01);
  space.points[*space.lattice.indexOf({-1024, 0, 0})] = {};
  const CellBranches data(space);
  const std::vector<std::vector<SlotTerm>> terms = solvedTerms(data);
  ASSERT_EQ(terms.size(), data.tree.slots().size());
  std::array<int, 3> kinds = {0, 0, 0};
  for (std::int32_t s = 0; s < std::ssize(terms); ++s) {
    ++kinds[static_cast<std::size_t>(data.tree.slots()[at(s)].kind)];
    double sum = 0;
    for (const SlotTerm& term : terms[at(s)]) {
      sum += term.factor;
      EXPECT_EQ(data.tree.slots()[at(term.slot)].kind, SlotKind::solved);
    }
    EXPECT_NEAR(sum, 1, 1e-8) << s;
    EXPECT_LT((placeOf(data.tree, terms[at(s)]) - data.tree.displacement(s)).norm(), 1e-9) << s;
  }
  for (const int count : kinds) EXPECT_GT(count, 0) << "of solved, ghosts and hanging ones";
}

TEST(SlotTerms, DoNotContinueAcrossAJump) {
  SpaceTable space = solvedSpace(Lattice(test::radius, 0.005), StiffeningEnergy());
  for (std::int32_t n = 0; n < space.lattice.size(); ++n)
    if (space.lattice.point(n)[2] > 1) space.points[at(n)].equilibrium.force.x() += 3;
  const CellBranches data(space);
  ASSERT_FALSE(data.inconsistent.empty());
  std::vector<std::int32_t> solved;
  for (std::int32_t s = 0; s < std::ssize(data.tree.slots()); ++s)
    if (data.tree.slots()[at(s)].kind == SlotKind::solved) solved.push_back(s);
  for (std::int32_t s = 0; s < std::ssize(data.tree.slots()); ++s) {
    if (data.tree.slots()[at(s)].kind != SlotKind::ghost) continue;
    const std::vector<SlotTerm> terms = continuedFrom(solved, data, s);
    for (const SlotTerm& term : terms)
      EXPECT_FALSE(data.isInconsistent(terms.front().slot, term.slot));
  }
}

}  // namespace
}  // namespace palpate
