#include <CLI/CLI.hpp>

#include "common/dataset/dataset.hpp"
#include "common/problem/problem.hpp"
#include "scheduler/explanation.hpp"
#include "scheduler/service/status.hpp"
#include "scheduler/state/replay.hpp"
#include "scheduler/verbs.hpp"

namespace palpate {
namespace {

struct ExplainOptions {
  std::string where;
  std::string active;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< in spacings
  bool json = false;
};

/// What is known of each space by now, from a dataset or a state directory.
std::vector<SpaceTable> spacesIn(const std::string& where) {
  if (!std::filesystem::is_directory(where)) return Dataset(where).spaces();
  StoredTables tables(where);
  const Problem problem = decodeProblem(tables.build().problem);
  return spaceTables(replay(problem, tables.results()).plans);
}

ExitCode run(const ExplainOptions& options) {
  const std::vector<SpaceTable> spaces = spacesIn(options.where);
  const wire::Explanation explanation = explain(spaceNamed(spaces, options.active), options.point);
  fmt::print("{}", options.json ? toJson(explanation) + '\n' : explanation.text());
  return ExitCode::done;
}

std::function<ExitCode()> prepareExplain(CLI::App& app) {
  auto options = std::make_shared<ExplainOptions>();
  app.add_option("WHERE", options->where, "Dataset, OUT.h5, or a state directory")->required();
  app.add_option("--active", options->active,
                 "Name of the active node; may be left out where there is one");
  app.add_option("I", options->point[0],
                 "Lattice coordinates of the point: its displacement is spacing * (I, J, K); "
                 "refined points have fractions")
      ->required();
  app.add_option("J", options->point[1])->required();
  app.add_option("K", options->point[2])->required();
  app.add_flag("--json", options->json, "One JSON object (docs/commands.md)");
  return [options] { return run(*options); };
}

}  // namespace

const Verb explain_verb = {"explain", "How a lattice point was reached, or why it failed",
                           prepareExplain};

}  // namespace palpate
