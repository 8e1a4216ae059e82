#include <cctype>

#include "common/base/required_option.hpp"
#include "common/base/text.hpp"
#include "common/base/whole_file.hpp"
#include "common/mesh/mesh_reader.hpp"
#include "worker/meshing/guessed_unit.hpp"
#include "worker/meshing/proposed_scene.hpp"
#include "worker/verbs.hpp"

namespace palpate {
namespace {

struct NewOptions {
  std::string place, mesh, unit;

  void addTo(CLI::App& app) {
    addRequired(app, "PLACE", place,
                "Folder to make, for scene.toml and the mesh; or the scene, NAME.toml",
                "FOLDER|FILE");
    addRequired(app, "--mesh", mesh, "Mesh, written by palpate mesh or Gmsh", "FILE.msh");
    app.add_option("--unit", unit, "Length unit of the mesh: m, cm or mm [guessed]")
        ->type_name("UNIT");
    app.footer(
        "Proposes fixed nodes, a finger that touches the rest of the surface, and its depth. Edit\n"
        "the marked lines of the file (docs/meshes.md, docs/scene.md).");
  }
};

bool namesScene(const std::filesystem::path& place) { return place.extension() == ".toml"; }

/// Returns a valid scene name, made from the name of the scene's folder or file.
std::string sceneNameOf(const std::filesystem::path& place) {
  const std::filesystem::path plain = namesScene(place) ? place.stem() : (place / "").parent_path();
  std::string name;
  for (const char c : plain.filename().string())
    name += std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_' ? c : '-';
  return name.find_first_not_of('-') == std::string::npos ? "organ" : name;
}

void refuseScene(const std::filesystem::path& scene) {
  const std::filesystem::path directory = scene.parent_path();
  std::error_code ignored;
  if (std::filesystem::exists(directory, ignored) &&
      !std::filesystem::is_directory(directory, ignored))
    throw badInput("{}: is a file; give the name of a folder", directory.string());
  if (std::filesystem::exists(scene, ignored))
    throw badInput("{}: this scene exists already; give another name, or remove it",
                   scene.string());
}

/// Returns whether `copy` exists and contains this mesh. Error if it contains anything else,
/// because no file is overwritten.
bool isThereAlready(const std::filesystem::path& copy, const std::string& msh) {
  std::error_code ignored;
  if (!std::filesystem::exists(copy, ignored)) return false;
  if (readText(copy, "mesh") == msh) return true;
  throw badInput("{}: a different mesh has this name already; give another folder, or remove it",
                 copy.string());
}

/// Returns the unit of a mesh: the user's choice, or a guess from its size. Error (bad input) if
/// the body would not have a plausible size.
GuessedUnit unitOfMesh(const NewOptions& options, const Mesh& as_metres) {
  const double extent = boundingBox(as_metres).sizes().maxCoeff();
  const std::optional<GuessedUnit> guess = guessedUnit(extent);
  if (!options.unit.empty()) {
    const LengthUnit unit = unitNamed(options.unit);
    if (makesABody(extent, unit) || !guess) return {unit};
    throw badInput("{}: {}; give --unit {}", options.mesh, whyNotIn(extent, unit),
                   guess->unit.word);
  }
  if (!guess) throw badInput("{}: {}; scale the mesh", options.mesh, whyNoUnit(extent));
  return *guess;
}

void makeFolder(const std::filesystem::path& directory) {
  if (directory.empty()) return;  // the current one
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (error)
    throw failure("{}: the folder cannot be made: {}", directory.string(), error.message());
}

void writeScene(const NewOptions& options) {
  const std::filesystem::path place = options.place, mesh_file = options.mesh;
  const std::filesystem::path scene_file = namesScene(place) ? place : place / "scene.toml";
  refuseScene(scene_file);
  if (mesh_file.extension() != ".msh")
    throw badInput("--mesh {}: a scene needs a Gmsh .msh file; run: palpate mesh {} -o {}",
                   options.mesh, shellWord(options.mesh),
                   shellWord(std::filesystem::path(mesh_file).replace_extension(".msh").string()));
  refuseMeshName(mesh_file, "--mesh");
  const std::string msh = readText(mesh_file, "mesh");
  const std::filesystem::path copy = scene_file.parent_path() / mesh_file.filename();
  const bool is_there = isThereAlready(copy, msh);
  const GuessedUnit unit = unitOfMesh(options, parseGmsh(msh, options.mesh));
  const Mesh mesh = parseGmsh(msh, options.mesh, unit.unit.metres);
  const ProposedScene scene =
      proposedScene(mesh, sceneNameOf(place), mesh_file.filename().string(), unit);
  makeFolder(scene_file.parent_path());
  // The scene is written last, so that a folder that has a scene is complete.
  if (!is_there) replaceFile(copy, msh, "mesh");
  replaceFile(scene_file, scene.toml, "scene");

  const std::string file = scene_file.string();
  fmt::print("scene      {}, with {}\n", file, mesh_file.filename().string());
  fmt::print("unit       {}{}\n", unit.unit.name,
             !options.unit.empty() ? ""
             : unit.doubt.empty()
                 ? ", guessed from the size; change with --unit"
                 : fmt::format(", guessed from the size ({}); change with --unit", unit.doubt));
  for (const std::string& choice : scene.choices) fmt::print("{}\n", choice);
  if (!mesh.unused_names.empty())
    fmt::print(
        "note       these named groups have no elements and cannot be used: \"{}\" (with "
        "Mesh.SaveAll = 1, version 2.2 saves elements without their groups)\n",
        fmt::join(mesh.unused_names, "\", \""));
  for (const std::string& warning : scene.warnings) fmt::print("warning    {}\n", warning);
  fmt::print("next: palpate check {}\n", shellWord(file));
}

}  // namespace

const Verb new_verb = {"new", "Write a first, commented scene around a mesh",
                       prepareVerb<NewOptions, writeScene>};

}  // namespace palpate
