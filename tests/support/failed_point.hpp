#pragma once

#include "common/space/space_table.hpp"

namespace palpate::test {

/// A lattice point that was tried without finding an equilibrium.
inline PointRecord failedPoint() {
  PointRecord point;
  point.tag = Tag::failed;
  return point;
}

}  // namespace palpate::test
