#pragma once

#include <string>
#include <string_view>

#include "common/space/result_key.hpp"

namespace palpate {

/// 16 bytes that nobody can make, or tell beforehand, without the secret, which has 16 to 64 bytes:
/// keyed BLAKE2b.
std::string keyedHash(std::string_view text, std::string_view secret);
/// For it: 8 bytes of each number.
std::string bytesOf(const ResultKey& key);

/// A transition in the hands of a worker.
struct Leased {
  std::string_view worker;  ///< its id
  ResultKey transition;
  std::string_view start_id;  ///< wire::Job.start_id
};

/// Shows that this build handed a transition out to a worker, also after a restart of the
/// scheduler, which keeps no list of that: a message authentication code (keyed BLAKE2b) over
/// worker, transition and start. Nobody without the secret can make one. One thread at a time.
class LeaseSeal {
 public:
  /// 16 to 64 bytes.
  explicit LeaseSeal(std::string secret);

  /// wire::Target.lease: 16 bytes.
  std::string sealOf(const Leased& leased) const;
  bool isSealOf(const Leased& leased, std::string_view seal) const;

 private:
  std::string secret_;
};

}  // namespace palpate
