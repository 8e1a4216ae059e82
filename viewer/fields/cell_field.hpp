#pragma once

#include "viewer/fields/answered_region.hpp"

namespace palpate {

/// What all methods that interpolate in the leaves of a cell tree have in common: where a
/// displacement lies, what happens beyond the region that was computed, coverage, and the limiter.
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
  std::string_view name() const final { return name_; }

 protected:
  /// Which edges flag a leaf, and what that changes.
  enum class Limit {
    bound,  ///< inconsistent ones, and the error bound alone: the method itself is limited
    force,  ///< suspect ones: the force is blended too
  };

  /// name: a literal. Copies what it needs of the data.
  CellField(std::string_view name, const CellData& data, Limit limit = Limit::force);

  /// Replaces what `sample` comes with, the tri-linear force and stiffness, by those of the method
  /// at a place in a leaf (0..1 along each axis), with energy and error bound if it has them. Real
  /// time.
  virtual void interpolate(std::int32_t leaf, const Eigen::Vector3d& local,
                           ForceSample& sample) const noexcept = 0;

  const CellTree& tree() const { return tree_; }

 private:
  void setFlags(const std::vector<std::int32_t>& leaves);
  void setSpread();
  ForceSample inRegion(const Eigen::Vector3d& displacement) const noexcept;
  ForceSample sampleAt(const LeafPlace& place) const noexcept;
  void limit(const LeafPlace& place, const ForceSample& linear, ForceSample& sample) const noexcept;

  std::string_view name_;
  CellTree tree_;
  AnsweredRegion region_;
  Limit limit_;
  std::vector<Eigen::Vector4d> nodes_;  ///< per slot: force, N, and support
  std::vector<double> flags_;           ///< per slot
  /// Per leaf: largest difference of corner forces, N; -1: no corner flagged.
  std::vector<double> spread_;
};

}  // namespace palpate
