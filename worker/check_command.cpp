#include <unistd.h>

#include "common/base/required_option.hpp"
#include "common/base/terminal.hpp"
#include "worker/check/scene_report.hpp"
#include "worker/verbs.hpp"

namespace palpate {
namespace {

struct CheckOptions {
  std::string scene;
  bool json = false;

  void addTo(CLI::App& app) {
    addRequired(app, "SCENE", scene, "The scene, a TOML file (docs/scene.md)", "FILE");
    app.add_flag("--json", json, "Print one JSON object, lengths in metres");
    app.footer(
        "palpate check DIRECTORY checks a state directory for damage, and repairs it with "
        "--repair:\nsee palpate-scheduler check --help.");
  }
};

void check(const CheckOptions& options) {
  const Problem problem = loadProblem(options.scene);
  const SceneReport report = reportOf(problem);
  if (options.json) return fmt::print("{}\n", sceneReportJson(report));
  const std::string text = sceneReportText(report);
  fmt::print("{}", isatty(STDOUT_FILENO) ? wrapped(text, sizeOf(STDOUT_FILENO).columns, 11) : text);
}

}  // namespace

const Verb check_verb = {
    "check", "Validate a scene; print sizes, mesh quality, warnings and the cost of a build",
    prepareVerb<CheckOptions, check>};

}  // namespace palpate
