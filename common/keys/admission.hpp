#pragma once

#include <chrono>
#include <cstdint>
#include <map>

#include "common/keys/key_folder.hpp"

namespace palpate {

/// Whom a running server lets in: the own key with every role, and the list of its folder, which is
/// read again within a second after it changed, so that keys are added and withdrawn while a build
/// runs. One thread; each that asks has its own.
class Admission {
 public:
  /// Error (bad input) when the list cannot be read. Later a list that cannot be read is told of
  /// (when `tells`), and the last good one stays.
  explicit Admission(KeyFolder folder, bool tells = true);

  /// None: the key is not let in.
  Roles rolesOf(const PublicKey& key);

 private:
  using Clock = std::chrono::steady_clock;

  /// What shows that a file is another one.
  struct Stamp {
    std::uint64_t inode = 0;
    std::int64_t size = -1;
    std::int64_t seconds = 0, nanoseconds = 0;
    bool operator==(const Stamp&) const = default;
  };
  Stamp stamp() const;
  void read();

  KeyFolder folder_;
  bool tells_;
  PublicKey own_;
  std::map<PublicKey, Roles> roles_;
  Stamp read_;
  Clock::time_point looked_;
};

}  // namespace palpate
