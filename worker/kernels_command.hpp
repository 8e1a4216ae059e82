#pragma once

#include "common/base/program.hpp"

namespace palpate {

/// `palpate-worker kernels`: the kernels that solve on this machine ("avx512/SkylakeX"), and on a
/// second line why they are slower than its CPU allows, when they are. For `palpate doctor`, whose
/// program has no OpenBLAS; exit 1 when they compute wrong products.
extern const Verb kernels_verb;

}  // namespace palpate
