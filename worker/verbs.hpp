#pragma once

#include "common/base/program.hpp"

namespace palpate {

/// `palpate check`: validates a scene and prints its sizes, the quality of its mesh, what is
/// doubtful about it and what a build will cost, for which it solves a few transitions (about two
/// seconds).
extern const Verb check_verb;
/// `palpate work`: workers for a scheduler, on any machine.
extern const Verb work_verb;
/// `palpate solve`: exact solutions, no scheduler.
extern const Verb solve_verb;

}  // namespace palpate
