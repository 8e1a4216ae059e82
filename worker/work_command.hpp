#pragma once

#include "common/base/program.hpp"

namespace palpate {

/// `palpate work --connect tcp://HOST:PORT [-j N]`: workers for a scheduler, on any machine.
extern const Verb work_verb;

}  // namespace palpate
