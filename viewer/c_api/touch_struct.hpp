#pragma once

#include "viewer/c_api/palpate.h"
#include "viewer/haptics/contact.hpp"

namespace palpate {

/// Conversions between Touch and the structure of the C API. Real time.
palpate_touch toStruct(const Touch& touch) noexcept;
/// Drops shares beyond PALPATE_MOST_SHARES; checks nothing else.
Touch toTouch(const palpate_touch& touch) noexcept;

}  // namespace palpate
