#include <filesystem>
#include <memory>

#include "common/dataset/dataset.hpp"
#include "common/problem/problem.hpp"
#include "scheduler/explanation.hpp"
#include "scheduler/service/status.hpp"
#include "scheduler/state/job_store.hpp"
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

wire::Explanation explainFromDataset(const ExplainOptions& options) {
  const Dataset dataset(options.where);
  return explain(spaceNamed(dataset.spaces(), options.active), options.point);
}

wire::Explanation explainFromDirectory(const ExplainOptions& options) {
  StoredTables tables(options.where);
  const Problem problem = decodeProblem(tables.build().problem);
  const Replay replayed = replay(problem, tables.results());
  return explain(spaceNamed(spaceTables(replayed.plans), options.active), options.point);
}

ExitCode run(const ExplainOptions& options) {
  const wire::Explanation explanation = std::filesystem::is_directory(options.where)
                                            ? explainFromDirectory(options)
                                            : explainFromDataset(options);
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
