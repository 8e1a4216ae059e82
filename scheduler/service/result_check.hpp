#pragma once

#include "common/base/bytes32.hpp"
#include "common/problem/problem.hpp"
#include "common/space/configuration.hpp"
#include "proto/palpate.pb.h"

namespace palpate {

/// Checks results that came over a socket before they are used: could a solver of this program have
/// found them? Errors that it cannot see are found by another worker's solve (SpotChecks).
/// `problem` must outlive it; `build` is its problemId.
class ResultCheck {
 public:
  ResultCheck(const Problem& problem, const ContentId& build);

  struct Judged {
    std::string objection;  ///< reason why it is no result of this build; empty if it may be one
    Outcome outcome;        ///< contents without fields; valid without objection
  };
  /// Judges a result that must be computed with `kernel_family`. The plans tell whether the
  /// transition was asked for, and LeaseSeal which worker was asked.
  ///
  /// An equilibrium must satisfy:
  /// - all numbers are finite;
  /// - det F > 0 if the scene requires it;
  /// - the residual is as small as the solver leaves it;
  /// - the derivatives are symmetric;
  /// - only a finger has a drive (configurational force);
  /// - the fixed nodes and the tool are at their positions;
  /// - at rest, displacement, energy and force are zero, and the stiffness holds the tool back.
  Judged judge(const wire::Result& result, const std::string& payload,
               const std::string& kernel_family) const;

  /// Returns true if two results of one transition agree in every reproducible bit.
  static bool agree(const wire::Result& first, const wire::Result& second);
  /// Returns the part of a result that must have the same bits from every worker. It excludes the
  /// lease, the giver and the time.
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

/// Returns how badly an equilibrium fits the one that it was reached from; `way` leads to it,
/// metres. Force and stiffness are derivatives of the energy. Two positions that are not far apart
/// therefore satisfy (Hermite quadrature)
///
///   E1 - E0 = -(f0 + f1).w / 2 + w.(K1 - K0) w / 12 + O(w^5),  f1 - f0 = (K0 + K1) w / 2 + O(w^3).
///
/// A value of 1 is the worst of 666 honest results on the shipped liver: an error of 0.3 % of the
/// work or 5 % of the force. Honest results may exceed it if the tissue snaps to another branch or
/// the way is long.
double oddnessBeside(const ToolEquilibrium& parent, const ToolEquilibrium& found,
                     const Eigen::Vector3d& way);

}  // namespace palpate
