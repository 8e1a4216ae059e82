#pragma once

#include "viewer/fields/answered_region.hpp"

namespace palpate {

/// Base of all methods that interpolate in the leaves of a cell tree. It finds the leaf of a
/// displacement, continues the force beyond the solved region, and provides coverage and the
/// limiter.
///
/// Limiter. Smooth interpolants overshoot in a leaf with corners on different branches. All corners
/// of a leaf with an edge between branches (branch_check.hpp) have the flag 1, the others 0, and w
/// is the tri-linear interpolant of the flags. Where w > 0, the error bound grows by w times the
/// largest difference between forces at the leaf's corners. The force of methods without an energy
/// of their own is blended to (1 - w) smooth + w tri-linear, and has no energy. So it is tri-linear
/// in such a leaf, smooth in leaves that do not touch one, and continuous. Corners of leaves with
/// an inconsistent edge count as not covered.
class CellField : public ForceField {
 public:
  ForceSample evaluate(const Eigen::Vector3d& displacement) const noexcept final;
  std::string_view name() const final { return name_; }

 protected:
  /// Edges that flag a leaf, and the effect of the flags.
  enum class Limit {
    /// inconsistent edges; changes only the error bound, since the method itself is limited
    bound,
    force,  ///< suspect edges; blends the force too
  };

  /// name: a literal. Copies the data that it needs.
  CellField(std::string_view name, const CellData& data, Limit limit = Limit::force);

  /// Evaluates the method at a place in a leaf (0..1 along each axis). `sample` comes with the
  /// tri-linear force and stiffness, which are replaced; energy and error bound are set if the
  /// method has them. Real time.
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
  /// Largest difference of corner forces per leaf, N; -1 if no corner is flagged.
  std::vector<double> spread_;
};

}  // namespace palpate
