#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "common/problem.hpp"
#include "worker/element_kernels.hpp"

namespace palpate {

/// Where the body is: the unknowns of every node, the fixed and the displaced ones included.
struct State {
  std::vector<double> u;  ///< nNodes x 3 displacements, metres
  std::vector<double>
      q;  ///< nNodes scaled pressures, p = System::pressureScale() q; empty without a pressure space
};

/// The equations at one state.
struct Residual {
  Eigen::VectorXd free;  ///< nUnknowns; zero at the rows that are held by the tool. Newtons, pressure rows
                         ///< scaled to newtons
  Eigen::Vector3d
      tool;  ///< dL/dp, newtons: what the tool must exert; the tissue's force on the tool is its negative
  double energy = 0;  ///< L, J
  double min_det_F = 1;
  std::int32_t worst_element = -1;  ///< where min_det_F is
  double norm = 0;  ///< Euclidean norm of `free`, newtons; NaN or infinite when the state is not admissible
};

/// The tangent at one state, for one tool.
struct Tangent {
  std::vector<double> values;  ///< of System::pattern(), upper triangle; held rows are those of the identity
  Eigen::Matrix<double, Eigen::Dynamic, 3> tool_coupling;  ///< K_fa, nUnknowns x 3, N/m
  Eigen::Matrix3d tool;                                    ///< K_aa, N/m
};

/// Sparsity of the upper triangle, one entry per position, 1-based as MUMPS wants it.
struct Pattern {
  std::int32_t n = 0;
  std::vector<std::int32_t> row, column;
};

/// The discretised problem: numbers the unknowns, assembles energy, residual and tangent.
///
/// Unknowns are the displacements of the nodes that are not fixed and, with a pressure space, the pressures
/// of all nodes, node by node (Dirichlet values are eliminated). The unknowns held by the tool stay in the
/// system as rows of the identity, so that one sparsity pattern, and with it one analysis, serves every
/// active node of the scene.
///
/// Sums are taken in a fixed order: the same state gives the same bits on every machine that runs the same
/// kernels. Not thread-safe; one per worker process. `problem` must outlive it.
class System {
 public:
  System(const Problem& problem, const ElementKernels& kernels);

  std::int32_t unknowns() const { return pattern_.n; }
  /// Negative eigenvalues of the tangent at a stable equilibrium: one for each pressure unknown. Nothing for
  /// the unstabilised P1 pressure, whose spurious modes have eigenvalues near zero of either sign, so that
  /// the count says nothing.
  std::optional<std::int32_t> expectedNegativePivots() const;
  const Pattern& pattern() const { return pattern_; }
  const Problem& problem() const { return problem_; }
  const ElementKernels& kernels() const { return kernels_; }

  double pressureScale() const { return parameters_.pressure_scale; }  ///< Pa
  /// mu h^2, newtons, h the mean edge length: the size of a nodal force at strain one. Tolerances are
  /// relative to it.
  double forceScale() const { return parameters_.mu * mean_edge_ * mean_edge_; }

  /// Whose active patch is the tool, an index into Problem::active.
  void chooseTool(std::size_t space);
  std::size_t tool() const { return tool_; }

  /// u = 0, p = 0: an equilibrium, because every law here is stress-free at F = I.
  State restState() const;
  /// state + factor * step, step over the unknowns; the tool's patch is put at `displacement` (metres).
  State moved(const State& state, const Eigen::VectorXd& step, double factor,
              const Eigen::Vector3d& displacement) const;

  void assemble(const State& state, Residual& residual) const;
  void assemble(const State& state, Residual& residual, Tangent& tangent) const;

 private:
  void numberUnknowns();
  void buildBatches();
  void buildScatter();
  template <bool with_tangent>
  void run(const State& state, Residual& residual, Tangent* tangent) const;

  const Problem& problem_;
  const ElementKernels& kernels_;
  ElementParameters parameters_;
  double mean_edge_ = 0;  ///< metres
  std::int32_t pressures_ = 0;
  std::size_t tool_ = 0;

  std::vector<std::int32_t> unknown_of_;  ///< nNodes x 4, -1 where there is none
  std::vector<std::uint8_t> held_;        ///< nUnknowns, 1 where the chosen tool holds it
  Pattern pattern_;
  std::vector<std::int32_t> diagonal_;  ///< slot of each unknown's diagonal entry

  std::vector<BatchGeometry> batches_;
  std::vector<std::int32_t> row_slots_;    ///< batch x local_unknowns x lanes, into the residual buffer
  std::vector<std::int32_t> entry_slots_;  ///< batch x local_entries x lanes, into the value buffer
  std::vector<std::vector<std::int32_t>> batches_of_node_;
  mutable std::vector<double> rows_,
      values_;  ///< assembly buffers: unknowns or entries, then the tool's, then a sink

  void fillSlots(std::size_t batch);
  std::int32_t entrySlot(std::int32_t node_a, int i, std::int32_t node_b, int j) const;
  std::int32_t rowSlot(std::int32_t node, int i) const;
  bool isHeld(std::int32_t node) const;
  std::vector<std::int32_t>
      first_entry_;  ///< per unknown, start of its row in pattern_ (rows sorted by column)
};

}  // namespace palpate
