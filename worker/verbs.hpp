#pragma once

#include "common/base/program.hpp"

namespace palpate {

/// `palpate check`: validates a scene and prints its sizes, the quality of its mesh, what is
/// doubtful about it and what a build will cost, for which it solves a few transitions (about two
/// seconds).
extern const Verb check_verb;
/// `palpate mesh`: makes a mesh that scenes can name of a closed surface, or of a mesh of another
/// format.
extern const Verb mesh_verb;
/// `palpate new`: writes a commented scene around a mesh.
extern const Verb new_verb;
/// `palpate work`: workers for a scheduler, on any machine.
extern const Verb work_verb;
/// `palpate solve`: exact solutions, no scheduler.
extern const Verb solve_verb;

/// A solver thread is still at work though its program wants to end: it must end without a return
/// from main(), which would take away what that thread uses.
extern bool solver_left_running;

}  // namespace palpate
