#include "viewer/report/node_pictures.hpp"

#include <cmath>
#include <memory>

#include "common/base/error.hpp"
#include "viewer/fields/field_choice.hpp"

namespace palpate {
namespace {

constexpr int curve_samples = 121;
constexpr const char* mark_colour = "#1b1f24";

std::unique_ptr<ForceField> fieldOrNone(const std::string& method, const SpaceTable& space) {
  try {
    return makeForceField(method, space);
  } catch (const Error&) {
    return nullptr;
  }
}

PlotSeries exactAlong(const SpaceTable& space, int axis) {
  PlotSeries series;
  series.label = "exact, lattice points";
  series.line = false;
  series.style.colour = mark_colour;
  for (std::int32_t n = 0; n < space.lattice.size(); ++n) {
    const Eigen::Vector3d p = space.lattice.displacement(n);
    const bool is_on_axis = p.cwiseAbs().sum() == std::abs(p[axis]);
    if (!is_on_axis || p.norm() > space.lattice.radius() * (1 + 1e-9) ||
        !isSolved(space.points[n].tag))
      continue;
    series.x.push_back(1e3 * p[axis]);
    series.y.push_back(space.points[n].equilibrium.force[axis]);
  }
  return series;
}

PlotSeries curveAlong(const ForceField& field, double radius, int axis, std::size_t method) {
  PlotSeries series;
  series.label = field.name();
  series.marks = false;
  series.style = seriesStyle(method);
  for (int n = 0; n < curve_samples; ++n) {
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
    p[axis] = radius * (2.0 * n / (curve_samples - 1) - 1);
    series.x.push_back(1e3 * p[axis]);
    series.y.push_back(field.evaluate(p).force[axis]);
  }
  return series;
}

}  // namespace

NodePictures takePictures(const Report& report, const LatticeMeasures& lattice,
                          std::size_t space_number) {
  std::optional<SpaceTable> storage;
  const SpaceTable& space = tableOf(report, lattice, space_number, storage);
  static constexpr std::array<std::array<int, 2>, 3> planes = {{{0, 1}, {0, 2}, {1, 2}}};
  static constexpr std::array<const char*, 3> names = {"x", "y", "z"};
  NodePictures pictures;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Plot& plot = pictures.curves[axis];
    plot.title = std::string("Along ") + names[axis];
    plot.x.label = std::string("displacement along ") + names[axis] + ", mm";
    plot.y.label = std::string("force along ") + names[axis] + ", N";
    plot.width = 380;
    plot.height = 300;
    plot.series.push_back(exactAlong(space, static_cast<int>(axis)));
  }
  for (std::size_t m = 0; m < report.methods.size(); ++m) {
    const auto field = fieldOrNone(report.methods[m], space);
    if (!field) continue;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::vector<PlotSeries>& series = pictures.curves[axis].series;
      // The default, the widest line, below the others.
      series.insert(m == 0 ? series.end() : series.begin() + 1,
                    curveAlong(*field, space.lattice.radius(), static_cast<int>(axis), m));
    }
    if (m > 0) continue;
    std::vector<MeasuredReference> references;
    if (report.measured)
      for (const Reference& reference : report.positions[space_number])
        references.push_back(
            {reference.displacement,
             (field->evaluate(reference.displacement).force - reference.force).norm()});
    for (std::size_t s = 0; s < planes.size(); ++s)
      pictures.slices[s] = sampleSlice(*field, space, planes[s][0], planes[s][1], references,
                                       0.05 * space.lattice.radius());
  }
  return pictures;
}

}  // namespace palpate
