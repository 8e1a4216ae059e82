#pragma once

#include "common/base/program.hpp"

namespace palpate {

/// `palpate check`: validates a scene and prints its sizes, the quality of its mesh, warnings and
/// the cost of a build. Solves a few transitions for the estimate (about two seconds).
extern const Verb check_verb;
/// `palpate mesh`: makes a mesh that scenes can use, from a closed surface or from a mesh in
/// another format.
extern const Verb mesh_verb;
/// `palpate new`: writes a first scene for a mesh, with comments for the user.
extern const Verb new_verb;
/// `palpate work`: runs workers, which solve transitions for a scheduler, on any machine.
extern const Verb work_verb;
/// `palpate solve`: solves exactly at given displacements, without a scheduler.
extern const Verb solve_verb;

/// `palpate follow`: the live solver, which solves near the hand of a haptic client.
extern const Verb follow_verb;

/// Set if a solver thread is still running when the program ends. The program must then not return
/// from main(), which would destroy objects that the thread uses.
extern bool solver_left_running;

}  // namespace palpate
