#pragma once

#include "common/base/program.hpp"
#include "common/keys/key_folder.hpp"

namespace palpate {

/// Command-line options about keys for programs that use the network.
struct KeyOptions {
  std::string folder = {};  ///< --keys; if empty, chosenKeyFolder() decides
  bool insecure = false;    ///< --insecure: no keys are used

  /// Adds both options to `app`, which must not outlive this object. `means` is the text of --help
  /// that describes the risk of --insecure.
  void addTo(CLI::App& app, const char* means);
  /// Returns the key folder, or nullopt with --insecure. Error (bad input) if there is no folder.
  std::optional<KeyFolder> keys() const;
};

}  // namespace palpate
