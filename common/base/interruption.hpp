#pragma once

#include "common/base/error.hpp"
#include "common/base/program.hpp"

namespace palpate {

/// Error with the exit code of an interrupt, once interrupted(): for work that has replaced nothing
/// yet.
inline void endWhenInterrupted() {
  if (interrupted()) throw Error(ExitCode::interrupted, "interrupted; nothing was written");
}

}  // namespace palpate
