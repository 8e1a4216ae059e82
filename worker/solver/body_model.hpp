#pragma once

#include <Eigen/Core>
#include <array>

#include "common/problem/problem.hpp"

namespace palpate {

/// Returns the three values of a node in an array of nNodes x 3, to read or to write.
inline auto ofNode(auto& rows, std::size_t node) { return Eigen::Vector3d::Map(&rows[3 * node]); }

/// A tool. Its displacement p prescribes the displacement of each node (rigid tool), or only the
/// weighted mean of the displacements of its nodes (weighted tool).
struct Tool {
  std::vector<std::int32_t> nodes;
  /// One weight per node; the weights add up to 1. The tool prescribes that the sum of w_i u_i
  /// exceeds its value at rest by p. Empty for a rigid tool.
  std::vector<double> weights;
};

/// A body with its supports and loads, as a System discretises it.
///
/// bodyModel() makes one from a Problem. Verification cases make theirs directly; they may fix
/// single components of a displacement, load nodes, and have no tool. A System owns a copy.
struct BodyModel {
  Mesh mesh;  ///< with mid-edge nodes exactly when discretization.displacement is P2
  Discretization discretization;
  std::vector<Material> materials;
  std::vector<std::uint16_t> region_of;                ///< per tetrahedron, index into `materials`
  std::vector<std::array<Eigen::Vector3d, 2>> fibers;  ///< as Problem::fibers
  std::vector<std::uint8_t> fixed;  ///< nNodes x 3, 1 where the displacement is prescribed
  std::vector<double> load;         ///< nNodes x 3, dead nodal forces, N; may be empty
  std::vector<Tool> tools;          ///< may be empty
};

/// Returns the pressure space of the elements of a region: the pressure space of the body, or none
/// if the energy of the material already penalises changes of volume.
PressureSpace pressureSpaceOf(const BodyModel& model, std::size_t region);

/// Returns the pressure slots of this body.
PressureSlots pressureSlots(const BodyModel& model);

/// Returns whether a material is more than 1e4 times stiffer than the softest one, so that its
/// region moves almost as a rigid body.
bool hasNearlyRigidPart(const BodyModel& model);

/// Builds the body of a problem: materials by region, fixed nodes, gravity as nodal loads, one tool
/// per active patch.
BodyModel bodyModel(const Problem& problem);

/// Add dead nodal loads to `model`: addTraction applies `traction` (Pa, per rest area) to faces of
/// the surface, each given by its three vertices. addGravity applies `acceleration` (m/s^2) times
/// the density to the whole body; Error (bad input) if a material has no density.
void addTraction(BodyModel& model, const std::vector<Triangle>& faces,
                 const Eigen::Vector3d& traction);
void addGravity(BodyModel& model, const Eigen::Vector3d& acceleration);

}  // namespace palpate
