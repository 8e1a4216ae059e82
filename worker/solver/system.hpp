#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "worker/elements/element_kernels.hpp"
#include "worker/solver/body_model.hpp"

namespace palpate {

/// Where the body is: the unknowns of every node, the fixed and the displaced ones included, and
/// the tool.
struct State {
  std::vector<double> u;  ///< nNodes x 3 displacements, metres
  /// Scaled pressures, p = System::pressureScale() q, of the vertices or with P2 pressure of all
  /// nodes; zero where no material around the node has a pressure. Empty without a pressure space.
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
  Eigen::Vector3d tool;  ///< dL/dp, newtons: what the tool must exert; the tissue's force on the
                         ///< tool is its negative
  double energy = 0;     ///< L less its value at rest, J
  double min_det_F = 1;
  std::int32_t worst_element = -1;  ///< where min_det_F is, index into Mesh::tetrahedra
  /// Euclidean norm of `free`, newtons, the gap times forceScale() / mean edge; NaN or infinite
  /// when the state is not admissible.
  double norm = 0;
};

/// The tangent at one state, for one tool. With a weighted tool the matrix of a Newton step is
/// [K border; border^T 0].
struct Tangent {
  std::vector<double>
      values;              ///< K by System::pattern(), upper triangle; held rows are the identity's
  Eigen::MatrixXd border;  ///< unknowns() x multipliers(), -B^T
  /// d(Residual::free)/dp, N/m. A rigid tool's K_fa; for a weighted one zero, but the identity at
  /// the bottom.
  Eigen::Matrix<double, Eigen::Dynamic, 3> tool_coupling;
  Eigen::Matrix3d tool;  ///< d2L/dp2, N/m: K_aa of a rigid tool, else zero
};

/// The unknowns of some nodes around a rigid tool, with the elements they occur in: what System
/// needs to assemble the equations of these unknowns while all others are held. Valid for the tool
/// it was made for.
struct Neighborhood {
  std::vector<std::int32_t> unknowns;  ///< sorted
  std::vector<std::int32_t> batches;   ///< System's own numbers
  struct Entry {
    std::int32_t slot, row, column;  ///< of the pattern; of the small matrix, row <= column
  };
  std::vector<Entry> entries;
};

/// Sparsity of the upper triangle, one entry per position, 1-based as MUMPS wants it.
struct Pattern {
  std::int32_t n = 0;
  std::vector<std::int32_t> row, column;
};

/// The discretised body: numbers the unknowns, assembles energy, residual and tangent of
///
///   L(u, q) - load . u  [+ multiplier . (p - B (u - u_rest))  with a weighted tool, B the weights]
///
/// Unknowns are the displacements that are not fixed and the pressures of the nodes that touch a
/// material with a pressure, node by node (Dirichlet values are eliminated). What a rigid tool
/// holds stays in the system as rows of the identity, and the multipliers of a weighted tool stand
/// beside it as a border, so that one sparsity pattern, and with it one analysis, serves every
/// tool.
///
/// Sums are taken in a fixed order: the same state gives the same bits on every machine that runs
/// the same kernels. Not thread-safe; one per worker process.
class System {
 public:
  /// The first tool is chosen, if there is one.
  System(BodyModel model, const ElementKernels& kernels);
  System(const Problem& problem, const ElementKernels& kernels)
      : System(bodyModel(problem), kernels) {}

  std::int32_t unknowns() const { return pattern_.n; }
  std::int32_t multipliers() const { return static_cast<std::int32_t>(border_.cols()); }
  /// Negative eigenvalues of K at a stable equilibrium of a rigid tool: one for each pressure
  /// unknown. Nothing where displacement and pressure violate the inf-sup condition: the spurious
  /// modes have eigenvalues near zero of either sign, so that the count says nothing.
  std::optional<std::int32_t> expectedNegativePivots() const;
  const Pattern& pattern() const { return pattern_; }
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

  /// What moves, an index into BodyModel::tools; or nothing does.
  void chooseTool(std::size_t tool);
  void releaseTool();
  std::optional<std::size_t> tool() const { return tool_; }

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

  void assemble(const State& state, Residual& residual) const;
  void assemble(const State& state, Residual& residual, Tangent& tangent) const;

  /// The `count` nodes nearest to the chosen rigid tool.
  Neighborhood neighborhood(std::size_t count) const;
  /// The equations of these unknowns only: residual as in Residual::free, tangent the full
  /// symmetric matrix.
  void assemble(const State& state, const Neighborhood& neighborhood, Eigen::VectorXd& residual,
                Eigen::MatrixXd& tangent) const;

  /// Quadratic elements are assembled from det F at quadrature points; this lowers min_det_F to the
  /// smallest one at the nodes of an element.
  void lookAtNodes(const State& state, Residual& residual) const;

 private:
  /// Elements of one material, in the order of the mesh.
  struct Batch {
    BatchGeometry geometry;
    std::array<std::int32_t, lanes> element;  ///< -1 in lanes that are left over
    std::uint16_t material;
    std::size_t first_row, first_entry;  ///< into row_slots_ and entry_slots_
  };
  /// Equation of a local unknown: node, and component of the displacement or 3 for the pressure.
  struct Place {
    std::int32_t node;
    int component;
  };

  void prepareMaterials();
  void numberUnknowns();
  bool isFixed(const std::vector<std::int32_t>& nodes) const;
  void buildBatches();
  void addBatch(const std::vector<std::int32_t>& elements, std::size_t first);
  void buildPattern();
  void buildScatter();
  template <bool with_tangent>
  void run(const State& state, Residual& residual, Tangent* tangent) const;
  template <bool with_tangent>
  void accumulate(const Batch& batch, const State& state, Residual& residual) const;
  void startRows(const State& state, Residual& residual) const;
  void finishResidual(const State& state, Residual& residual) const;
  void finishTangent(Tangent& tangent) const;

  std::int32_t localUnknowns(const Batch& batch) const;
  Place placeOf(const Batch& batch, int local_unknown, int lane) const;
  void fillSlots(const Batch& batch);
  std::int32_t rowSlot(const Place& place) const;
  std::int32_t entrySlot(const Place& a, const Place& b) const;
  void hold(const Tool& tool, std::uint8_t flag);
  const Tool* rigidTool() const;
  const Tool* weightedTool() const;
  std::int32_t unknownOf(const Place& place) const {
    return unknown_of_[4 * place.node + place.component];
  }

  BodyModel model_;
  const ElementKernels& kernels_;
  std::vector<ElementParameters> parameters_;  ///< per material
  double shear_modulus_ = 0;                   ///< the smallest, Pa
  double mean_edge_ = 0;                       ///< metres
  std::int32_t pressures_ = 0;                 ///< unknowns among them
  std::optional<std::size_t> tool_;
  double load_factor_ = 1;
  double total_load_ = 0;  ///< newtons
  State rest_;
  double energy_at_rest_ = 0;

  std::vector<std::int32_t> unknown_of_;  ///< nNodes x 4, -1 where there is none
  std::vector<std::uint8_t> held_;        ///< nUnknowns, 1 where the rigid tool holds it
  Pattern pattern_;
  std::vector<std::int32_t> first_entry_;  ///< per unknown, start of its row in pattern_ (rows
                                           ///< sorted by column): its diagonal
  Eigen::MatrixXd border_;                 ///< Tangent::border

  std::vector<Batch> batches_;
  std::vector<std::int32_t> row_slots_;  ///< batch x local unknown x lane, into the residual buffer
  std::vector<std::int32_t> entry_slots_;  ///< batch x local entry x lane, into the value buffer
  std::vector<std::vector<std::int32_t>> batches_of_node_;
  mutable std::vector<double> rows_,
      values_;  ///< assembly buffers: unknowns or entries, then the tool's, then a sink
};

}  // namespace palpate
