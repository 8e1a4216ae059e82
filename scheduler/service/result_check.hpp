#pragma once

#include "common/base/bytes32.hpp"
#include "common/problem/problem.hpp"
#include "common/space/configuration.hpp"
#include "proto/palpate.pb.h"

namespace palpate {

/// Decides whether a received result could have been computed by a solver of this program. Other
/// errors are found only when another worker solves the transition again (SpotChecks). `problem`
/// must outlive this object; `build` is its problemId.
class ResultCheck {
 public:
  ResultCheck(const Problem& problem, const ContentId& build);

  struct Judged {
    std::string objection;  ///< reason to reject the result; empty if there is none
    Outcome outcome;        ///< decoded, without nodal fields; valid if there is no objection
  };
  /// Judges a result, which must have been computed with `kernel_family`. Does not judge whether
  /// the transition was requested at all (the plans know) and from this worker (isLeaseSeal()
  /// tells).
  ///
  /// An equilibrium must satisfy:
  /// - all numbers are finite;
  /// - det F > 0 if the scene requires it;
  /// - the residual is at most about a thousand times the solver's tolerance;
  /// - the derivatives are symmetric;
  /// - only a finger has a drive (configurational force);
  /// - fixed nodes have not moved, and the tool has its prescribed displacement;
  /// - at rest, displacement, energy and force are zero, and the stiffness resists every
  ///   displacement of the tool.
  Judged judge(const wire::Result& result, const std::string& payload,
               const std::string& kernel_family) const;

  /// Returns true if two results of one transition agree in every reproducible bit.
  static bool agree(const wire::Result& first, const wire::Result& second);
  /// Returns the part of a result that must have the same bits from every worker. Leaves out the
  /// lease, the worker, the duration, the number of steps, and the parent of the start.
  static std::string reproducibleBytes(wire::Result result);

 private:
  std::string objectionTo(const wire::Result& result, const Outcome& outcome,
                          const std::string& payload, const std::string& kernel_family) const;
  std::string objectionTo(const wire::Result& result, const Outcome& outcome,
                          const NodalFields& fields) const;

  const Problem* problem_;
  ContentId build_;
  Lattice lattice_;
  double diameter_;  ///< diameter of the body, m
};

/// Returns how badly the equilibrium `found` fits its `parent`, from which it was solved. `way` is
/// the tool's displacement from the parent's position to that of `found`, metres.
///
/// Force f and stiffness K are derivatives of the energy E. With w = `way`, index 0 for the parent
/// and 1 for `found`, nearby positions therefore satisfy (Hermite quadrature)
///
///   E1 - E0 = -(f0 + f1).w / 2 + w.(K1 - K0) w / 12 + O(w^5),  f1 - f0 = (K0 + K1) w / 2 + O(w^3).
///
/// The value is 1 if these equations are violated by 0.3 % of the work or by 5 % of the force, the
/// largest violations among 666 correct results on the shipped liver. A correct result may exceed 1
/// if the tissue snaps to another branch, or if w is large.
double oddnessBeside(const ToolEquilibrium& parent, const ToolEquilibrium& found,
                     const Eigen::Vector3d& way);

}  // namespace palpate
