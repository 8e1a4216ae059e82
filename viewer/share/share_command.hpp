#pragma once

#include <filesystem>
#include <iosfwd>

#include "common/base/program.hpp"

namespace palpate {

struct ShareOptions {
  std::filesystem::path dataset, output;

  void addTo(CLI::App& app);  ///< declares the options of the verb
};

/// Runs `palpate share`: writes a dataset as one HTML file that can be touched, and prints its
/// size. Error (bad input) as in Dataset, or if the page would replace the dataset. Error if the
/// page cannot be written (no incomplete file is left), or if this build of palpate contains no
/// force fields for pages (requirePageField).
void share(const ShareOptions& options, std::ostream& output);

/// The command `share` of palpate-answers, on standard output.
extern const Verb share_verb;

}  // namespace palpate
