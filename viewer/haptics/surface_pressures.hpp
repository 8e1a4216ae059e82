#pragma once

#include <atomic>
#include <memory>
#include <span>
#include <stop_token>
#include <vector>

#include "viewer/fields/pressure_field.hpp"
#include "viewer/haptics/touch_surface.hpp"

namespace palpate {

/// Whether a dataset has the pressures of its configurations; if not, the first setting of its
/// scene that prevents it.
enum class PressureSource : std::uint8_t {
  stored,
  material,     ///< no material's law is solved with a pressure
  formulation,  ///< [discretization] pressure = "none": the volumetric energy is a penalty
  storage,      ///< solved, but [storage] keeps only the displacements of the surface
};
PressureSource pressureSourceOf(const Scene& scene);

/// Returns the 95th percentile of the magnitudes of pressures, Pa. The rim of a tool has many times
/// this pressure, and a scale up to the maximum would hide all other differences. NaN marks a
/// vertex without a pressure and is skipped; returns 0 if all are NaN.
double strengthOf(std::span<const float> pressures);

/// Pressures of a body's surface for the picture, blended from its spaces as DeformedShape blends
/// displacements. They are the solver's: positive in compression and absolute, so a body under
/// gravity has some at rest.
///
/// The rows are kept when the dataset is read; the fields are made later. Threads: any thread may
/// read. One thread may call prepare() at the same time; its results become visible when all are
/// complete.
class SurfacePressures {
 public:
  /// scene: of the dataset; spaces: their number, or 0 if pressures are not wanted, which are then
  /// never prepared.
  SurfacePressures(const Scene& scene, std::size_t spaces);

  /// Keeps the rows of a space, from Dataset::surfaceFields(). Call for every space before
  /// prepare(); calls for different spaces may run in parallel.
  void keep(std::size_t space, std::vector<float> rows) { rows_[space] = std::move(rows); }
  /// Makes the fields in this thread until `stop` is requested; the next call resumes. Does nothing
  /// if no pressures are stored. spaces: as for keep().
  void prepare(const std::vector<SpaceTable>& spaces, const std::stop_token& stop);

  PressureSource source() const noexcept { return source_; }
  /// Returns the share of spaces that are prepared, 0 to 1. Any thread; does not wait.
  double preparedShare() const noexcept;
  /// Returns whether the functions below may be called. Any thread, real time.
  bool isPrepared() const noexcept {
    return source_ == PressureSource::stored && !fields_.empty() &&
           made_.load(std::memory_order_acquire) == fields_.size();
  }

  /// Returns the median strengthOf() of all configurations, Pa.
  double usual() const noexcept { return usual_; }
  /// Returns whether every vertex has a pressure. Otherwise a vertex that is zero in every
  /// configuration has none: the solver leaves zero where no material around is solved with a
  /// pressure.
  bool everywhere() const noexcept { return everywhere_; }
  /// Fills `out`, [vertex], Pa, with the pressures of a blend of spaces at a displacement (metres);
  /// an empty blend gives those at rest. NaN at vertices without a pressure. Real time.
  void evaluate(const SpaceBlend& blend, const Eigen::Vector3d& displacement,
                std::span<float> out) const noexcept;

 private:
  void takeIn(const SpaceTable& space, std::span<const float> rows);

  PressureSource source_;
  std::vector<std::vector<float>> rows_;  ///< [space], until the field of the space is made
  std::vector<std::unique_ptr<const PressureField>> fields_;
  std::vector<std::uint8_t> known_;  ///< per vertex; 1: it has a pressure
  std::vector<double> strengths_;    ///< per configuration, Pa, while fields are made
  double usual_ = 0;
  bool everywhere_;
  std::atomic<std::size_t> made_ = 0;
};

}  // namespace palpate
