#pragma once

#include "common/base/program.hpp"

namespace palpate {

/// The verb `view` of palpate-viewer: the haptic client. Feels the first dataset through a device
/// until the end, then prints what the loop measured on standard output. Error (bad input) for
/// wrong options, before the device is touched; Error when there is no display and a picture is
/// wanted.
Verb viewVerb();

}  // namespace palpate
