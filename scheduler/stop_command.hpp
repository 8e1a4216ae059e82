#pragma once

#include "common/base/program.hpp"

namespace palpate {

/// `palpate stop`: lets the workers finish what they hold and ends a scheduler.
extern const Verb stop_verb;

}  // namespace palpate
