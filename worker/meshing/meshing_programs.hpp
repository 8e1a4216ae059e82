#pragma once

#include "common/base/foreign_program.hpp"

namespace palpate {

/// Longer than any body that can be computed on takes to be meshed.
inline constexpr std::chrono::minutes longest_meshing(30);

/// Runs gmsh, tetgen or Python to its end, or until this process is interrupted.
inline Ran runMeshing(ForeignProgram program) {
  program.patience = longest_meshing;
  program.heeds_interrupts = true;
  return runToItsEnd(program);
}

}  // namespace palpate
