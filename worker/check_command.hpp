#pragma once

#include "common/base/program.hpp"

namespace palpate {

/// `palpate check SCENE.toml [--json]`: validates a scene and prints its sizes, the quality of its
/// mesh, what is doubtful about it and what a build will cost, for which it solves a few
/// transitions (about two seconds).
extern const Verb check_verb;

}  // namespace palpate
