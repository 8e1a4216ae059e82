#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "common/interpolation/branch_check.hpp"
#include "common/interpolation/cell_tree.hpp"
#include "common/space/space_table.hpp"
#include "viewer/fields/force_field.hpp"

namespace palpate {

/// What methods that interpolate in leaves are made of: a cell tree and what its slots stand on.
/// Holds no reference to the space. Immutable after construction: any thread may read.
struct CellData {
  /// Error when no point of the space is solved.
  explicit CellData(const SpaceTable& space);

  CellTree tree;
  std::vector<LatticeEdge> inconsistent;  ///< inconsistentEdges of the space
  std::vector<LatticeEdge> suspect;       ///< suspectEdges of the space
  std::vector<Equilibrium> equilibria;    ///< slotEquilibria
  std::vector<double> support;            ///< slotCoverage
  /// Per slot: lattice number, of hanging ones too; -1 when it has none.
  std::vector<std::int32_t> numbers;
  std::int32_t divisions;  ///< lattice coordinates per spacing

  /// The slot at lattice coordinates; -1 when there is none.
  std::int32_t slotAt(const LatticePoint& point) const;
  /// Whether two slots are the ends of an inconsistent edge.
  bool isInconsistent(std::int32_t a, std::int32_t b) const;
  /// The leaves with an edge among these; sorted edges.
  std::vector<std::int32_t> leavesWith(const std::vector<LatticeEdge>& edges) const;
};

/// What all methods that interpolate in the leaves of a cell tree have in common: where a
/// displacement lies, what happens outside of the ball, coverage, and the limiter.
///
/// Limiter: smooth interpolants overshoot where two corners of a leaf lie on different branches.
/// All corners of a leaf with such an edge (branch_check.hpp) have the flag 1, the others 0; w is
/// the tri-linear interpolant of the flags. Where w > 0 the error bound grows by w times the
/// largest difference between forces at the leaf's corners. Methods without an energy of their own
/// are blended: the force is (1 - w) smooth + w tri-linear, so exactly the tri-linear one in such a
/// leaf, the smooth one in leaves that do not touch it, and continuous; there is no energy. The
/// corners of leaves with an inconsistent edge count as not covered.
class CellField : public ForceField {
 public:
  ForceSample evaluate(const Eigen::Vector3d& displacement) const noexcept final;

 protected:
  /// Which edges flag a leaf, and what that changes.
  enum class Limit {
    bound,  ///< inconsistent ones, and the error bound alone: the method itself is limited
    force,  ///< suspect ones: the force is blended too
  };

  /// Copies what it needs.
  explicit CellField(const CellData& data, Limit limit = Limit::force);

  /// Replaces what `sample` comes with, the tri-linear force and stiffness, by those of the method
  /// at a place in a leaf (0..1 along each axis), with energy and error bound if it has them. Real
  /// time.
  virtual void interpolate(std::int32_t leaf, const Eigen::Vector3d& local,
                           ForceSample& sample) const noexcept = 0;

  const CellTree& tree() const { return tree_; }

 private:
  void setFlags(const std::vector<std::int32_t>& leaves);
  void setSpread();
  ForceSample sampleAt(const LeafPlace& place) const noexcept;
  void limit(const LeafPlace& place, const ForceSample& linear, ForceSample& sample) const noexcept;

  CellTree tree_;
  Limit limit_;
  std::vector<Eigen::Vector4d> nodes_;  ///< per slot: force, N, and support
  std::vector<double> flags_;           ///< per slot
  /// Per leaf: largest difference of corner forces, N; -1: no corner flagged.
  std::vector<double> spread_;
};

}  // namespace palpate
