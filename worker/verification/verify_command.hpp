#pragma once

#include "common/base/program.hpp"

namespace palpate {

/// `palpate verify [NAME...] [--all] [--json]`: solves the verification problems
/// (worker/verification/) and prints what was computed beside what it should be. Exit 0 when all
/// rows are within their tolerance, else 1.
extern const Verb verify_verb;

}  // namespace palpate
