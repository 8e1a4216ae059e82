#pragma once

#include "common/base/program.hpp"

namespace palpate {

/// `palpate solve SCENE.toml --active NAME --displacement X Y Z`: exact solutions, no scheduler.
extern const Verb solve_verb;

}  // namespace palpate
