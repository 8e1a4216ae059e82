#pragma once

#include "common/base/program.hpp"
#include "common/keys/key_folder.hpp"

namespace palpate {

/// What a program that talks to others is told about keys.
struct KeyOptions {
  std::string folder = {};  ///< --keys; empty: chosenKeyFolder()
  bool insecure = false;    ///< --insecure: no keys at all

  /// Declares both on `app`, which must not outlive this. `means`: what is open then, for --help.
  void addTo(CLI::App& app, const char* means);
  /// Nothing: no keys are wanted. Error (bad input) when there is no folder to look in.
  std::optional<KeyFolder> keys() const;
};

}  // namespace palpate
