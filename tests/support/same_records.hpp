#pragma once

#include <gtest/gtest.h>

#include "common/space/space_table.hpp"

/// Expects that two records from plans, files or messages have the same numbers, to the last bit.
namespace palpate::test {

inline void expectSame(const Failure& a, const Failure& b) {
  EXPECT_EQ(a.cause, b.cause);
  EXPECT_EQ(a.step_reached, b.step_reached);
  EXPECT_EQ(a.residual, b.residual);
  EXPECT_EQ(a.element, b.element);
  EXPECT_EQ(a.element_det_F, b.element_det_F);
  EXPECT_EQ(a.negative_pivots, b.negative_pivots);
  EXPECT_EQ(a.expected_negative_pivots, b.expected_negative_pivots);
  EXPECT_EQ(a.mumps_infog1, b.mumps_infog1);
  EXPECT_EQ(a.mumps_infog2, b.mumps_infog2);
}

inline void expectSame(const Equilibrium& a, const Equilibrium& b) {
  EXPECT_EQ(a.force, b.force);
  EXPECT_EQ(a.stiffness, b.stiffness);
  EXPECT_EQ(a.energy, b.energy);
  EXPECT_EQ(a.min_det_F, b.min_det_F);
  EXPECT_EQ(a.drive, b.drive);
  EXPECT_EQ(a.drive_stiffness, b.drive_stiffness);
  EXPECT_EQ(a.drive_slope, b.drive_slope);
  EXPECT_EQ(a.stiffness_by_p, b.stiffness_by_p);
  EXPECT_EQ(a.stiffness_by_s, b.stiffness_by_s);
  EXPECT_EQ(a.drive_slope_by_p, b.drive_slope_by_p);
}

/// Ignores seconds, which are not part of a dataset.
inline void expectSame(const PointRecord& a, const PointRecord& b) {
  EXPECT_EQ(a.tag, b.tag);
  EXPECT_EQ(a.cause, b.cause);
  EXPECT_EQ(a.parent, b.parent);
  expectSame(a.equilibrium, b.equilibrium);
  EXPECT_EQ(a.residual, b.residual);
  EXPECT_EQ(a.cost.newton_iterations, b.cost.newton_iterations);
  EXPECT_EQ(a.cost.factorizations, b.cost.factorizations);
  EXPECT_EQ(a.cost.steps, b.cost.steps);
  EXPECT_EQ(a.fields, b.fields);
}

inline void expectSame(const SpaceTable& a, const SpaceTable& b) {
  EXPECT_EQ(a.patch.name, b.patch.name);
  EXPECT_EQ(a.patch.node, b.patch.node);
  EXPECT_EQ(a.patch.nodes, b.patch.nodes);
  ASSERT_EQ(a.lattice.size(), b.lattice.size());
  for (std::int32_t n = 0; n < a.lattice.size(); ++n)
    EXPECT_EQ(a.lattice.point(n), b.lattice.point(n));
  EXPECT_EQ(a.lattice.uniformSize(), b.lattice.uniformSize());
  EXPECT_EQ(a.splits, b.splits);
  ASSERT_EQ(a.points.size(), b.points.size());
  for (std::size_t n = 0; n < a.points.size(); ++n) expectSame(a.points[n], b.points[n]);
  ASSERT_EQ(a.probes.size(), b.probes.size());
  for (std::size_t n = 0; n < a.probes.size(); ++n) {
    EXPECT_EQ(a.probes[n].displacement, b.probes[n].displacement);
    expectSame(a.probes[n].record, b.probes[n].record);
  }
  ASSERT_EQ(a.attempts.size(), b.attempts.size());
  for (std::size_t n = 0; n < a.attempts.size(); ++n) {
    EXPECT_EQ(a.attempts[n].target, b.attempts[n].target);
    EXPECT_EQ(a.attempts[n].parent, b.attempts[n].parent);
    expectSame(a.attempts[n].failure, b.attempts[n].failure);
  }
}

}  // namespace palpate::test
