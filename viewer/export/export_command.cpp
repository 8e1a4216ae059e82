#include "viewer/export/export_command.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <iostream>

#include "common/base/number_text.hpp"
#include "common/base/required_option.hpp"
#include "common/base/whole_file.hpp"
#include "viewer/export/configuration_grid.hpp"
#include "viewer/export/configuration_source.hpp"
#include "viewer/export/export_target.hpp"
#include "viewer/export/touch_way.hpp"
#include "viewer/export/vtu.hpp"
#include "viewer/fields/field_choice.hpp"

namespace palpate {
namespace {

/// Error unless the options select what the format holds: one configuration, or a path.
void checkChoice(const ExportOptions& options, const ExportTarget& target) {
  const bool has_point = !options.point.empty(), has_displacement = !options.displacement.empty();
  if (has_point == has_displacement)
    throw badInput("give either --displacement X Y Z (metres) or --point I J K");
  if (has_point && !options.method.empty())
    throw badInput("--method {}: a --point is exported as it was solved; omit --method",
                   options.method);
  const bool is_path = options.displacement == std::vector<std::string>{"-"};
  const std::string name = target.file().string();
  if (target.holdsWay()) {
    if (has_point)
      throw badInput("{}: --point selects one configuration, not a path; write it as .vtu", name);
    if (!is_path && options.steps == 0)
      throw badInput(
          "{}: give --steps N for a straight path from rest, or read a path with --displacement -",
          name);
    return;
  }
  if (is_path || options.steps != 0)
    throw badInput("{}: a .vtu file holds one configuration; write a path as .pvd or .csv", name);
}

/// Warns about touches without a reliable answer, and returns the exit code. outside: number of
/// these touches. all: number of all touches.
ExitCode codeOf(std::size_t outside, std::size_t all) {
  if (outside == 0) return ExitCode::done;
  spdlog::warn(
      "no reliable force for {} of {}: each is beyond the workspace or the solved points, away "
      "from the surface, far from all sites, or on fixed nodes; it is written with inside = 0",
      outside, counted(all, "touch", "touches"));
  return ExitCode::partly_failed;
}

std::string describe(const ConfigurationGrid& grid) {
  const Grid& rest = grid.rest();
  return fmt::format(
      "{}, {}{}", counted(rest.pointCount(), "point"),
      grid.isVolume() ? counted(rest.cellCount(), "tetrahedron", "tetrahedra")
                      : counted(rest.cellCount(), "triangle"),
      grid.isVolume()
          ? ""
          : " of the surface only; to export the volume, pressures and det F, set [storage] "
            "displacement = \"all\" in the scene");
}

ForceAnswers answersFor(const ExportOptions& options, const Dataset& dataset) {
  const std::string& method = options.method.empty() ? forceFieldMethods().front() : options.method;
  return ForceAnswers(dataset, options.active, !options.at.empty(), method);
}

/// Returns the configuration that the options select.
ExportedConfiguration chosenConfiguration(const ExportOptions& options, const Dataset& dataset) {
  if (!options.point.empty()) {
    // onlyTouch() also needs a displacement; any will do, because only the place is used.
    const auto place =
        options.at.empty() ? std::nullopt : onlyTouch(options.at, {"0", "0", "0"}, 1).at;
    const Eigen::Vector3d point = Eigen::Map<const Eigen::Vector3d>(options.point.data());
    return solvedConfiguration(dataset, options.active, place, point);
  }
  const ForceAnswers answers = answersFor(options, dataset);
  const TouchInput touch = onlyTouch(options.at, options.displacement, answers.workspaceRadius());
  InterpolatedShape shape(dataset, answers.choice());
  return interpolatedConfiguration(dataset, shape, answers, followWay({touch}, answers).front());
}

ExitCode exportOne(const ExportOptions& options, const Dataset& dataset, const ExportTarget& target,
                   std::ostream& output) {
  const ExportedConfiguration configuration = chosenConfiguration(options, dataset);
  const ConfigurationGrid grid(dataset);
  endWhenInterrupted();
  replaceFile(target.file(), vtuBytes(grid.of(configuration)), "grid");
  output << fmt::format("{}: {}\n", target.file().string(), describe(grid));
  return codeOf(configuration.sample.inside ? 0 : 1, 1);
}

ExitCode exportSeries(const Dataset& dataset, const ForceAnswers& answers,
                      const std::vector<WayStep>& way, const ExportTarget& target,
                      std::ostream& output) {
  InterpolatedShape shape(dataset, answers.choice());
  const ConfigurationGrid grid(dataset);
  target.beginSeries();
  std::vector<SeriesFile> series;
  std::size_t outside = 0;
  for (std::size_t n = 0; n < way.size(); ++n) {
    if (interrupted()) {
      spdlog::warn("interrupted after {} of {} files; {} was not written", n, way.size(),
                   target.file().string());
      return ExitCode::interrupted;
    }
    ExportedConfiguration configuration =
        interpolatedConfiguration(dataset, shape, answers, way[n]);
    configuration.way = way[n].way;
    outside += configuration.sample.inside ? 0 : 1;
    replaceFile(target.seriesFile(n), vtuBytes(grid.of(configuration)), "grid");
    series.push_back({static_cast<double>(n), target.nameInSeries(n)});
  }
  target.endSeries(way.size());
  replaceFile(target.file(), pvdText(series), "list of the series");
  output << fmt::format("{}: {} in {}, each {}\n", target.file().string(),
                        counted(way.size(), "file"), target.seriesFolder().string(),
                        describe(grid));
  return codeOf(outside, way.size());
}

ExitCode exportCurve(const std::vector<WayStep>& way, const ExportTarget& target,
                     std::ostream& output) {
  replaceFile(target.file(), forceCurve(way), "curve");
  output << fmt::format("{}: {}\n", target.file().string(), counted(way.size(), "line"));
  const std::ptrdiff_t outside =
      std::ranges::count(way, false, [](const WayStep& step) { return step.answer.sample.inside; });
  return codeOf(static_cast<std::size_t>(outside), way.size());
}

}  // namespace

void ExportOptions::addTo(CLI::App& app) {
  addRequired(app, "DATASET", dataset, "Sealed dataset from palpate build, OUT.h5", "FILE");
  addRequired(
      app, "-o,--output", output,
      fmt::format("Output file; its ending selects the format: {}", ExportTarget::endings()),
      "FILE");
  app.add_option("--active", active, "Active node, or surface that a finger touches [the only one]")
      ->type_name("NAME");
  addPlaceOption(app, at);
  addDisplacementOption(app, displacement)->required(false);
  app.add_option(
         "--point", point,
         "Solved lattice point instead of a displacement, in spacings; with --at, a point of the "
         "nearest site")
      ->expected(3)
      ->type_name("I J K");
  app.add_option("--steps", steps, "Steps on the straight path from rest (.pvd and .csv)")
      ->type_name("N");
  app.add_option("--method", method,
                 fmt::format("Interpolation of forces: {} [{}]",
                             fmt::join(forceFieldMethods(), " or "), forceFieldMethods().front()))
      ->type_name("NAME");
  app.add_flag("--replace", replace, "Overwrite existing files");
  app.footer(
      "Points are written at rest: in ParaView, Warp By Vector with `displacement` deforms the\n"
      "body (docs/export.md).\n"
      "Exit codes: 0 done, 1 failed, 2 wrong usage, 3 some force is not reliable, see query\n"
      "(it is written with inside = 0), 130 interrupted.");
}

ExitCode exportConfigurations(const ExportOptions& options, std::istream& input,
                              std::ostream& output) {
  catchInterrupts();
  const ExportTarget target(options.output);
  checkChoice(options, target);
  target.refuseWhatIsThere(options.dataset, options.replace);
  refuseUnwritable(options.output, "-o");
  const Dataset dataset(options.dataset);
  warnIfPartial(dataset);
  if (!target.holdsWay()) return exportOne(options, dataset, target, output);
  const ForceAnswers answers = answersFor(options, dataset);
  endWhenInterrupted();
  const std::vector<TouchInput> touches =
      touchWay(options.at, options.displacement, options.steps, input, answers.workspaceRadius());
  // Evaluate all touches first, so that an error in a touch is found before any file is replaced.
  const std::vector<WayStep> way = followWay(touches, answers);
  if (target.format() == ExportFormat::csv) return exportCurve(way, target, output);
  return exportSeries(dataset, answers, way, target, output);
}

const Verb export_verb = {"export", "Export configurations for ParaView, or force curves as CSV",
                          prepareVerb<ExportOptions, exportConfigurations, std::cin, std::cout>};

}  // namespace palpate
