#pragma once

#include "common/mesh/finger_weights.hpp"
#include "common/space/configuration.hpp"
#include "worker/solver/system.hpp"

namespace palpate {

/// Sets what of `equilibrium` are third derivatives of the energy E(s, p) of a finger at `state`,
/// from first-order sensitivities alone: those of a minimum to the third order need no more (the
/// 2n + 1 theorem, Wigner). With x_a what the state changes by when p or s moves along a,
///
///   d3E/da db dc = d3 Pi [x_a, x_b, x_c] - the third derivative of multiplier . B(s) (u - u_rest)
///
/// in the directions a, b, c, all of B, u and the multiplier moving; Pi the energy of the elements,
/// whose third derivative is that of the tangent along x_a, by central differences.
///
/// `sensitivity`: d(unknowns, multipliers) by p (three columns), then by s. The system has the
/// finger as its tool. Costs six tangents and no factorisation; right to about seven digits. Where
/// the stiffness of an element jumps within the differences (slack fibres grow taut) they are that
/// jump over their step instead, and of no use: LocalFits::judge tells. At rest all fibres are
/// there. The numbers are not finite when the state is that close to an inverted element.
void setThirdDerivatives(const System& system, const State& state,
                         const Eigen::MatrixXd& sensitivity, const FingerWeights& finger,
                         Equilibrium& equilibrium);

}  // namespace palpate
