#pragma once

#include <string>
#include <string_view>

#include "common/space/result_key.hpp"

namespace palpate {

/// Returns the BLAKE2b hash of `text`, 16 bytes, keyed with `secret` of 16 to 64 bytes. Nobody can
/// compute or predict it without the secret.
std::string keyedHash(std::string_view text, std::string_view secret);
/// Encodes a transition for keyedHash(), with 8 bytes per number.
std::string bytesOf(const ResultKey& key);

/// A transition that is leased to a worker.
struct Leased {
  std::string_view worker;  ///< id of the worker
  ResultKey transition;
  std::string_view start_id;  ///< wire::Job.start_id
};

/// Returns the proof that this build leased a transition to a worker (wire::Target.lease), 16
/// bytes. The proof also holds after a restart of the scheduler, which stores no list of its
/// leases. It is a message authentication code (keyed BLAKE2b) over worker, transition and start;
/// nobody can make it without the secret of 16 to 64 bytes.
std::string leaseSeal(const Leased& leased, std::string_view secret);
bool isLeaseSeal(std::string_view seal, const Leased& leased, std::string_view secret);

}  // namespace palpate
