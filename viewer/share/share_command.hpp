#pragma once

#include <filesystem>
#include <iosfwd>

#include "common/base/program.hpp"

namespace palpate {

struct ShareOptions {
  std::filesystem::path dataset, output;
};

/// `palpate share`: writes a dataset as one HTML file that can be touched, and tells how large it
/// is. Error (bad input) as of Dataset, or when the page would replace the dataset; Error when the
/// page cannot be written (then it is not there at all), or when this palpate has no field for
/// pages.
ExitCode share(const ShareOptions& options, std::ostream& output);

/// The verb `share` of palpate-answers, on standard output.
Verb shareVerb();

}  // namespace palpate
