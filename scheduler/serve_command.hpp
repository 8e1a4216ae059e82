#pragma once

#include "common/base/program.hpp"

namespace palpate {

/// `palpate serve`: the scheduler as a daemon, for workers on any machine.
extern const Verb serve_verb;

}  // namespace palpate
