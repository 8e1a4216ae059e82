#pragma once

#include "common/base/foreign_program.hpp"

namespace palpate {

/// Longer than any body that can be computed on takes to be meshed.
inline constexpr std::chrono::minutes longest_meshing(30);

/// Runs gmsh, tetgen or Python to its end, or until this process is interrupted.
inline Ran runMeshing(std::vector<std::string> words, std::string package, std::string input = {}) {
  return runToItsEnd({.words = std::move(words),
                      .package = std::move(package),
                      .input = std::move(input),
                      .patience = longest_meshing,
                      .heeds_interrupts = true});
}

}  // namespace palpate
