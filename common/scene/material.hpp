#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "common/scene/formulation.hpp"

namespace palpate {

/// A term of Ogden's energy: mu/alpha (l1^alpha + l2^alpha + l3^alpha - 3), with mu alpha > 0.
struct OgdenTerm {
  double mu = 0;     ///< Pa
  double alpha = 0;  ///< dimensionless
  bool operator==(const OgdenTerm&) const = default;
};

/// A material from [material] or [[region]]. Keys that the law does not use are refused.
/// docs/solver.md and worker/laws/laws.hpp give the energies. All laws but `linear` and
/// `st-venant-kirchhoff` are isochoric energies. They are used with the constraint det F = 1, or,
/// if `bulk` is given, together with a volumetric energy.
struct Material {
  LawName law = LawName::mooney_rivlin;
  double young = 0;  ///< Pa, > 0; linear and the two St. Venant-Kirchhoff laws
  /// -1 to 0.5. Required by linear and st-venant-kirchhoff, optional for the modified law.
  std::optional<double> poisson = {};
  double c10 = 0;           ///< Pa, > 0; mooney-rivlin, yeoh
  double c01 = 0;           ///< Pa, >= 0; mooney-rivlin
  double c20 = 0, c30 = 0;  ///< Pa; yeoh; c30 >= 0
  double mu = 0;            ///< Pa, > 0; neo-hookean, holzapfel-gasser-ogden (its ground matrix)
  std::vector<OgdenTerm> ogden = {};  ///< 1 to 3 terms
  double c1 = 0, c2 = 0;              ///< veronda-westmann: c1 in Pa, c2 dimensionless; both > 0
  double k1 = 0, k2 = 0;  ///< holzapfel-gasser-ogden: k1 in Pa, k2 dimensionless; both > 0
  double dispersion = 0;  ///< holzapfel-gasser-ogden: kappa of Gasser et al. 2006, 0 to 1/3
  /// One or two unit directions at rest (holzapfel-gasser-ogden), else empty.
  std::vector<Eigen::Vector3d> fibers = {};
  /// Name of the element vectors (Mesh::element_vectors) that give the fibre directions instead of
  /// `fibers`, else empty.
  std::string fiber_field = {};
  /// Pa, > 0. If given, the material is compressible with the volumetric energy U of
  /// docs/solver.md. If absent, it is exactly incompressible. linear and the St. Venant-Kirchhoff
  /// laws do not use it.
  std::optional<double> bulk = {};
  std::optional<double> density = {};  ///< kg/m^3, > 0; required with gravity
  bool operator==(const Material&) const = default;
};

/// Returns whether the law is linear or st-venant-kirchhoff. The other laws are isochoric energies.
bool isCompressible(LawName law);
/// Returns whether the material requires det F = 1 exactly, and therefore a pressure.
bool isIncompressible(const Material& material);
/// Returns whether the pressure is an unknown in this material, provided that the discretisation
/// has a pressure space. False for the laws linear and st-venant-kirchhoff unless the material is
/// nearly incompressible.
bool isMixed(const Material& material);
/// Returns the shear modulus at rest, Pa. Pressures and residuals are scaled by it.
double shearModulus(const Material& material);
/// Returns the bulk modulus at rest, Pa; infinite for exactly incompressible materials.
double bulkModulus(const Material& material);
/// Return Young's modulus (Pa) and Poisson's ratio at rest, without fibres.
double youngModulus(const Material& material);
double poissonRatio(const Material& material);
/// The strain beyond which a material is unstable: a shear for Yeoh's law with negative c20, a
/// compression for the St. Venant-Kirchhoff law. softeningOf() returns nullopt for materials
/// without such a strain.
struct Softening {
  double strain;
  const char* kind;  ///< "shear" or "compression"
};
std::optional<Softening> softeningOf(const Material& material);
/// Returns the largest Young's modulus at rest divided by the smallest shear modulus. `materials`
/// must not be empty.
double contrastOf(const std::vector<Material>& materials);
/// Returns whether linear tetrahedra lock unless they have a pressure (Poisson's ratio > 0.49).
/// False for exactly incompressible materials, which have a pressure.
bool isNearlyIncompressible(const Material& material);

}  // namespace palpate
