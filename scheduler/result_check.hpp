#pragma once

#include <optional>
#include <string>

#include "common/content_id.hpp"
#include "common/lattice.hpp"
#include "common/problem.hpp"
#include "proto/palpate.pb.h"
#include "scheduler/leases.hpp"

namespace palpate {

/// Judges results that came over a socket before anything is done with them. `problem` and `lattice` must
/// outlive it.
class ResultCheck {
 public:
  ResultCheck(const Problem& problem, const Lattice& lattice);

  /// Which transition these words name; nothing when the space or a point does not exist.
  std::optional<TransitionKey> keyOf(std::uint32_t space, const wire::Point& target,
                                     const wire::Point& parent) const;

  /// Why this is no result of this build, computed with `kernel_family`; empty when it is one.
  std::string objectionTo(const wire::Result& result, const std::string& payload,
                          const std::string& kernel_family) const;

  /// Whether two results of one transition agree in every bit but the job and the seconds. One that only says
  /// that workers died agrees with everything.
  static bool agree(const wire::Result& first, const wire::Result& second);

 private:
  const Problem* problem_;
  const Lattice* lattice_;
  ContentId build_;
};

}  // namespace palpate
