#include "viewer/report/report_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "common/base/assertion.hpp"
#include "common/base/index.hpp"
#include "common/base/markup.hpp"
#include "common/base/program.hpp"
#include "common/mesh/surface_point.hpp"
#include "viewer/plot/widest_view.hpp"
#include "viewer/report/comparison.hpp"
#include "viewer/report/report_json.hpp"
#include "viewer/report/report_words.hpp"
#include "viewer/report/run_accuracy.hpp"

namespace palpate {

/// The texts of page/report.html and page/report.js, which CMake embeds.
extern const char* const report_markup;
extern const char* const report_script;

namespace {

using DrawingJson = nlohmann::ordered_json;

/// Largest number of discs on the organ. More discs would hide the colours of its triangles.
constexpr std::size_t most_discs = 150;

double rounded(double value, int figures) {
  return std::isfinite(value) ? std::strtod(fmt::format("{:.{}g}", value, figures).c_str(), nullptr)
                              : value;
}

template <class Values>
std::vector<double> numbers(const Values& values, int figures) {
  return mapped(values, [&](double value) { return rounded(value, figures); });
}

DrawingJson forcesOf(const AxisForces& along) {
  return DrawingJson::array({numbers(along.displacements, 6), numbers(along.forces, 6)});
}

DrawingJson drawnWay(const ForceWay& way) {
  return {{"name", way.name},
          {"direction", numbers(way.direction, 4)},
          {"solved", forcesOf(way.solved)},
          {"held_out", forcesOf(way.held_out)},
          {"sampled", mapped(way.sampled, forcesOf)}};
}

/// The surface of a body. Its nodes are renumbered without the interior nodes.
class Surface {
 public:
  explicit Surface(const Dataset& dataset)
      : dataset_(dataset), numbers_(dataset.mesh().nodes.size(), -1) {
    std::int32_t count = 0;
    for (const std::int32_t node : dataset.surfaceNodes()) numbers_[at(node)] = count++;
  }

  DrawingJson body() const {
    const Mesh& mesh = dataset_.mesh();
    DrawingJson nodes = DrawingJson::array(), triangles = DrawingJson::array(),
                fixed = DrawingJson::array();
    for (const std::int32_t node : dataset_.surfaceNodes())
      for (const double coordinate : mesh.nodes[at(node)]) nodes.push_back(rounded(coordinate, 7));
    for (const Triangle& triangle : mesh.surface)
      for (const std::int32_t corner : triangle) triangles.push_back(numbers_[at(corner)]);
    for (const std::int32_t node : dataset_.fixedNodes())
      if (numbers_[at(node)] >= 0) fixed.push_back(numbers_[at(node)]);
    return {{"front", numbers(widestView(mesh.nodes), 6)},
            {"nodes", nodes},
            {"triangles", triangles},
            {"fixed", fixed}};
  }

  /// Returns the number of a mesh node on the surface; -1 if the node is inside the body.
  std::int32_t number(std::int32_t node) const { return numbers_[at(node)]; }

  /// Returns a mark: a place on the surface, and the triangles that contain it (several if it is on
  /// an edge or a corner). A view shows the mark if it shows one of these triangles.
  DrawingJson mark(const Eigen::Vector3d& place) const {
    const Mesh& mesh = dataset_.mesh();
    const SurfacePoint on_surface = nearestOnSurface(mesh, place);
    const Triangle& nearest = mesh.surface[at(on_surface.triangle)];
    DrawingJson triangles = DrawingJson::array();
    for (std::size_t t = 0; t < mesh.surface.size(); ++t) {
      const auto lacks = [&](int corner) {
        return on_surface.barycentric[corner] > 0 &&
               std::ranges::find(mesh.surface[t], nearest[at(corner)]) == mesh.surface[t].end();
      };
      if (!lacks(0) && !lacks(1) && !lacks(2)) triangles.push_back(t);
    }
    return {{"place", numbers(place, 7)}, {"triangles", triangles}};
  }

 private:
  const Dataset& dataset_;
  std::vector<std::int32_t> numbers_;
};

/// Returns the provenance of each dataset: a list of facts (name and text), and the whole scene.
DrawingJson provenanceOf(const std::vector<Dataset>& datasets,
                         const std::vector<DatasetFacts>& facts) {
  PALPATE_ASSERT(facts.size() == datasets.size(), "each dataset must be described");
  DrawingJson all = DrawingJson::array();
  for (std::size_t d = 0; d < datasets.size(); ++d) {
    const Dataset& dataset = datasets[d];
    const ProbeCounts& probes = facts[d].probes;
    DrawingJson rows = DrawingJson::array();
    const auto add = [&](const char* term, const std::string& text) {
      rows.push_back(DrawingJson::array({term, text}));
    };
    add("dataset", dataset.file().filename().string());
    add("content hash", dataset.contentId().hex());
    add("build", dataset.buildId().hex());
    add("kernel family", dataset.kernelFamily());
    add("workspace", fmt::format("{}, force limit {:.3g} N", describeBall(dataset),
                                 dataset.scene().workspace.max_force));
    add("mesh", describeMesh(dataset.mesh()));
    add("probes", fmt::format("{}, {} within max_force, {} beyond it, {} not solved", probes.all,
                              probes.within_force, probes.beyond_force, probes.unsolved()));
    all.push_back({{"facts", rows}, {"scene", dataset.sceneToml()}});
  }
  return all;
}

DrawingJson drawn(const AreaMeasures& area, const Report& report, const Surface& surface) {
  PALPATE_ASSERT(area.on_triangles.size() == report.open.front().mesh().surface.size(),
                 "each surface triangle must have a value");
  DrawingJson probes = DrawingJson::array();
  for (const AreaProbes::Comparison& probe : area.probes.comparisons)
    probes.push_back({{"at", surface.mark(probe.place)},
                      {"displacement", rounded(probe.displacement.norm(), 6)},
                      {"force", rounded(probe.force.norm(), 6)},
                      {"error", rounded(probe.error, 6)},
                      {"newtons", rounded(probe.newtons, 6)},
                      {"newtons_of_nearest", rounded(probe.newtons_of_nearest, 6)}});
  return {{"words", describeProbes(area, report)},
          {"median", numbers(area.on_triangles, 4)},
          {"largest", numbers(area.worst_on_triangles, 4)},
          {"probes", probes},
          {"ways", mapped(area.ways, drawnWay)}};
}

DrawingJson drawnSlice(const SliceMap& slice) {
  PALPATE_ASSERT(slice.bound.size() == slice.covered.size(),
                 "each place must have a bound and a coverage");
  const auto flat = [](const Eigen::Vector2d& p) {
    return DrawingJson::array({rounded(p.x(), 6), rounded(p.y(), 6)});
  };
  // One character per sample: "1" if the corners around it are solved, otherwise "0".
  std::string covered;
  for (const char one : slice.covered) covered += one != 0 ? '1' : '0';
  DrawingJson marks = DrawingJson::array(), jumps = DrawingJson::array(),
              errors = DrawingJson::array();
  for (const SliceMap::LatticeMark& mark : slice.marks)
    marks.push_back({{"at", flat(mark.at)}, {"tag", name(mark.tag)}});
  for (const auto& [a, b] : slice.jumps) jumps.push_back(DrawingJson::array({flat(a), flat(b)}));
  for (const SliceMap::ErrorMark& mark : slice.errors)
    errors.push_back({{"at", flat(mark.at)}, {"error", rounded(mark.error, 6)}});
  return {{"across", slice.across},
          {"up", slice.up},
          {"radius", slice.radius},
          {"side", SliceMap::side},
          {"bound", numbers(slice.bound, 3)},
          {"covered", covered},
          {"marks", marks},
          {"jumps", jumps},
          {"errors", errors}};
}

DrawingJson drawnPictures(const NodePictures& pictures) {
  return {{"node", pictures.node},
          {"slices", mapped(pictures.slices, drawnSlice)},
          {"axes", mapped(pictures.axes, drawnWay)},
          {"ways", mapped(pictures.ways, drawnWay)}};
}

/// Returns the places of the active nodes, and the error bounds of their spaces.
DrawingJson drawnNodes(const Report& report, const Surface& surface) {
  const Dataset& dataset = report.open.front();
  DrawingJson nodes = DrawingJson::array();
  for (std::size_t n = 0; n < report.nodes.size(); ++n) {
    const NodeMeasures& node = report.nodes[n];
    const std::int32_t number = dataset.spaces()[n].patch.node;
    nodes.push_back(
        {{"node", surface.number(number)},
         {"at", report.nodes.size() <= most_discs ? surface.mark(dataset.mesh().nodes[at(number)])
                                                  : DrawingJson(nullptr)},
         {"mean_bound", node.bound.mean},
         {"largest_bound", node.bound.maximum},
         {"compared", node.compared ? DrawingJson(*node.compared) : DrawingJson(nullptr)}});
  }
  return nodes;
}

// Arrays for the drawings of the pages (page/report.js), and the sentences that the pages share
// with the text. Numbers are in SI units and rounded to a few digits; a missing number is null.

DrawingJson drawingsOf(const Report& report) {
  const Dataset& first = report.open.front();
  const Surface surface(first);
  const auto drawnArea = [&](const AreaMeasures& area) { return drawn(area, report, surface); };
  DrawingJson lattices = DrawingJson::array();
  for (const LatticeMeasures& lattice : report.lattices)
    lattices.push_back({{"node_configurations", lattice.node_configurations},
                        {"node_errors", lattice.node_errors}});
  return {{"version", version()},
          {"mesh", first.scene().mesh.filename().string()},
          {"max_force", first.scene().workspace.max_force},
          {"areas_alone", report.areas_alone},
          {"words",
           {{"held_out", describeHeldOut(report)},
            {"hint", hintForProbes(report)},
            {"target", describeTarget(report)},
            {"gaps", describeGaps(report)}}},
          {"body", surface.body()},
          {"areas", mapped(report.areas, drawnArea)},
          {"lattices", lattices},
          {"nodes", report.areas_alone ? DrawingJson::array() : drawnNodes(report, surface)},
          {"pictures", mapped(report.pictures, drawnPictures)},
          {"provenance", provenanceOf(report.open, report.datasets)}};
}

DrawingJson drawingsOf(const Comparison& comparison) {
  const Surface surface(comparison.open[0]);
  DrawingJson names = DrawingJson::array(), files = DrawingJson::array(),
              everywhere = DrawingJson::array(), places = DrawingJson::array();
  for (std::size_t s = 0; s < 2; ++s) {
    names.push_back(comparison.open[s].scene().name);
    files.push_back(comparison.open[s].file().stem().string());
  }
  for (const PlaceDifference& one : comparison.everywhere)
    everywhere.push_back({{"name", one.name},
                          {"at", surface.mark(one.place)},
                          {"relative", rounded(one.relative, 6)}});
  for (const ComparedPlace& place : comparison.places) {
    DrawingJson axes = DrawingJson::array(), distances = DrawingJson::array();
    for (const auto& both : place.axes) axes.push_back(mapped(both, drawnWay));
    for (const ForceAtDistance& one : place.distances)
      distances.push_back(
          numbers(std::array{one.distance, one.first, one.second, one.difference}, 6));
    places.push_back({{"axes", axes}, {"distances", distances}});
  }
  return {{"version", version()},
          {"names", names},
          {"files", files},
          {"body", surface.body()},
          {"everywhere", everywhere},
          {"places", places},
          {"provenance", provenanceOf(comparison.open, comparison.datasets)}};
}

DrawingJson drawingsOf(const RunAccuracy& run) {
  DrawingJson ticks = DrawingJson::array();
  for (const ComparedTick& tick : run.compared) {
    const double force = std::max(tick.force.exact.norm(), relative_error_floor);
    const double error = (tick.force.interpolated - tick.force.exact).norm();
    ticks.push_back(numbers(
        std::array{tick.time, tick.speed, error / force, tick.force.error_bound / force}, 4));
  }
  return {{"version", version()}, {"ticks", ticks}};
}

/// Returns the page of a report, a comparison or a run.
template <class Shown>
std::string filledPage(const std::string& title, const Shown& shown) {
  nlohmann::ordered_json json = toJson(shown);
  json["drawings"] = drawingsOf(shown);
  return filledMarkup(report_markup, {{"title", escaped(title)},
                                      {"report", scriptJson(jsonText(json))},
                                      {"script", report_script}});
}

}  // namespace

std::string pageOf(const Report& report) {
  return filledPage(report.open.front().scene().name + ": accuracy and speed", report);
}

std::string pageOf(const Comparison& comparison) {
  return filledPage(
      fmt::format("{} and {}", comparison.open[0].scene().name, comparison.open[1].scene().name),
      comparison);
}

std::string pageOf(const RunAccuracy& run) {
  return filledPage(fmt::format("{}: {}", run.scene, run.recording.filename().string()), run);
}

}  // namespace palpate
