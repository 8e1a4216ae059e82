#pragma once

#include "common/base/program.hpp"

namespace palpate {

/// `palpate status`: how far a build is, from its scheduler or from its state directory.
extern const Verb status_verb;

}  // namespace palpate
