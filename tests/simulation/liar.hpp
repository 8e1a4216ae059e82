#pragma once

#include <set>
#include <string>
#include <utility>

#include "common/space/result_key.hpp"
#include "proto/palpate.pb.h"
#include "tests/simulation/random.hpp"

namespace palpate::simulation {

/// A machine whose workers lie: of their results about one in fifty, which is one or two of what
/// one of three workers finds in a build of 246.
class Liar {
 public:
  explicit Liar(std::uint64_t seed) : random_(seed) {}
  /// Falsifies what an honest worker found, or leaves it as it is. Whether it did.
  bool falsify(wire::Result& result, std::string& payload);

 private:
  Random random_;
};

/// Every lie that was told, and by whom.
class Lies {
 public:
  void note(const std::string& host, const wire::Result& lie);
  /// It is one of them, whoever was given it.
  bool contain(const wire::Result& result) const;
  bool isLiar(const std::string& host) const { return hosts_.contains(host); }

 private:
  std::set<std::pair<ResultKey, std::string>> told_;
  std::set<std::string> hosts_;
};

}  // namespace palpate::simulation
