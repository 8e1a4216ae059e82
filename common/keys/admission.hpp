#pragma once

#include <chrono>
#include <map>
#include <mutex>

#include "common/keys/key_folder.hpp"

namespace palpate {

/// Whom a running server lets in: the own key with every role, and the list of its folder, which is
/// read again every second, so that keys are added and withdrawn while a build runs. Any thread.
class Admission {
 public:
  /// Error (bad input) when the list cannot be read. Later a list that cannot be read is told of,
  /// and the last good one stays.
  explicit Admission(KeyFolder folder);

  /// None: the key is not let in.
  Roles rolesOf(const PublicKey& key);

 private:
  using Clock = std::chrono::steady_clock;

  void read();

  const KeyFolder folder_;
  const PublicKey own_;
  std::mutex mutex_;  ///< guards what is below
  std::map<PublicKey, Roles> roles_;
  Clock::time_point read_at_;
  std::string trouble_;  ///< why the list could not be read last
};

}  // namespace palpate
