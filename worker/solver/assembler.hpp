#pragma once

#include <Eigen/Core>
#include <algorithm>

#include "worker/solver/element_batches.hpp"
#include "worker/solver/linear_solver.hpp"

namespace palpate {

/// Returns the pattern of the body's matrix: one entry for every pair of unknowns that share an
/// element.
SparsityPattern patternOf(const DofMap& unknowns, const ElementBatches& batches);

/// Adds element equations to the equations of the body.
///
/// Rows of a displacement that a rigid tool holds go to the tool's three equations; its coupling to
/// free unknowns is kept beside the matrix. Rows of fixed displacements and held pressures are
/// dropped.
///
/// Holds the sums of one assembly: clear, add, read. Slots are looked up once, when the tool
/// changes. One thread.
class Assembler {
 public:
  /// Keeps references to all three. No unknown is held at first.
  Assembler(const DofMap& unknowns, const SparsityPattern& pattern, const ElementBatches& batches);

  /// Gives the displacements of these nodes, none of them fixed, to the tool, or releases them. The
  /// pressures of the slots `idle` keep their values while they are held.
  void hold(const std::vector<std::int32_t>& nodes, const std::vector<std::int32_t>& idle,
            bool by_tool);
  bool isHeld(std::int32_t unknown) const { return held_[unknown] != 0; }

  void clearRows() { std::fill(rows_.begin(), rows_.end(), 0.0); }
  void clearEntries() { std::fill(entries_.begin(), entries_.end(), 0.0); }
  void add(const Dof& place, double force) { rows_[rowSlot(place)] += force; }
  void add(std::int32_t batch, const BatchResult& result);
  void add(std::int32_t batch, const BatchTangent& tangent);

  // The sums. Residual per unknown (zero where the tool holds it) and of the tool; tangent per
  // entry of the pattern, d(residual)/dp, and the tool's own block.
  Eigen::Map<const Eigen::VectorXd> rows() const { return {rows_.data(), unknowns_.count()}; }
  Eigen::Vector3d toolRows() const { return Eigen::Vector3d::Map(&rows_[unknowns_.count()]); }
  double entry(std::int32_t number) const { return entries_[number]; }
  std::vector<double> entries() const;
  Eigen::MatrixX3d toolCoupling() const;
  Eigen::Matrix3d toolEntries() const;

 private:
  std::int32_t rowSlot(const Dof& place) const;
  std::int32_t entrySlot(const Dof& a, const Dof& b) const;
  void findSlots(std::int32_t batch);

  const DofMap& unknowns_;
  const SparsityPattern& pattern_;
  const ElementBatches& batches_;
  std::vector<std::uint8_t> held_;  ///< per unknown, 1 where the rigid tool holds it
  std::vector<double> rows_;        ///< unknowns, tool, sink
  std::vector<double> entries_;     ///< pattern, coupling, tool, sink
  /// Destination of each local row and entry in `rows_` and `entries_`, `*_stride_` per batch, lane
  /// by lane. One contiguous array each, read from end to end: with one array per batch the
  /// residual takes 1.4 times as long.
  std::vector<std::int32_t> row_slots_, entry_slots_;
  std::size_t row_stride_, entry_stride_;
};

}  // namespace palpate
