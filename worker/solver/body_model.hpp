#pragma once

#include <Eigen/Core>
#include <array>

#include "common/problem/problem.hpp"

namespace palpate {

/// The three components of a node in an array of nNodes x 3, to read or to write.
inline auto ofNode(auto& rows, std::size_t node) { return Eigen::Vector3d::Map(&rows[3 * node]); }

/// What moves: some nodes by the tool's displacement p (rigid), or only their weighted mean.
struct Tool {
  std::vector<std::int32_t> nodes;
  /// Empty: rigid. Else one per node, sum 1: sum of w_i u_i = p (+ its value at rest).
  std::vector<double> weights;
};

/// A body with its supports and loads as a System discretises it: what a Problem means to the
/// solver, and what verification problems are written in, which hold single components, load nodes
/// and have no tool.
///
/// Kept by value: a System owns its copy.
struct BodyModel {
  Mesh mesh;  ///< with mid-edge nodes exactly when discretization.displacement is P2
  Discretization discretization;
  std::vector<Material> materials;
  std::vector<std::uint16_t> region_of;                ///< per tetrahedron, index into `materials`
  std::vector<std::array<Eigen::Vector3d, 2>> fibers;  ///< as Problem::fibers
  std::vector<std::uint8_t> fixed;  ///< nNodes x 3: 1 where the displacement stays as it is
  std::vector<double> load;  ///< nNodes x 3, dead nodal forces, N; empty: none. Gravity is in it
  std::vector<Tool> tools;   ///< may be empty
};

/// The pressure that the elements of a region have: that of the body, or none where the material
/// keeps its volume by a term of its energy.
PressureSpace pressureSpaceOf(const BodyModel& model, std::size_t region);

/// The pressures that a System of this body has.
PressureSlots pressureSlots(const BodyModel& model);

/// Whether a material is more than 1e4 times stiffer than the softest one, so that its region moves
/// almost as a rigid body.
bool hasNearlyRigidPart(const BodyModel& model);

/// The body of a problem: materials by region, fixed nodes, gravity as nodal loads, one tool per
/// active patch.
BodyModel bodyModel(const Problem& problem);

/// Adds dead nodal loads to `model`: `traction` (Pa, on the rest area) over these surface triangles
/// (vertices of faces of the mesh), or `acceleration` (m/s^2) times each material's density over
/// the whole body. Error (bad input) when a material has no density.
void addTraction(BodyModel& model, const std::vector<Triangle>& faces,
                 const Eigen::Vector3d& traction);
void addGravity(BodyModel& model, const Eigen::Vector3d& acceleration);

}  // namespace palpate
