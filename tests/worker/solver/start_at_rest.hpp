#pragma once

#include "worker/solver/transition.hpp"

namespace palpate::test {

/// Where every way of a solver begins. Error where the body finds no rest.
inline Start startAtRest(TransitionSolver& solver) {
  Failure failure;
  auto rest = solver.startAtRest(failure);
  if (!rest) throw palpate::failure("{}", describe(failure));
  return std::move(*rest);
}

}  // namespace palpate::test
