#pragma once

#include "worker/check/build_cost.hpp"

namespace palpate {

/// The contents of the report of `palpate check`. The functions below only format them.
struct SceneReport {
  /// One configuration space as the scene defines it, before anything is solved.
  struct Space {
    const ActivePatch* patch;
    std::string_view tool;  ///< as in the scene: "rigid", "weighted-average" or "finger"
    Eigen::Vector3d place;  ///< m, position of the active node or of the finger
    std::size_t unknowns;   ///< displacement components and pressures to solve for
  };

  const Problem* problem;
  MeshQuality quality;
  Lattice lattice;
  std::vector<Space> spaces;
  std::vector<std::int64_t> tetrahedra_in;  ///< per region
  std::vector<double> volume_of;            ///< per region, m^3
  MeasuredPaths measured;
  BuildCost cost;
  unsigned cores = 1;      ///< of this machine; a build starts one worker per core
  std::string arithmetic;  ///< the kernels used, for instance "avx2/Haswell"
  std::vector<std::string> warnings;
};

/// Examines a problem, which must outlive the report, and solves a few transitions (measurePaths).
SceneReport reportOf(const Problem& problem);

/// Returns the report as text for the user. Each line begins with a topic in 11 columns. Numbers
/// are in SI units.
std::string sceneReportText(const SceneReport& report);
/// Returns the report as one JSON object on one line, with lengths in metres.
std::string sceneReportJson(const SceneReport& report);

}  // namespace palpate
