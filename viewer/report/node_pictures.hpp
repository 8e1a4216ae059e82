#pragma once

#include <array>
#include <vector>

#include "viewer/plot/svg_plot.hpp"
#include "viewer/report/report.hpp"
#include "viewer/report/slice_map.hpp"

namespace palpate {

/// What the page shows of one active node.
struct NodePictures {
  std::array<SliceMap, 3> slices;  ///< xy, xz, yz; empty when the default method cannot be made
  std::array<Plot, 3> curves;  ///< force along x, y, z: a line per method, marks for the lattice
};

/// Samples the fields of active node `space` on `lattice` of the report.
NodePictures takePictures(const Report& report, const LatticeMeasures& lattice, std::size_t space);

}  // namespace palpate
