#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "common/scene/formulation.hpp"

namespace palpate {

/// A term of Ogden's energy, mu/alpha (l1^alpha + l2^alpha + l3^alpha - 3); mu alpha > 0.
struct OgdenTerm {
  double mu = 0;     ///< Pa
  double alpha = 0;  ///< -
  bool operator==(const OgdenTerm&) const = default;
};

/// A material, as [material] or [[region]] gives it. Keys that the law does not take are refused.
/// The energies are in docs/solver.md and worker/laws/laws.hpp; all but the first two laws are
/// isochoric energies, to be used with det F = 1 or, with `bulk`, with a volumetric energy beside
/// them.
struct Material {
  LawName law = LawName::mooney_rivlin;
  double young = 0;  ///< Pa, > 0; linear and the two St. Venant-Kirchhoff laws
  /// -1 to 0.5; needed by linear and st-venant-kirchhoff, optional for the modified law.
  std::optional<double> poisson = {};
  double c10 = 0;           ///< Pa, > 0; mooney-rivlin, yeoh
  double c01 = 0;           ///< Pa, >= 0; mooney-rivlin
  double c20 = 0, c30 = 0;  ///< Pa; yeoh; c30 >= 0
  double mu = 0;            ///< Pa, > 0; neo-hookean, holzapfel-gasser-ogden (its ground matrix)
  std::vector<OgdenTerm> ogden = {};  ///< 1 to 3 terms
  double c1 = 0, c2 = 0;              ///< veronda-westmann: Pa and -, both > 0
  double k1 = 0, k2 = 0;              ///< holzapfel-gasser-ogden: Pa and -, both > 0
  double dispersion = 0;  ///< holzapfel-gasser-ogden: kappa of Gasser et al. 2006, 0 to 1/3
  /// holzapfel-gasser-ogden: 1 or 2 unit directions at rest, or none.
  std::vector<Eigen::Vector3d> fibers = {};
  /// Instead of `fibers`: element vectors of this name in the mesh (Mesh).
  std::string fiber_field = {};
  /// Pa, > 0. Given: compressible, with the volumetric energy U of docs/solver.md; not taken by
  /// linear and the St. Venant-Kirchhoff laws. Absent: exactly incompressible.
  std::optional<double> bulk = {};
  std::optional<double> density = {};  ///< kg/m^3, > 0; needed when there is gravity
  bool operator==(const Material&) const = default;
};

/// Whether the material is used with det F = 1 exactly, and so needs a pressure.
bool isIncompressible(const Material& material);
/// Whether the material has a pressure when there is a pressure space: exactly or nearly
/// incompressible.
bool isMixed(const Material& material);
/// Shear modulus at rest, Pa: what pressures and residuals are scaled by.
double shearModulus(const Material& material);
/// Bulk modulus at rest, Pa; infinite for exactly incompressible materials.
double bulkModulus(const Material& material);
/// Young's modulus (Pa) and Poisson's ratio at rest. Fibres are not counted.
double youngModulus(const Material& material);
double poissonRatio(const Material& material);
/// The strain beyond which a law is unstable: a shear for Yeoh's with a negative c20, a compression
/// for St. Venant-Kirchhoff's. Empty for the other laws.
struct Softening {
  double strain;
  const char* kind;  ///< "shear" or "compression"
};
std::optional<Softening> softeningOf(const Material& material);
/// The largest Young's modulus at rest divided by the smallest shear modulus. `materials` is not
/// empty.
double contrastOf(const std::vector<Material>& materials);
/// Whether the volume resists so much more than the shape (Poisson's ratio > 0.49) that linear
/// tetrahedra without a pressure lock. Exactly incompressible materials, which have a pressure, do
/// not count.
bool isNearlyIncompressible(const Material& material);

}  // namespace palpate
