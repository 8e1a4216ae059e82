#pragma once

#include "common/problem/problem.hpp"

namespace palpate {

/// Returns a warning for each property of a problem that is probably a mistake, although the
/// problem can be computed. Each warning gives the number in question, its probable cause and the
/// remedy. It reports
/// - coincident nodes, and parts that are joined by nodes or edges only;
/// - a Young's modulus outside the range of soft tissue (0.1 to 1000 kPa at rest), and a bulk
///   modulus, density or fibre stiffness that suggests another unit;
/// - a law that is not stable at the strains of the workspace, and fibres with a small bulk
///   modulus;
/// - pressure spaces that violate the inf-sup condition, elements that lock because they have no
///   pressure, and single layers of elements between the tool and a fixed or nearly rigid part;
/// - nearly flat tetrahedra;
/// - a position `near` that is farther from the surface than the mean edge length;
/// - a workspace much larger than the distance from the active nodes to the fixed nodes;
/// - tools that are a single node, and active nodes that coincide.
///
/// Takes about as long as reading the mesh. `palpate check` prints the warnings.
std::vector<std::string> warningsOf(const Problem& problem);

/// Logs the warnings, one line each, before a solve.
void logWarnings(const Problem& problem);

/// Number of names that a message lists before "and N more".
inline constexpr std::size_t listed_names = 5;

}  // namespace palpate
