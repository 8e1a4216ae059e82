
#include "common/base/required_option.hpp"
#include "scheduler/service/status.hpp"
#include "scheduler/verbs/explanation.hpp"
#include "scheduler/verbs/verbs.hpp"

namespace palpate {
namespace {

struct ExplainOptions {
  std::string where;
  std::string active;
  std::vector<double> at;                           ///< metres; empty or three
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< in spacings
  bool json = false;

  void addTo(CLI::App& app) {
    addRequired(app, "WHERE", where, "Dataset (OUT.h5) or state directory");
    app.add_option("--active", active, "Name of the active node, area or site [the only one]");
    app.add_option("--at", at, "For an area: use the site nearest to this place, metres")
        ->expected(3);
    addRequired(
        app, "I", point[0],
        "Lattice coordinates of the point, in spacings; those of refined points have fractions");
    app.add_option("J", point[1])->required();
    app.add_option("K", point[2])->required();
    app.add_flag("--json", json, "Print one JSON object (docs/commands.md)");
  }
};

void explainPoint(const ExplainOptions& options) {
  const KnownSpaces known = spacesIn(options.where);
  std::optional<Eigen::Vector3d> place;
  if (!options.at.empty()) place = Eigen::Vector3d(options.at.data());
  const wire::Explanation explanation = explain(known.named(options.active, place), options.point);
  fmt::print("{}", options.json ? toJson(explanation) + '\n' : explanation.text());
}

}  // namespace

const Verb explain_verb = {"explain", "Show how a lattice point was solved, or why it failed",
                           prepareVerb<ExplainOptions, explainPoint>};

}  // namespace palpate
