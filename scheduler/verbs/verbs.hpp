#pragma once

#include "common/base/program.hpp"

namespace palpate {

/// `palpate build`: runs a scheduler and its own local workers, from a scene to a sealed dataset.
extern const Verb build_verb;
/// `palpate serve`: runs a scheduler for workers that connect from anywhere.
extern const Verb serve_verb;
/// `palpate status`: shows the progress of a build, from its scheduler or its state directory.
extern const Verb status_verb;
/// `palpate stop`: ends a scheduler so that the build can be resumed.
extern const Verb stop_verb;
/// `palpate fleet`: starts workers through Slurm or ssh.
extern const Verb fleet_verb;
/// `palpate seal`: writes a partial dataset of a build in progress.
extern const Verb seal_verb;
/// `palpate pause` and `resume`: stop and restart the hand-out of work.
extern const Verb pause_verb;
extern const Verb resume_verb;
/// `palpate priority`: computes one space before others.
extern const Verb priority_verb;
/// `palpate retry`: repeats transitions that were set aside or failed.
extern const Verb retry_verb;
/// `palpate events`: lists the events of a build, past and new.
extern const Verb events_verb;
/// `palpate check` of a state directory: reports damage and the cost of repair.
extern const Verb check_state_verb;
/// `palpate key`: manages the keys of this user.
extern const Verb key_verb;
/// `palpate explain`: shows how one lattice point was reached, or why not.
extern const Verb explain_verb;

}  // namespace palpate
