#pragma once

#include <optional>

#include "worker/solver/assembler.hpp"

namespace palpate {

/// Where the body is: the unknowns of every node, the fixed and the displaced ones included, and
/// the tool.
struct State {
  std::vector<double> u;  ///< nNodes x 3 displacements, metres
  /// Scaled pressures, p = System::pressureScale() q, by slot (PressureSlots); zero where no
  /// material around the node has a pressure. Empty without a pressure space.
  std::vector<double> q;
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  ///< of the tool from rest, p, metres
  Eigen::Vector3d multiplier = Eigen::Vector3d::Zero();    ///< of a weighted tool, N; else zero
};

/// The equations at one state. A vector over the unknowns has unknowns() + multipliers() rows, the
/// multipliers of a weighted tool last.
struct Residual {
  /// Derivatives of L, newtons, pressure rows scaled to newtons; zero at the rows that are held by
  /// the tool. At the multipliers the gap p - B (u - u_rest), metres.
  Eigen::VectorXd free;
  /// dL/dp, newtons: what the tool must exert; the tissue's force on the tool is its negative.
  Eigen::Vector3d tool;
  double energy = 0;                ///< L less its value at rest, J
  double min_det_F = 1;             ///< of the quadrature points
  std::int32_t worst_element = -1;  ///< where min_det_F is, index into Mesh::tetrahedra
  /// Euclidean norm of `free`, newtons, the gap times forceScale() / mean edge; NaN or infinite
  /// when the state is not admissible.
  double norm = 0;
};

/// The tangent at one state, for one tool. With a weighted tool the matrix of a Newton step is
/// [K border; border^T 0].
struct Tangent {
  std::vector<double> values;  ///< K by System::pattern(); held rows are the identity's
  Eigen::MatrixXd border;      ///< unknowns() x multipliers(), -B^T
  /// d(Residual::free)/dp, N/m. A rigid tool's K_fa; for a weighted one zero, but the identity at
  /// the bottom.
  Eigen::Matrix<double, Eigen::Dynamic, 3> tool_coupling;
  Eigen::Matrix3d tool;  ///< d2L/dp2, N/m: K_aa of a rigid tool, else zero
};

/// The unknowns of some nodes around a rigid tool, with the elements they occur in: what System
/// needs to assemble the equations of these unknowns while all others are held. Valid for the tool
/// and the System it was made for.
struct Neighborhood {
  struct Entry {
    std::int32_t number;       ///< of SparsityPattern
    std::int32_t row, column;  ///< of the small matrix, row <= column
  };
  std::vector<std::int32_t> unknowns;  ///< ascending
  std::vector<std::int32_t> batches;   ///< ascending, indices into ElementBatches::all
  std::vector<Entry> entries;
};

/// The discretised body: assembles energy, residual and tangent of
///
///   L(u, q) - load . u  [+ multiplier . (p - B (u - u_rest))  with a weighted tool, B the weights]
///
/// What a rigid tool holds stays in the system as rows of the identity, pressures that say nothing
/// then (idlePressures) among it, and the multipliers of a
/// weighted tool stand beside it as a border, so that one sparsity pattern, and with it one
/// analysis, serves every tool.
///
/// Sums are taken in a fixed order: the same state gives the same bits on every machine that runs
/// the same kernels. Not thread-safe; one per worker process.
class System {
 public:
  /// The first tool is chosen, if there is one.
  System(BodyModel model, const ElementKernels& kernels);
  System(const Problem& problem, const ElementKernels& kernels)
      : System(bodyModel(problem), kernels) {}
  System(const System&) = delete;
  System& operator=(const System&) = delete;

  std::int32_t unknowns() const { return unknowns_.count(); }
  std::int32_t multipliers() const { return static_cast<std::int32_t>(border_.cols()); }
  /// Negative eigenvalues of the matrix of a Newton step at a stable equilibrium: one for each
  /// pressure unknown that is not held and each multiplier. Nothing where displacement and pressure
  /// violate the inf-sup condition: the spurious modes have eigenvalues near zero of either sign,
  /// so that the count says nothing.
  std::optional<std::int32_t> expectedNegativePivots() const;
  const DofMap& numbers() const { return unknowns_; }  ///< which unknown is where
  const SparsityPattern& pattern() const { return pattern_; }
  const BodyModel& model() const { return model_; }
  const ElementKernels& kernels() const { return kernels_; }

  double meanEdge() const { return mean_edge_; }  ///< h, of the tetrahedra's edges, m
  double pressureScale() const { return shear_modulus_ / mean_edge_; }  ///< Pa
  /// mu h^2, newtons, mu the smallest shear modulus in the body: the size of a nodal force at
  /// strain one. Tolerances are relative to it, so the softest material is solved as well as if it
  /// were alone.
  double forceScale() const { return shear_modulus_ * mean_edge_ * mean_edge_; }

  /// Sum of the magnitudes of the nodal loads, newtons, whatever the load factor: the other size of
  /// forces, beside forceScale(), that round-off is relative to.
  double totalLoad() const { return total_load_; }

  /// What moves: a tool of nodes that are not fixed, for instance one of BodyModel::tools by its
  /// index; or nothing does.
  void chooseTool(Tool tool);
  void chooseTool(std::size_t tool) { chooseTool(model_.tools.at(tool)); }
  void releaseTool();
  const std::optional<Tool>& tool() const { return tool_; }  ///< the chosen one

  /// The loads times this factor, 1 unless said otherwise.
  void setLoadFactor(double factor) { load_factor_ = factor; }

  /// What p and the energy are measured from, for instance the equilibrium under gravity: a rigid
  /// tool's nodes are at rest.u + p. u = 0 and q = 0 unless said otherwise; without loads that is
  /// an equilibrium, because every law here is stress-free at F = I. The energy at rest is taken
  /// with the loads of now.
  void setRest(const State& rest);
  const State& restState() const { return rest_; }

  /// state + factor * step, step over the unknowns, with the tool at `displacement` (metres).
  State moved(const State& state, const Eigen::VectorXd& step, double factor,
              const Eigen::Vector3d& displacement) const;

  /// The displacements, metres, in a vector over the unknowns.
  Eigen::VectorXd displacementsOf(const Eigen::VectorXd& unknowns) const;

  /// The equations at `state`, which has the sizes of restState(), and the tangent where it is
  /// asked for. A state that is not admissible has a norm that is not finite; nothing is thrown.
  void assemble(const State& state, Residual& residual) const { run(state, residual, nullptr); }
  void assemble(const State& state, Residual& residual, Tangent& tangent) const {
    run(state, residual, &tangent);
  }

  /// Of the `count` nodes nearest to those that the chosen rigid tool holds, or of all there are.
  Neighborhood neighborhood(std::size_t count) const;
  /// The equations of these unknowns only: residual as in Residual::free, tangent the full
  /// symmetric matrix.
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

  // The order matters: each of these is made from those before it, and the last keeps references.
  const BodyModel model_;
  const ElementKernels& kernels_;
  const double mean_edge_;                           ///< metres
  const double shear_modulus_;                       ///< the smallest, Pa
  const std::vector<ElementParameters> parameters_;  ///< per material
  const PressureSlots pressures_;
  const DofMap unknowns_;
  const ElementBatches batches_;
  const SparsityPattern pattern_;
  mutable Assembler sums_;  ///< of the assembly that is going on

  std::optional<Tool> tool_;
  std::vector<std::int32_t> idle_;  ///< idlePressures of a rigid tool_, those with an unknown
  Eigen::MatrixXd border_;          ///< Tangent::border
  double load_factor_ = 1;
  double total_load_ = 0;  ///< newtons
  State rest_;
  double energy_at_rest_ = 0;
};

}  // namespace palpate
