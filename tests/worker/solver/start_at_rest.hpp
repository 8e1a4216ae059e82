#pragma once

#include "worker/solver/transition.hpp"

namespace palpate::test {

/// The start of every path of a solver. Throws if the body has no rest state.
inline Start startAtRest(TransitionSolver& solver) {
  Failure failure;
  auto rest = solver.startAtRest(failure);
  if (!rest) throw palpate::failure("{}", describe(failure));
  return std::move(*rest);
}

}  // namespace palpate::test
