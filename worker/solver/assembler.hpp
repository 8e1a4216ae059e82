#pragma once

#include <Eigen/Core>
#include <algorithm>

#include "worker/solver/element_batches.hpp"
#include "worker/solver/linear_solver.hpp"

namespace palpate {

/// Every entry that an unknown of an element, or two of them, have in the matrix of the body.
SparsityPattern patternOf(const DofMap& unknowns, const ElementBatches& batches);

/// Adds the equations of elements up to those of the body. What falls on a displacement that a
/// rigid tool holds goes to the tool's three equations, and its coupling to the others beside the
/// matrix; what falls on a fixed one, or on a pressure that is held, goes nowhere.
///
/// The sums of one assembly live here: clear, add, read. Slots are looked up once, when the tool
/// changes. One thread.
class Assembler {
 public:
  /// Keeps references to all three. Nothing is held.
  Assembler(const DofMap& unknowns, const SparsityPattern& pattern, const ElementBatches& batches);

  /// The displacements of these nodes, none of them fixed, are the tool's from now on, or not any
  /// more; the pressures of the slots `idle` stay as they are meanwhile.
  void hold(const std::vector<std::int32_t>& nodes, const std::vector<std::int32_t>& idle,
            bool by_tool);
  bool isHeld(std::int32_t unknown) const { return held_[unknown] != 0; }

  void clearRows() { std::fill(rows_.begin(), rows_.end(), 0.0); }
  void clearEntries() { std::fill(entries_.begin(), entries_.end(), 0.0); }
  void add(const Dof& place, double force) { rows_[rowSlot(place)] += force; }
  void add(std::int32_t batch, const BatchResult& result);
  void add(std::int32_t batch, const BatchTangent& tangent);

  // The sums: the residual by unknown, zero where the tool holds one, and of the tool; the tangent
  // by entry of the pattern, d(residual)/dp and of the tool alone.
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
  /// Where the local rows and entries go in them, `*_stride_` a batch, lane by lane. Each in one
  /// piece, which is read from end to end: in pieces the residual takes 1.4 times as long.
  std::vector<std::int32_t> row_slots_, entry_slots_;
  std::size_t row_stride_, entry_stride_;
};

}  // namespace palpate
