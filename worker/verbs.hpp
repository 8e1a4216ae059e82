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
/// `palpate-worker kernels`: the kernels that solve on this machine ("avx512/SkylakeX"), and on a
/// second line why they are slower than its CPU allows, when they are. For `palpate doctor`, whose
/// program has no OpenBLAS; exit 1 when they compute wrong products.
extern const Verb kernels_verb;

}  // namespace palpate
