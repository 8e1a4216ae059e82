#pragma once

#include <cstdint>

#include "viewer/plot/svg_plot.hpp"
#include "viewer/report/force_way.hpp"

namespace palpate {

/// Which exact solutions are marked.
enum class ExactMarks : std::uint8_t { solved, held_out, both };

/// The series of a plot of forces against way, without points: marks of exact solutions, and
/// curves in the looks of `interpolations`.
std::vector<PlotSeries> curveSeries(std::vector<PlotSeries> interpolations, ExactMarks marks);

/// Appends them, in mm and N.
void addForces(const AxisForces& along, PlotSeries& series);

/// Force in N against way in mm, with those exact solutions that there are. `interpolations` as
/// ForceWay::sampled; `along`: "along x".
Plot forcePlot(const ForceWay& way, const std::vector<PlotSeries>& interpolations,
               const std::string& title, const std::string& along);

/// "direction (0.2, -0.5, 0.84)"
std::string describeDirection(const Eigen::Vector3d& direction);

}  // namespace palpate
