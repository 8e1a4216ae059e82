#pragma once

#include "common/mesh/finger_weights.hpp"
#include "common/space/configuration.hpp"
#include "worker/solver/system.hpp"

namespace palpate {

/// Computes the third derivatives of the energy E(s, p) of a finger at `state`, and stores them in
/// `equilibrium`.
///
/// First-order sensitivities suffice for third derivatives of a minimum (the 2n + 1 theorem,
/// Wigner). Let x_a be the change of the state when p or s moves in the direction a. Then
///
///   d3E/da db dc = d3 Pi [x_a, x_b, x_c] - d3 G [a, b, c]
///
/// Pi is the energy of the elements. G = multiplier . B(s) (u - u_rest), where B(s) has the weights
/// of the finger. In d3 G, s moves along a, b and c, and u and the multiplier move by their first
/// derivatives. The third derivative of Pi is computed from central differences of the tangent
/// along x_a.
///
/// `sensitivity` has the derivatives of the unknowns and multipliers: three columns for
/// p, then three for s. `finger` must be the tool of `system`. Costs six tangents and no
/// factorisation. The results are right to about seven digits.
///
/// If the stiffness of an element jumps between the two states of a central difference (slack
/// fibres become taut), the result is the jump divided by the step. That number is useless, and
/// LocalFits::judge detects it. At rest all fibres are at the jump. The results are not finite if
/// the state is too close to an inverted element.
void setThirdDerivatives(const System& system, const State& state,
                         const Eigen::MatrixXd& sensitivity, const FingerWeights& finger,
                         Equilibrium& equilibrium);

}  // namespace palpate
