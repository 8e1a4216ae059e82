#pragma once

#include "viewer/fields/answered_region.hpp"

namespace palpate {

/// Base of all methods that interpolate in the leaves of a cell tree. It finds the leaf that
/// contains a displacement, continues the force beyond the answered region, and computes the
/// coverage. It also contains a limiter.
///
/// Limiter. Smooth interpolants overshoot in a leaf whose corners lie on different solution
/// branches. Every leaf with an edge between branches (branch_check.hpp) sets the flag of its
/// corners to 1; all other corners have the flag 0. Let w be the tri-linear interpolant of the
/// flags. If w > 0, the error bound grows by w times the largest difference between forces at the
/// leaf's corners. Methods without an energy of their own then return no energy, and the mean of
/// the smooth and the tri-linear force with the weights 1 - w and w. This force is tri-linear in a
/// flagged leaf, smooth in leaves that do not touch a flagged leaf, and continuous. Corners of
/// leaves with an inconsistent edge have coverage 0.
class CellField : public ForceField {
 public:
  ForceSample evaluate(const Eigen::Vector3d& displacement) const noexcept final;
  std::string_view name() const final { return name_; }

 protected:
  /// Which edges set the flags, and which quantities the limiter changes.
  enum class Limit {
    /// inconsistent edges; changes only the error bound, because the method limits its force itself
    bound,
    force,  ///< suspect edges; changes force and error bound
  };

  /// name: a string literal. Copies the data that it needs.
  CellField(std::string_view name, const CellData& data, Limit limit = Limit::force);

  /// Evaluates the method at a place in a leaf (0..1 along each axis). On entry, `sample` holds the
  /// tri-linear force and stiffness. Replaces them unless the method is tri-linear, and sets energy
  /// and error bound if the method has them. Real time.
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
  std::vector<Eigen::Vector4d> nodes_;  ///< per slot: force, N, and coverage
  std::vector<double> flags_;           ///< per slot
  /// Largest difference of corner forces per leaf, N; -1 if no corner is flagged.
  std::vector<double> spread_;
};

}  // namespace palpate
