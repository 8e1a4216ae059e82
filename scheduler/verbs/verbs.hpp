#pragma once

#include "common/base/program.hpp"

namespace palpate {

/// `palpate build`: a scheduler and its own local workers, from a scene to a sealed dataset.
extern const Verb build_verb;
/// `palpate serve`: a scheduler for workers that connect from anywhere.
extern const Verb serve_verb;
/// `palpate status`: how far a build is, asked of its scheduler or read from its directory.
extern const Verb status_verb;
/// `palpate stop`: ends a scheduler in such a way that it can go on.
extern const Verb stop_verb;
/// `palpate fleet`: workers from an engine that owns the machines.
extern const Verb fleet_verb;
/// `palpate seal`: a partial dataset of a build that goes on.
extern const Verb seal_verb;
/// `palpate pause` and `resume`: nothing is handed out in between.
extern const Verb pause_verb;
extern const Verb resume_verb;
/// `palpate priority`: one space before others.
extern const Verb priority_verb;
/// `palpate retry`: tries again what was set aside, or failed.
extern const Verb retry_verb;
/// `palpate events`: what happened in a build, and what happens.
extern const Verb events_verb;
/// `palpate check` of a state directory: whether it is whole, and what it costs where it is not.
extern const Verb check_state_verb;
/// `palpate key`: the keys of this user.
extern const Verb key_verb;
/// `palpate explain`: how one lattice point was reached, or why it was not.
extern const Verb explain_verb;

}  // namespace palpate
