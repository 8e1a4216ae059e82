#pragma once

#include "common/base/content_id.hpp"
#include "common/problem/problem.hpp"
#include "proto/palpate.pb.h"

namespace palpate {

/// Judges results that came over a socket before anything is done with them. `problem` must outlive
/// it.
class ResultCheck {
 public:
  explicit ResultCheck(const Problem& problem);

  /// Why this is no result of this build, computed with `kernel_family`; empty when it may be one:
  /// whether the transition was asked for is for the plans to say.
  std::string objectionTo(const wire::Result& result, const std::string& payload,
                          const std::string& kernel_family) const;

  /// Whether two results of one transition agree in every bit but the job and the seconds. One that
  /// only says that workers died agrees with everything.
  static bool agree(const wire::Result& first, const wire::Result& second);

 private:
  const Problem* problem_;
  ContentId build_;
};

}  // namespace palpate
