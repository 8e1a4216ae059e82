#pragma once

#include "common/base/bytes32.hpp"
#include "common/problem/problem.hpp"
#include "common/space/configuration.hpp"
#include "proto/palpate.pb.h"

namespace palpate {

/// Judges results that came over a socket before anything is done with them: whether a solver of
/// this program can have found them. What it cannot judge alone, another worker's solve can
/// (SpotChecks). `problem` must outlive it; `build` is its problemId.
class ResultCheck {
 public:
  ResultCheck(const Problem& problem, const ContentId& build);

  struct Judged {
    std::string objection;  ///< why it is no result of this build; empty when it may be one
    Outcome outcome;        ///< what it says, without fields; valid without objection
  };
  /// Judges a result that is to be computed with `kernel_family`. Whether the transition was asked
  /// for is for the plans to say, and by whom for LeaseSeal.
  ///
  /// Of an equilibrium: all numbers finite; det F > 0 where the scene wants it; a residual as small
  /// as the solver leaves it; symmetric derivatives; only fingers are driven; fixed nodes and the
  /// tool are where they have to be; at rest nothing is displaced, stored or exerted, and the
  /// stiffness holds the tool back.
  Judged judge(const wire::Result& result, const std::string& payload,
               const std::string& kernel_family) const;

  /// Whether two results of one transition agree in every bit of what is reproducible.
  static bool agree(const wire::Result& first, const wire::Result& second);
  /// The part of a result that must be the same bits whoever computes it: not who asked for it when
  /// and who found it in what time.
  static std::string reproducibleBytes(wire::Result result);

 private:
  std::string objectionTo(const wire::Result& result, const Outcome& outcome,
                          const std::string& payload, const std::string& kernel_family) const;
  std::string objectionTo(const wire::Result& result, const Outcome& outcome,
                          const NodalFields& fields) const;

  const Problem* problem_;
  ContentId build_;
  Lattice lattice_;
  double diameter_;  ///< of the body, m
};

/// How badly an equilibrium follows from the one that it was reached from, `way` away (metres).
/// Force and stiffness are derivatives of the energy, so between two places that are not far apart
/// (Hermite quadrature)
///
///   E1 - E0 = -(f0 + f1).w / 2 + w.(K1 - K0) w / 12 + O(w^5),  f1 - f0 = (K0 + K1) w / 2 + O(w^3).
///
/// 1: as badly as the worst of 666 honest results on the shipped liver, by 0.3 % of the work or 5 %
/// of the force. Honest ones may be worse, where tissue snaps to another branch or the way is long.
double oddnessBeside(const ToolEquilibrium& parent, const ToolEquilibrium& found,
                     const Eigen::Vector3d& way);

}  // namespace palpate
