#pragma once

#include "common/problem/problem.hpp"

namespace palpate {

/// What is doubtful about a problem although it can be computed, a sentence each, with the number,
/// what it probably means, and what to do:
/// - coincident nodes, pieces that hang together by nodes or edges alone;
/// - moduli of no soft tissue (0.1 to 1000 kPa at rest), a bulk modulus, density or stiffness of
///   fibres beside which others are nothing: another unit was meant;
/// - a law that is not stable at the strains of the workspace, fibres beside a small bulk modulus;
/// - pressures that violate inf-sup, elements without one that lock, one layer between rigid parts;
/// - tetrahedra that are nearly flat;
/// - `near` farther from the surface than an edge;
/// - a workspace that reaches far beyond what holds the body;
/// - single nodes under the tool, and active nodes that are the same.
/// Takes about as long as reading the mesh. `palpate check` prints them.
std::vector<std::string> warningsOf(const Problem& problem);

/// Logs them, one line each: for everything that goes on to solve.
void logWarnings(const Problem& problem);

/// Tetrahedra below this shape (1 regular, 0 flat) spoil the conditioning and invert first.
inline constexpr double near_flat_shape = 0.1;
/// How many of them there are.
std::int64_t nearlyFlat(const Mesh& mesh);

/// At most so many names are listed where there may be hundreds.
inline constexpr std::size_t listed_names = 5;

}  // namespace palpate
