#pragma once

#include <atomic>
#include <memory>
#include <span>
#include <stop_token>
#include <vector>

#include "viewer/fields/pressure_field.hpp"
#include "viewer/haptics/touch_surface.hpp"

namespace palpate {

/// Whether a dataset contains the pressures of its configurations; if not, the first setting of its
/// scene that prevents this.
enum class PressureSource : std::uint8_t {
  stored,
  material,     ///< no material has a law that is solved with a pressure
  formulation,  ///< [discretization] pressure = "none": the volumetric energy is a penalty
  storage,      ///< pressures are solved, but [storage] keeps only the displacements of the surface
};
PressureSource pressureSourceOf(const Scene& scene);

/// Returns the 95th percentile of the absolute pressures, Pa, as the upper end of a colour scale.
/// At the rim of a tool the pressure is many times larger, and a scale up to the maximum would hide
/// all other differences. NaN marks a vertex without a pressure and is skipped; returns 0 if all
/// values are NaN.
double strengthOf(std::span<const float> pressures);

/// Pressures of a body's surface for drawing, blended from its spaces as DeformedShape blends
/// displacements. They are the pressures that the solver computed: absolute, and positive in
/// compression. A body under gravity therefore has pressures at rest.
///
/// keep() stores the values when the dataset is read; prepare() makes interpolating fields of them
/// later. Threads: any thread may read. One thread may call prepare() at the same time; its results
/// become visible when all fields are complete.
class SurfacePressures {
 public:
  /// scene: the scene of the dataset. spaces: number of spaces; 0 if pressures are not wanted, and
  /// nothing is prepared then.
  SurfacePressures(const Scene& scene, std::size_t spaces);

  /// Stores the pressures of a space, from Dataset::surfaceFields(). Call it for every space before
  /// prepare(); calls for different spaces may run in parallel.
  void keep(std::size_t space, std::vector<float> rows) { rows_[space] = std::move(rows); }
  /// Makes the fields in this thread until `stop` is requested; the next call continues. Does
  /// nothing if no pressures are stored. spaces: all spaces, in the same order as for keep().
  void prepare(const std::vector<SpaceTable>& spaces, const std::stop_token& stop);

  PressureSource source() const noexcept { return source_; }
  /// Returns the share of spaces that are prepared, 0 to 1. Any thread; does not wait.
  double preparedShare() const noexcept;
  /// Returns whether the functions below may be called. Any thread, real time.
  bool isPrepared() const noexcept {
    return source_ == PressureSource::stored && !fields_.empty() &&
           made_.load(std::memory_order_acquire) == fields_.size();
  }

  /// Returns the median of strengthOf() over all configurations, Pa.
  double usual() const noexcept { return usual_; }
  /// Returns whether every vertex has a pressure. The solver leaves zero at a vertex if no material
  /// around it is solved with a pressure. A vertex that is zero in every configuration is therefore
  /// assumed to have no pressure.
  bool everywhere() const noexcept { return everywhere_; }
  /// Fills `out`, [vertex], Pa, with the pressures that a blend of spaces gives at a displacement
  /// (metres). An empty blend gives the pressures at rest. Vertices without a pressure get NaN.
  /// Real time.
  void evaluate(const SpaceBlend& blend, const Eigen::Vector3d& displacement,
                std::span<float> out) const noexcept;

 private:
  void takeIn(const SpaceTable& space, std::span<const float> rows);

  PressureSource source_;
  std::vector<std::vector<float>> rows_;  ///< [space]; released when the field of the space is made
  std::vector<std::unique_ptr<const PressureField>> fields_;
  std::vector<std::uint8_t> known_;  ///< per vertex; 1 if the vertex has a pressure
  /// strengthOf() of each configuration, Pa, while the fields are made
  std::vector<double> strengths_;
  double usual_ = 0;
  bool everywhere_;
  std::atomic<std::size_t> made_ = 0;
};

}  // namespace palpate
