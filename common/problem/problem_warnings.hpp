#pragma once

#include "common/problem/problem.hpp"

namespace palpate {

/// Returns a sentence for each doubtful property of a problem that can still be computed. Each
/// gives the number, its probable cause and the remedy. Reported are
/// - coincident nodes, and parts that are joined by nodes or edges only;
/// - moduli outside those of soft tissue (0.1 to 1000 kPa at rest), and a bulk modulus, density or
///   fibre stiffness that suggests another unit;
/// - a law that is not stable at the strains of the workspace, and fibres with a small bulk
///   modulus;
/// - pressures that violate inf-sup, elements without a pressure that lock, and single layers of
///   elements between rigid parts;
/// - nearly flat tetrahedra;
/// - `near` farther from the surface than an edge;
/// - a workspace much larger than the distance from the active nodes to the fixed nodes;
/// - single nodes under the tool, and active nodes that coincide.
///
/// Takes about as long as reading the mesh. `palpate check` prints the sentences.
std::vector<std::string> warningsOf(const Problem& problem);

/// Logs the warnings, one line each, before a solve.
void logWarnings(const Problem& problem);

/// Tetrahedra below this shape (1 regular, 0 flat) spoil the conditioning and invert first.
inline constexpr double near_flat_shape = 0.1;
/// Returns the number of tetrahedra below near_flat_shape.
std::int64_t nearlyFlat(const Mesh& mesh);

/// Largest number of names in a message that could list hundreds.
inline constexpr std::size_t listed_names = 5;

}  // namespace palpate
