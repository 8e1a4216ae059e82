#pragma once

#include "common/base/program.hpp"

namespace palpate {

/// `palpate explain`: how one lattice point was reached, or why it was not.
extern const Verb explain_verb;

}  // namespace palpate
