#pragma once

#include "viewer/c_api/palpate.h"
#include "viewer/haptics/contact.hpp"

namespace palpate {

/// A Touch as the C API has it, and back. Real time.
palpate_touch toStruct(const Touch& touch) noexcept;
/// Shares beyond PALPATE_MOST_SHARES are left out; nothing else is looked at.
Touch toTouch(const palpate_touch& touch) noexcept;

}  // namespace palpate
