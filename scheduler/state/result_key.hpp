#pragma once

#include "common/space/lattice.hpp"
#include "proto/palpate.pb.h"

namespace palpate {

/// What names a result within a build, as results say it themselves. Unlike a TransitionKey it
/// needs no plan to be read.
struct ResultKey {
  std::uint32_t space = 0;
  LatticePoint target = {}, parent = {};
  auto operator<=>(const ResultKey&) const = default;
};
ResultKey keyOf(const wire::Result& result);

}  // namespace palpate
