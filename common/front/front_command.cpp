// The command `palpate VERB ...`, which replaces itself by the program that has this verb.

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/machine.hpp"
#include "common/base/program.hpp"
#include "common/base/text.hpp"

namespace palpate {
namespace {

using Words = std::vector<std::string_view>;

/// The programs, each with its verbs.
const std::vector<std::pair<std::string, Words>> programs = {
    {"palpate-worker", {"mesh", "new", "check", "solve", "work", "follow"}},
    {"palpate-scheduler",
     {"build", "serve", "status", "stop", "fleet", "pause", "resume", "seal", "priority", "retry",
      "explain", "events", "key"}},
    {"palpate-verify", {"verify"}},
    {"palpate-answers", {"query", "report", "share", "export"}},
    {"palpate-viewer", {"touch", "doctor", "view", "device"}}};

constexpr const char* overview =
    R"(Feel a nonlinear soft body at 1 kHz: Palpate solves equilibria in advance, for many
displacements of a finger anywhere on its surface, a patch or a node, and interpolates their forces.

Usage: palpate VERB [ARGUMENTS]        palpate VERB --help prints the options of a verb

From a mesh to forces
  touch    Feel an organ at once, from a closed surface, a mesh or a scene
  mesh     Make a mesh from a closed surface (.stl, .obj, .ply, .off) or a mesh of another format
  new      Write a first, commented scene around a mesh
  check    Validate a scene; print sizes, mesh quality, warnings and the cost of a build
  build    Compute the dataset of a scene on this machine; continues after an interruption
  query    Print force, stiffness and error bound at any displacement, from a dataset
  view     Touch a dataset: the haptic client, with the mouse, a haptic device or a virtual hand
  share    Write a dataset as one HTML page that can be touched by mouse or finger
  export   Write deformed bodies for ParaView and others, and force curves as CSV
  solve    Solve exactly at given displacements, without scheduler and dataset

On several machines
  serve    Run the scheduler of a scene; workers may join and leave at any time
  work     Run workers for a scheduler, on any machine
  follow   Solve configurations near the hand of a haptic client on another machine
  fleet    Start as many workers as a build can use, by Slurm or ssh
  status   Show the progress of a build: points, rate, time left, workers, failures by cause
  stop     Let workers finish their solves, then end the build; serve continues it later
  pause    Give workers no work until resume; they stay connected
  resume   Continue a paused build
  seal     Write a dataset of the results so far, while the build continues
  priority Compute one active node before others
  retry    Repeat solves that were set aside or failed with a given cause
  explain  Show how a lattice point was solved, or why it failed
  events   Print the events of a build: failures, workers, stages
  key      Make a key; allow other machines and people, or withdraw their keys
  check    Check a state directory for damage; repair it

With a haptic device elsewhere
  device   Lend a haptic device of this machine to a simulator on another machine

How far to trust it
  verify   Solve problems with known solutions; print computed, reference and deviation
  report   Compare speed and error of the interpolation methods on a dataset; --html writes a page
  doctor   Check whether this machine can run the haptic client: timer, limits, display, devices

At once, from a closed surface organ.stl:
  palpate touch organ.stl
With a dataset (for a kidney, 4 minutes on two cores; 20 with the default of 1000 nodes):
  palpate mesh organ.stl -o organ.msh --nodes 500
  palpate new organ --mesh organ.msh
  palpate check organ/scene.toml
  palpate build organ/scene.toml -o organ.h5
  palpate view organ.h5
or with organ.msh (here in millimetres) and this as organ.toml:
  mesh = "organ.msh"
  length_unit = "mm"
  [material]
  law = "mooney-rivlin"
  c10 = 1300                                  # Pa
  c01 = 1280
  [fixed]
  below = { axis = "x", fraction = 0.15 }     # held: the first 15 % along x
  [[active]]
  name = "tip"
  near = [58, 134, 2.5]                       # touched: the surface node nearest to this
  radius = 15                                 # and the nodes within 15 mm of it
  [workspace]
  radius = 100
  spacing = 20
run
  palpate check organ.toml
  palpate build organ.toml -o organ.h5
  palpate query organ.h5 --active tip --displacement 0.01 0 0       # metres in, newtons out
)";

int refuseVerb(std::string_view verb) {
  Words verbs;
  for (const auto& [program, of_it] : programs)
    verbs.insert(verbs.end(), of_it.begin(), of_it.end());
  const std::string_view nearest = nearestWord(verb, verbs);
  if (nearest.empty())
    tell("palpate: there is no verb \"{}\"; verbs: {}\n", verb, listed(verbs));
  else
    tell("palpate: there is no verb \"{}\"; did you mean \"{}\"?\n", verb, nearest);
  return static_cast<int>(ExitCode::usage);
}

bool namesDirectory(const std::string& argument) {
  std::error_code none;
  return std::filesystem::is_directory(argument, none);
}

/// Returns the program that has the verb arguments[0]; empty if no program has it.
std::string programFor(const std::vector<std::string>& arguments) {
  // `check` of a state directory is a verb of the scheduler.
  if (arguments[0] == "check" &&
      std::any_of(arguments.begin() + 1, arguments.end(), namesDirectory))
    return "palpate-scheduler";
  for (const auto& [program, verbs] : programs)
    if (std::ranges::find(verbs, arguments[0]) != verbs.end()) return program;
  return "";
}

/// Replaces this process by the program `name` in the same folder. Error if that fails.
[[noreturn]] void become(const std::string& name, std::vector<std::string> arguments) {
  if (name == "palpate-worker") requireMemory(memory_of_a_solver);
  std::error_code error;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
  if (error)
    throw failure("cannot find where Palpate is installed: /proc/self/exe: {}", error.message());
  const std::string program = self.parent_path() / name;
  arguments.insert(arguments.begin(), program);
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  // OpenBLAS reads this variable while it is loaded. palpate-worker also sets it, but only in
  // main(), which is never reached if a limit on address space stops OpenBLAS's many threads.
  setenv("OPENBLAS_NUM_THREADS", "1", 1);
  execv(program.c_str(), argv.data());
  const bool is_missing = errno == ENOENT;
  const std::string why = errnoText();
  const std::string hint = is_missing ? fmt::format(
                                            "; install the package {}, or build all programs with "
                                            "`cmake --build --preset release`",
                                            name == "palpate-viewer" ? "palpate-viewer" : "palpate")
                                      : "";
  throw failure("cannot start {}: {}{}", program, why, hint);
}

int run(std::vector<std::string> arguments) {
  const bool asks_for_help = arguments.empty() || arguments[0] == "help" ||
                             arguments[0] == "--help" || arguments[0] == "-h";
  if (asks_for_help && arguments.size() < 2) {
    fmt::print("{}", overview);
    return static_cast<int>(ExitCode::done);
  }
  if (asks_for_help) arguments = {arguments[1], "--help"};
  if (arguments[0] == "--version") {
    fmt::print("palpate {}\ncommit {}, {}\n{}\n", version(), commit(), PALPATE_BUILD_TYPE,
               PALPATE_BUILT_WITH);
    return static_cast<int>(ExitCode::done);
  }
  const std::string program = programFor(arguments);
  if (program.empty()) return refuseVerb(arguments[0]);
  const std::string verb = arguments[0];
  try {
    become(program, std::move(arguments));
  } catch (const Error& error) {
    tell("palpate {}: {}\n", verb, error.what());
    return static_cast<int>(error.exitCode());
  }
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) { return palpate::run({argv + 1, argv + argc}); }
