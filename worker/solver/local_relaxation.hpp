#pragma once

#include <Eigen/Core>

#include "worker/solver/system.hpp"

namespace palpate {

/// Brings the nodes around a rigid tool to equilibrium while everything else is held where `state`
/// has it.
///
/// A tool that moves by more than an element's size strains the elements beside it far beyond the
/// rest of the body; Newton spends most of its tangents there, or inverts one of them. Solving the
/// few equations near the tool first is nonlinear elimination (Lanzkron, Rose and Wilkes 1996; Cai
/// and Keyes 2002): what is left for the whole body is smooth, and one tangent suffices.
///
/// Newton with a line search and a dense matrix of the neighbourhood's size. `state` becomes the
/// solution when the residual norm falls to `tolerance` (N), which is returned as true, and is
/// unchanged otherwise.
bool relaxNearTool(const System& system, const Neighborhood& neighborhood, State& state,
                   double tolerance);

}  // namespace palpate
