#pragma once

#include "worker/check/build_cost.hpp"

namespace palpate {

/// Everything that `palpate check` says of a problem: its writers only format.
struct SceneReport {
  /// One configuration space, as far as it is known without solving.
  struct Space {
    const ActivePatch* patch;
    std::string_view tool;  ///< of the scene: "rigid", "weighted-average" or "finger"
    Eigen::Vector3d place;  ///< m: of the active node, or of the finger
    std::size_t unknowns;   ///< displacement components and pressures to solve for
  };

  const Problem* problem;
  MeshQuality quality;
  std::int64_t nearly_flat = 0;  ///< tetrahedra
  Lattice lattice;
  std::vector<Space> spaces;
  std::vector<std::int64_t> tetrahedra_in;  ///< per region
  std::vector<double> volume_of;            ///< per region, m^3
  MeasuredWays measured;
  BuildCost cost;
  unsigned cores = 1;      ///< of this machine, which is how many workers a build starts
  std::string arithmetic;  ///< kernels that solve, "avx2/Haswell"
  std::vector<std::string> warnings;
};

/// Looks at a problem, which must outlive the report, and solves a little of it (measureWays).
SceneReport reportOf(const Problem& problem);

/// A report for people: lines with a word for the topic in 11 columns, then numbers in SI units.
std::string sceneReportText(const SceneReport& report);
/// A report as one JSON object on one line, lengths in metres.
std::string sceneReportJson(const SceneReport& report);

}  // namespace palpate
