#pragma once

#include <optional>

#include "worker/solver/assembler.hpp"

namespace palpate {

/// The state of a body: displacements and pressures of all nodes, including fixed and tool nodes,
/// and the tool's position.
struct State {
  std::vector<double> u;  ///< nNodes x 3 displacements, metres
  /// Scaled pressures by slot (PressureSlots); the pressure is p = System::pressureScale() q. Zero
  /// in the slot of a node around which no material has a pressure. Empty if the body has no
  /// pressure space.
  std::vector<double> q;
  /// p, the displacement of the tool from rest, metres.
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();
  /// Lagrange multiplier of a weighted tool, N; zero for other tools.
  Eigen::Vector3d multiplier = Eigen::Vector3d::Zero();
  /// The same two of the hold (System::hold), metres and N; zero without a hold.
  Eigen::Vector3d held_displacement = Eigen::Vector3d::Zero();
  Eigen::Vector3d held_multiplier = Eigen::Vector3d::Zero();
};

/// The residual of the equations at one state. Vectors over the unknowns have unknowns() +
/// multipliers() rows; the multipliers of the hold and then those of a weighted tool are the last
/// rows.
struct Residual {
  /// dL/d(unknown), newtons; pressure rows are scaled to newtons. Zero in rows of unknowns that the
  /// tool holds. Multiplier rows contain the gap p - B (u - u_rest), metres, where B has the
  /// weights of the tool.
  Eigen::VectorXd free;
  /// dL/dp, newtons: the force that the tool must exert. The tissue's force on the tool is its
  /// negative.
  Eigen::Vector3d tool;
  double energy = 0;                ///< L minus its value at rest, J
  double min_det_F = 1;             ///< smallest det F at the quadrature points
  std::int32_t worst_element = -1;  ///< element of min_det_F, index into Mesh::tetrahedra
  /// Euclidean norm of `free`, newtons, with the gap multiplied by forceScale() / meanEdge(). NaN
  /// or infinite if the state is not admissible.
  double norm = 0;
};

/// The tangent at one state, for one tool. With a weighted tool, the matrix of a Newton step is [K
/// border; border^T 0].
struct Tangent {
  /// K, one value per entry of System::pattern(). In the row of an unknown that the tool holds,
  /// only the diagonal is not zero.
  std::vector<double> values;
  Eigen::MatrixXd border;  ///< unknowns() x multipliers(), -B^T of the hold and of the tool
  /// d(Residual::free)/dp, N/m. For a rigid tool this is K_fa, the block of K between free unknowns
  /// f and the tool a. For a weighted tool it is zero, except for the identity in the multiplier
  /// rows.
  Eigen::Matrix<double, Eigen::Dynamic, 3> tool_coupling;
  Eigen::Matrix3d tool;  ///< d2L/dp2, N/m: K_aa of a rigid tool, otherwise zero
};

/// The unknowns of some nodes around a rigid tool, with the batches of elements that contain these
/// nodes. System can assemble the equations of these unknowns alone, with all other unknowns held.
/// Valid only for the System that made it, and only while the same tool is chosen.
struct Neighborhood {
  struct Entry {
    std::int32_t number;       ///< index in SparsityPattern
    std::int32_t row, column;  ///< in the matrix of `unknowns`, row <= column
  };
  std::vector<std::int32_t> unknowns;  ///< ascending
  std::vector<std::int32_t> batches;   ///< ascending, indices into ElementBatches::all
  std::vector<Entry> entries;
};

/// The discretised body. Assembles energy, residual and tangent of
///
///   L(u, q) - load . u  [+ multiplier . (p - B (u - u_rest))  with a weighted tool, B the weights]
///
/// A hold adds a term of the same form.
///
/// Unknowns that a rigid tool holds stay in the matrix, in rows that have only a diagonal entry.
/// These include the pressures that are undetermined while the tool holds its nodes
/// (idlePressures). The multipliers of a weighted tool border the matrix. So all tools share one
/// sparsity pattern, which is analysed once.
///
/// Sums are taken in a fixed order: the same state gives the same bits on every machine that runs
/// the same kernels. Not thread-safe; one per worker process.
class System {
 public:
  /// Chooses the first of BodyModel::tools, if there is one.
  System(BodyModel model, const ElementKernels& kernels);
  System(const Problem& problem, const ElementKernels& kernels)
      : System(bodyModel(problem), kernels) {}
  System(const System&) = delete;
  System& operator=(const System&) = delete;

  std::int32_t unknowns() const { return unknowns_.count(); }
  std::int32_t multipliers() const { return static_cast<std::int32_t>(border_.cols()); }
  /// Returns the number of negative eigenvalues that the matrix of a Newton step has at a stable
  /// equilibrium: one for each pressure unknown that is not held, and one for each multiplier.
  /// Returns nullopt if the displacement and pressure spaces violate the inf-sup condition. They
  /// then have spurious modes, with eigenvalues near zero of either sign, and the count is
  /// meaningless.
  std::optional<std::int32_t> expectedNegativePivots() const;
  const DofMap& numbers() const { return unknowns_; }  ///< the numbers of the unknowns
  const SparsityPattern& pattern() const { return pattern_; }
  const BodyModel& model() const { return model_; }
  const ElementKernels& kernels() const { return kernels_; }
  const Eigen::MatrixXd& border() const { return border_; }  ///< as Tangent::border

  double meanEdge() const { return mean_edge_; }  ///< h, mean length of the edges, m
  double pressureScale() const { return shear_modulus_ / mean_edge_; }  ///< Pa
  /// mu h^2, newtons, where mu is the smallest shear modulus in the body. This is the size of a
  /// nodal force at a strain of one. Tolerances are relative to it, so the softest material is
  /// solved as accurately as if it were alone.
  double forceScale() const { return shear_modulus_ * mean_edge_ * mean_edge_; }

  /// Sum of the magnitudes of the nodal loads, newtons, without the load factor. The round-off of a
  /// residual is relative to totalLoad() + forceScale().
  double totalLoad() const { return total_load_; }

  /// Choose the tool that moves the body, or none, which also ends a hold. No node of the tool may
  /// be fixed. An index selects one of BodyModel::tools.
  void chooseTool(Tool tool);
  void chooseTool(std::size_t tool) { chooseTool(model_.tools.at(tool)); }
  void releaseTool();
  /// Lets a second weighted tool hold the body while the chosen tool moves it: its weighted mean
  /// displacement stays at State::held_displacement. nullopt: nothing holds the body. The chosen
  /// tool must be weighted too, and must not have the same weights.
  void hold(std::optional<Tool> tool);
  const std::optional<Tool>& tool() const { return tool_; }  ///< the chosen tool

  /// Multiplies the loads by this factor, 1 by default.
  void setLoadFactor(double factor) { load_factor_ = factor; }

  /// Sets the rest state, from which p and the energy are measured, for instance the equilibrium
  /// under gravity. Nodes of a rigid tool have the displacement rest.u + p. By default u = 0 and q
  /// = 0 at rest. That is an equilibrium without loads, because every law here is stress-free at F
  /// = I. The energy at rest is computed with the present loads.
  void setRest(const State& rest);
  const State& restState() const { return rest_; }

  /// Returns state + factor * step, with the tool at `displacement` (metres). `step` has one row
  /// per unknown and multiplier.
  State moved(const State& state, const Eigen::VectorXd& step, double factor,
              const Eigen::Vector3d& displacement) const;

  /// Returns the rows of a vector over the unknowns that belong to displacements, metres.
  Eigen::VectorXd displacementsOf(const Eigen::VectorXd& unknowns) const;

  /// Assemble the residual, and optionally the tangent, at `state`, which has the sizes of
  /// restState(). For an inadmissible state the norm is not finite; nothing is thrown.
  void assemble(const State& state, Residual& residual) const { run(state, residual, nullptr); }
  void assemble(const State& state, Residual& residual, Tangent& tangent) const {
    run(state, residual, &tangent);
  }

  /// Returns the neighbourhood of the `count` nodes nearest to the chosen rigid tool, or of all
  /// nodes if there are fewer.
  Neighborhood neighborhood(std::size_t count) const;
  /// Assembles the equations of the neighbourhood's unknowns only. `residual` gets their
  /// entries of Residual::free, and `tangent` both triangles of their symmetric matrix.
  void assemble(const State& state, const Neighborhood& neighborhood, Eigen::VectorXd& residual,
                Eigen::MatrixXd& tangent) const;

 private:
  void run(const State& state, Residual& residual, Tangent* tangent) const;
  void accumulate(std::int32_t batch, const State& state, Residual& residual,
                  bool with_tangent) const;
  void addLoads(const State& state, Residual& residual) const;
  void finishResidual(const State& state, Residual& residual) const;
  void finishTangent(Tangent& tangent) const;
  const Tool* rigidTool() const;
  const Tool* weightedTool() const;
  void clearTool();
  void setBorder();
  Eigen::Vector3d gapOf(const Tool& tool, const State& state, const Eigen::Vector3d& p) const;

  // Each member is made from earlier ones, and sums_ keeps references, so the order matters.
  const BodyModel model_;
  const ElementKernels& kernels_;
  const double mean_edge_;                           ///< metres
  const double shear_modulus_;                       ///< smallest of the materials, Pa
  const std::vector<ElementParameters> parameters_;  ///< per material
  const PressureSlots pressures_;
  const DofMap unknowns_;
  const ElementBatches batches_;
  const SparsityPattern pattern_;
  mutable Assembler sums_;  ///< sums of the assembly in progress

  std::optional<Tool> tool_, hold_;
  std::vector<std::int32_t> idle_;  ///< idlePressures of a rigid tool_ that are unknowns
  Eigen::MatrixXd border_;          ///< Tangent::border
  double load_factor_ = 1;
  double total_load_ = 0;  ///< newtons
  State rest_;
  double energy_at_rest_ = 0;
};

}  // namespace palpate
