#pragma once

#include <set>
#include <string>
#include <utility>

#include "common/space/result_key.hpp"
#include "proto/palpate.pb.h"
#include "tests/simulation/random.hpp"

namespace palpate::simulation {

/// A machine whose workers falsify about one in fifty of their results. A build has 246 results, so
/// one of three workers tells one or two lies.
class Liar {
 public:
  explicit Liar(std::uint64_t seed) : random_(seed) {}
  /// Falsifies an honest worker's result or leaves it unchanged. Returns whether it lied.
  bool falsify(wire::Result& result, std::string& payload);

 private:
  Random random_;
};

/// All lies told so far, and the lying hosts.
class Lies {
 public:
  void note(const std::string& host, const wire::Result& lie);
  /// Returns whether the result is one of the lies, whoever delivered it.
  bool contain(const wire::Result& result) const;
  bool isLiar(const std::string& host) const { return hosts_.contains(host); }

 private:
  std::set<std::pair<ResultKey, std::string>> told_;
  std::set<std::string> hosts_;
};

}  // namespace palpate::simulation
