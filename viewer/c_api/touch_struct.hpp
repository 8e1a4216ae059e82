#pragma once

#include "viewer/c_api/palpate.h"
#include "viewer/haptics/contact.hpp"

namespace palpate {

/// Converts a Touch to the structure of the C API. Real time.
palpate_touch toStruct(const Touch& touch) noexcept;
/// Converts the structure of the C API to a Touch. Drops shares beyond PALPATE_MOST_SHARES, and
/// sets `beyond` to 0 if it is negative or NaN; checks nothing else. Real time.
Touch toTouch(const palpate_touch& touch) noexcept;

}  // namespace palpate
