#pragma once

#include <atomic>
#include <memory>
#include <span>
#include <stop_token>
#include <vector>

#include "viewer/fields/pressure_field.hpp"
#include "viewer/haptics/touch_surface.hpp"

namespace palpate {

/// Whether a dataset has the pressures of its configurations; if not, what of its scene stands in
/// the way first.
enum class PressureSource : std::uint8_t {
  stored,
  material,     ///< no material is of a law that is solved with a pressure
  formulation,  ///< [discretization] pressure = "none": the volumetric energy is a penalty
  storage,      ///< they were solved, but [storage] keeps the displacements of the surface alone
};
PressureSource pressureSourceOf(const Scene& scene);

/// How strong pressures are, Pa: of 20 vertices 19 have no larger one of either sign. Under the rim
/// of a tool stands many times as much, beside which all else would look the same. NaN: a vertex
/// without one, which does not count; 0 when all are.
double strengthOf(std::span<const float> pressures);

/// The pressures of a body's surface, blended from its spaces as DeformedShape blends
/// displacements, for the picture: what the solver stores, positive in compression, and absolute,
/// so that under gravity a body has some at rest.
///
/// Rows are kept when the dataset is read; the fields over them are made when there is time.
/// Threads: any may read; prepare() in one thread beside them, what it makes becomes visible when
/// all of it is whole.
class SurfacePressures {
 public:
  /// Of a dataset of this scene with so many spaces; 0: nobody asks for them, and they are never
  /// prepared.
  SurfacePressures(const Scene& scene, std::size_t spaces);

  /// The rows of a space, Dataset::surfaceFields(). Of every space, before prepare(); several at
  /// once.
  void keep(std::size_t space, std::vector<float> rows) { rows_[space] = std::move(rows); }
  /// Makes the fields in this thread, until it is done or `stop` is requested; the next call goes
  /// on from there. Does nothing where nothing is stored. spaces: those of the rows.
  void prepare(const std::vector<SpaceTable>& spaces, const std::stop_token& stop);

  PressureSource source() const noexcept { return source_; }
  /// Of how many spaces prepare() is done, 0 to 1. Any thread; waits for nothing.
  double preparedShare() const noexcept;
  /// Whether what is below may be asked. Any thread, real time.
  bool isPrepared() const noexcept {
    return source_ == PressureSource::stored && !fields_.empty() &&
           made_.load(std::memory_order_acquire) == fields_.size();
  }

  /// strengthOf() the middle one of all configurations, Pa: half of them are weaker.
  double usual() const noexcept { return usual_; }
  /// Whether every vertex has a pressure: else one has none where it is zero in every
  /// configuration, as the solver leaves it where no material around is solved with one.
  bool everywhere() const noexcept { return everywhere_; }
  /// Fills `out`, [vertex], Pa, with the pressures of a blend of spaces at a displacement (metres);
  /// of no space: those at rest. NaN at vertices without one. Real time.
  void evaluate(const SpaceBlend& blend, const Eigen::Vector3d& displacement,
                std::span<float> out) const noexcept;

 private:
  void takeIn(const SpaceTable& space, std::span<const float> rows);

  PressureSource source_;
  std::vector<std::vector<float>> rows_;  ///< [space], until its field is made
  std::vector<std::unique_ptr<const PressureField>> fields_;
  std::vector<std::uint8_t> known_;  ///< per vertex, 1: it has a pressure
  std::vector<double> strengths_;    ///< Pa, per configuration, while fields are made
  double usual_ = 0;
  bool everywhere_;
  std::atomic<std::size_t> made_ = 0;
};

}  // namespace palpate
