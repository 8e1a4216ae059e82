#pragma once

#include "common/base/program.hpp"

namespace palpate {

/// `palpate doctor`: whether this machine can run the haptic client, and what to change. Exit 0, or
/// 1 when something will not work. The verb `doctor` of palpate-viewer.
Verb doctorVerb();

}  // namespace palpate
