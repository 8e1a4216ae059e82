#pragma once

#include <iosfwd>

#include "common/base/program.hpp"
#include "viewer/view_options.hpp"

namespace palpate {

/// `palpate view`: the haptic client. Feels the first dataset through a device until the end, then
/// prints what the loop measured. Error (bad input) for wrong options, before the device is
/// touched; Error when there is no display and a picture is wanted.
ExitCode view(const ViewOptions& options, std::ostream& output);

/// The verb `view` of palpate-viewer.
Verb viewVerb();

}  // namespace palpate
