#pragma once

#include "common/base/program.hpp"

namespace palpate {

/// `palpate build`: a scheduler and its own local workers, from a scene to a sealed dataset.
extern const Verb build_verb;

}  // namespace palpate
