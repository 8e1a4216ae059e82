#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "proto/palpate.pb.h"

namespace palpate {

/// Exclusion of one or more workers from a build: their results are no longer accepted or kept. The
/// reason is that one of them gave a wrong result (other workers agreed on a different one), or two
/// different results of one transition.
struct KeptOut {
  /// Which workers are excluded.
  enum class Kind : std::uint8_t {
    process,  ///< one worker, identified by its id
    machine,  ///< all workers with this host and this key (the key may be empty)
    key,      ///< all workers with this key
  };
  Kind kind = Kind::process;
  wire::Provenance who;  ///< worker that gave the wrong result
  std::string reason;    ///< human-readable

  bool covers(const wire::Provenance& giver) const {
    const bool same_key = giver.key() == who.key();
    switch (kind) {
      case Kind::process: return giver.worker() == who.worker();
      case Kind::machine: return same_key && giver.host() == who.host();
      case Kind::key: return same_key && !who.key().empty();
    }
    return false;
  }
  bool operator==(const KeptOut& other) const {
    return kind == other.kind && who.SerializeAsString() == other.who.SerializeAsString();
  }
};

/// Returns "process", "machine" or "key", as in tables and status.
constexpr std::string_view name(KeptOut::Kind kind) {
  constexpr std::array<std::string_view, 3> names = {"process", "machine", "key"};
  return names.at(static_cast<std::size_t>(kind));
}

}  // namespace palpate
