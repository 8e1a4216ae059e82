#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "proto/palpate.pb.h"

namespace palpate {

/// Whose results are not taken any more, and not kept, because one of them was wrong: other workers
/// agreed on another.
struct KeptOut {
  /// What its results have in common with those of others that are wrong as well.
  enum class Kind : std::uint8_t {
    process,  ///< one worker, by its id
    machine,  ///< every worker that names this host under this key, or without one
    key,      ///< every worker under this key
  };
  Kind kind = Kind::process;
  wire::Provenance who;  ///< of whom it was found
  std::string reason;    ///< for people

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

/// "process", "machine", "key": as tables and status have it.
constexpr std::string_view name(KeptOut::Kind kind) {
  constexpr std::array<std::string_view, 3> names = {"process", "machine", "key"};
  return names.at(static_cast<std::size_t>(kind));
}

}  // namespace palpate
