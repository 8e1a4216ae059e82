#pragma once

#include "common/base/program.hpp"

namespace palpate {

/// `palpate check SCENE.toml [--json]`: validates a scene and prints its sizes, the quality of its
/// mesh, what it will cost and what is doubtful about it. Solves nothing.
extern const Verb check_verb;

}  // namespace palpate
