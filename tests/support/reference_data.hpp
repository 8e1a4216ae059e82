#pragma once

#include <gtest/gtest.h>

#include <filesystem>

namespace palpate::test {

/// Returns a path in the folder that the CMake cache variable PALPATE_REFERENCE_DATA names. The
/// folder holds real meshes (meshes/liver-493.msh, ...) that the project does not ship.
inline std::filesystem::path referenceData(const std::filesystem::path& name) {
  return std::filesystem::path(PALPATE_REFERENCE_DATA) / name;
}

}  // namespace palpate::test

/// Skips the running test with a reason if `name` is missing; otherwise defines `variable` as its
/// path.
// NOLINTNEXTLINE(bugprone-macro-parentheses): a declaration takes none
#define PALPATE_REFERENCE_FILE(variable, name)                                             \
  const std::filesystem::path variable = ::palpate::test::referenceData(name);             \
  if (!std::filesystem::exists(variable))                                                  \
  GTEST_SKIP()                                                                             \
      << "NOT RUN: there is no " << variable                                               \
      << "; set the CMake cache variable PALPATE_REFERENCE_DATA to the folder that holds " \
      << (name)
