#pragma once

#include "proto/palpate.pb.h"

namespace palpate {

/// Asks a scheduler one thing and waits for the answer. Error when none comes within 5 s, or the
/// endpoint makes no sense.
wire::Message ask(const std::string& endpoint, const wire::Message& question);

/// The endpoint that `where` means: itself when it is tcp:// or ipc://, else that of the scheduler
/// which now works in the state directory `where`; empty when none does. Error (bad input) when it
/// is neither.
std::string endpointOf(const std::string& where);

}  // namespace palpate
