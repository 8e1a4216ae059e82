#include "viewer/touch_command.hpp"

#include <spdlog/spdlog.h>
#include <strings.h>

#include <algorithm>
#include <array>
#include <iostream>
#include <sstream>

#include "common/base/foreign_program.hpp"
#include "common/base/required_option.hpp"
#include "common/base/text.hpp"
#include "viewer/view_command.hpp"

// `palpate touch`: makes the mesh and the scene of an organ with palpate-worker, and lets a hand
// feel the scene.

namespace palpate {
namespace {

using std::filesystem::path;

/// Number of nodes with which the solver keeps up with a hand (docs/evaluation.md).
constexpr std::int32_t usual_nodes = 500;

struct TouchOptions {
  path organ;
  std::optional<std::int32_t> nodes;
  std::string unit;
};

/// Returns whether files with this extension hold a surface, whose number of nodes can be chosen.
bool isSurface(const path& file) {
  return std::ranges::any_of(std::array{".stl", ".obj", ".ply", ".off"}, [&](const char* surface) {
    return strcasecmp(file.extension().c_str(), surface) == 0;
  });
}

/// Removes a new mesh if the scene could not be made.
struct Unfinished {
  ~Unfinished() {
    std::error_code ignored;
    if (!mesh.empty()) std::filesystem::remove(mesh, ignored);
  }
  path mesh = {};
};

/// Error (bad input) if the organ has changed since one of these files was made from it.
void refuseOlder(const path& organ, std::initializer_list<path> made) {
  std::string older;
  for (const path& file : made)
    if (exists(file) && last_write_time(file) < last_write_time(organ))
      older += (older.empty() ? "" : " and ") + file.string();
  if (!older.empty())
    throw badInput("{0} is newer than {1}; to start from {0} again, remove or rename {1}",
                   organ.string(), older);
}

/// Runs a verb of palpate-worker to its end and passes on its warnings and errors. Logs the lines
/// of its output whose first word is in `told`.
ExitCode runWorker(std::vector<std::string> words, const std::string& unit,
                   std::initializer_list<std::string_view> told) {
  words.insert(words.begin(), programBeside("palpate-worker").string());
  words.emplace_back("--quiet");
  if (!unit.empty()) words.insert(words.end(), {"--unit", unit});
  const Ran ran = runToItsEnd({.words = std::move(words),
                               .package = "palpate",
                               .patience = std::chrono::hours(24),
                               .heeds_interrupts = true});
  tell("{}", ran.err);
  std::istringstream lines(ran.out);
  for (std::string line; std::getline(lines, line);)
    if (std::ranges::count(told, line.substr(0, line.find(' '))) > 0) spdlog::info("{}", line);
  return static_cast<ExitCode>(ran.exit_code);
}

/// Makes the mesh and then `scene`, unless these files exist. Returns the exit code of the program
/// that failed.
ExitCode makeScene(const TouchOptions& options, const path& scene) {
  const path& organ = options.organ;
  const bool is_made = organ == scene || organ.extension() == ".msh";
  const path mesh = is_made ? organ : path(scene).replace_extension(".msh");
  if (organ.extension() == ".h5")
    throw badInput("{}: is a dataset; run: palpate view {}", organ.string(),
                   shellWord(organ.string()));
  if (!exists(organ)) throw badInput("{}: there is no such file", organ.string());
  refuseOlder(organ, {scene, mesh});
  const path used = exists(scene) ? scene : exists(mesh) ? mesh : path();
  if ((!used.empty() && options.nodes) || (used == scene && !options.unit.empty()))
    throw badInput(
        "{} exists, so --nodes and --unit have no effect; omit them, or remove or "
        "rename it",
        used.string());
  if (!used.empty() && used != organ) spdlog::info("{} exists and is used as it is", used.string());
  if (used == scene) return ExitCode::done;
  catchInterrupts();
  Unfinished made;
  if (used.empty()) {
    spdlog::info("making a mesh of {}", organ.string());
    std::vector<std::string> words = {"mesh", organ.string(), "-o", mesh.string()};
    if (options.nodes || isSurface(organ))
      words.insert(words.end(), {"--nodes", std::to_string(options.nodes.value_or(usual_nodes))});
    const ExitCode code = runWorker(std::move(words), options.unit, {"note"});
    if (code != ExitCode::done) return code;
    made.mesh = mesh;
  }
  const ExitCode code = runWorker({"new", scene.string(), "--mesh", mesh.string()}, options.unit,
                                  {"unit", "fixed", "finger", "workspace", "warning"});
  if (code != ExitCode::done) return code;
  made.mesh.clear();
  spdlog::info(
      "the mesh {} and the scene {} are in this folder: check the proposed values in the scene, "
      "then touch it again, or build it with: palpate build {}",
      mesh.filename().string(), scene.string(), shellWord(scene.string()));
  return ExitCode::done;
}

std::function<ExitCode()> prepareTouch(CLI::App& app) {
  auto options = std::make_shared<TouchOptions>();
  auto view_options = std::make_shared<ViewOptions>();
  addRequired(app, "ORGAN", options->organ,
              "A closed surface (.stl, .obj, .ply, .off), a mesh of tetrahedra (.msh, .vtu, or "
              "another format that palpate mesh reads), or a scene (.toml)",
              "FILE");
  app.add_option("--nodes", options->nodes,
                 fmt::format("Approximate number of nodes for a surface [{}]", usual_nodes))
      ->type_name("N");
  app.add_option("--unit", options->unit, "Length unit of the file: m, cm or mm [guessed]")
      ->type_name("UNIT");
  const std::function<void()> complete = addViewOptions(app, view_options);
  app.footer(
      "Makes NAME.msh and NAME.toml in the current folder by palpate mesh and palpate new, unless\n"
      "they exist, then runs palpate view NAME.toml (docs/client.md).\n"
      "Exit codes: 0 done, 1 failed, 2 wrong usage or organ, 130 interrupted.");
  return [options, view_options, complete] {
    const path& organ = options->organ;
    const path scene = organ.extension() == ".toml" ? organ : organ.stem() += ".toml";
    view_options->datasets = {scene};
    complete();
    const ExitCode code = makeScene(*options, scene);
    return code == ExitCode::done ? view(*view_options, std::cout) : code;
  };
}

}  // namespace

const Verb touch_verb = {"touch", "Feel an organ at once: make its mesh and scene, and view it",
                         prepareTouch};

}  // namespace palpate
