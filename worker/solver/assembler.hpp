#pragma once

#include <Eigen/Core>
#include <algorithm>

#include "worker/solver/element_batches.hpp"
#include "worker/solver/linear_solver.hpp"

namespace palpate {

/// Returns the pattern of the body's matrix: one entry for every pair of unknowns that share an
/// element.
SparsityPattern patternOf(const DofMap& unknowns, const ElementBatches& batches);

/// Sums the equations of the elements into the equations of the body.
///
/// The row of a displacement that a rigid tool prescribes is added to the three equations of the
/// tool. The coupling between the tool and the free unknowns is stored apart from the matrix. Rows
/// of fixed displacements and of undetermined pressures (idlePressures) are dropped.
///
/// Holds the sums of one assembly, so clear them, add all elements, and then read them. The
/// positions at which an element adds its rows and entries are computed in advance, and again when
/// the tool changes. One thread.
class Assembler {
 public:
  /// Keeps references to all arguments. At first the tool holds no unknown.
  Assembler(const DofMap& unknowns, const SparsityPattern& pattern, const ElementBatches& batches);

  /// Marks unknowns as held by a rigid tool, or as free if `by_tool` is false. They are the
  /// displacements of `nodes`, none of which is fixed, and the pressures in the slots `idle`. The
  /// tool prescribes the displacements; the pressures keep their values.
  void hold(const std::vector<std::int32_t>& nodes, const std::vector<std::int32_t>& idle,
            bool by_tool);
  bool isHeld(std::int32_t unknown) const { return held_[unknown] != 0; }

  void clearRows() { std::fill(rows_.begin(), rows_.end(), 0.0); }
  void clearEntries() { std::fill(entries_.begin(), entries_.end(), 0.0); }
  void add(const Dof& place, double force) { rows_[rowSlot(place)] += force; }
  void add(std::int32_t batch, const BatchResult& result);
  void add(std::int32_t batch, const BatchTangent& tangent);

  // The sums:
  // - rows: the residual per unknown, zero for unknowns that the tool holds;
  // - toolRows: the residual of the tool;
  // - entry, entries: the values of the tangent, one per entry of the pattern;
  // - toolCoupling: d(residual)/dp, one row per unknown;
  // - toolEntries: the tangent of the tool alone.
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
  std::vector<std::uint8_t> held_;  ///< per unknown, 1 if the rigid tool holds it
  std::vector<double> rows_;        ///< sums for unknowns, tool, dropped rows
  std::vector<double> entries_;     ///< sums for pattern, coupling, tool, dropped entries
  /// Index in `rows_` or `entries_` to which each local row or entry of a lane is added, with
  /// `*_stride_` indices per batch. Both arrays are contiguous, and an assembly reads them in
  /// order. With one array per batch the residual takes 1.4 times as long.
  std::vector<std::int32_t> row_slots_, entry_slots_;
  std::size_t row_stride_, entry_stride_;
};

}  // namespace palpate
