#include <spdlog/spdlog.h>

#include "common/base/required_option.hpp"
#include "common/base/scratch_folder.hpp"
#include "common/base/text.hpp"
#include "common/base/whole_file.hpp"
#include "common/mesh/mesh_reader.hpp"
#include "common/mesh/mesh_text.hpp"
#include "worker/meshing/guessed_unit.hpp"
#include "worker/meshing/mesh_conversion.hpp"
#include "worker/meshing/proposed_scene.hpp"
#include "worker/meshing/tetrahedra.hpp"
#include "worker/verbs.hpp"

namespace palpate {
namespace {

/// If a surface has more triangles than this, a mesher needs a minute or more.
constexpr std::size_t many_triangles = 200'000;

struct MeshOptions {
  std::string input, output;
  std::optional<std::int32_t> nodes = {};
  std::optional<double> size = {};
  std::string mesher = "auto", unit;
  bool largest = false, straight = false, weld = false;

  void addTo(CLI::App& app) {
    addRequired(
        app, "INPUT", input,
        "A closed surface (.stl, .obj, .ply, .off), or a mesh of tetrahedra (.vtu, .vtk, .inp, "
        ".feb, .node, .msh, or another format that meshio reads)",
        "FILE");
    addRequired(app, "-o,--output", output, "The mesh to write", "FILE.msh");
    app.add_option("--nodes", nodes, "Approximate number of nodes for a surface [1000]")
        ->check(CLI::Range(4, most_nodes))
        ->type_name("N");
    app.add_option("--size", size, "Edge length in the unit of the file, instead of --nodes")
        ->check(CLI::PositiveNumber)
        ->excludes("--nodes")
        ->type_name("L");
    app.add_option(
           "--mesher", mesher,
           "gmsh makes new triangles of even size, tetgen keeps those of the file; auto tries "
           "gmsh, then tetgen [auto]")
        ->check(CLI::IsMember({"auto", "gmsh", "tetgen"}))
        ->type_name("WORD");
    app.add_flag("--largest", largest, "Keep only the largest of several bodies");
    app.add_flag("--weld", weld,
                 "Merge coincident nodes of tetrahedra, so that parts hold together");
    app.add_flag("--straight", straight, "Straighten curved edges of tetrahedra");
    app.add_option("--unit", unit, "Length unit of the file, for the report: m, cm or mm [guessed]")
        ->type_name("UNIT");
    app.footer(
        "The mesh has the unit of INPUT; give it in the scene (length_unit). Groups and sets keep\n"
        "their names. This command runs gmsh, tetgen and Python (Debian: gmsh, tetgen,\n"
        "python3-meshio). docs/meshes.md lists what is repaired and what is refused.");
  }
};

Mesher mesherNamed(const std::string& word) {
  return word == "gmsh" ? Mesher::gmsh : word == "tetgen" ? Mesher::tetgen : Mesher::automatic;
}

Tetrahedra madeOfVolume(const MeshOptions& options, ConvertedMesh converted) {
  if (options.nodes || options.size || options.largest || options.mesher != "auto")
    throw badInput(
        "{}: has tetrahedra, which are not changed; --nodes, --size, --mesher and --largest are "
        "for surfaces",
        options.input);
  Tetrahedra made{readText(converted.file, "mesh"), {}, std::move(converted.notes)};
  made.mesh = parseGmsh(made.msh, options.input);
  return made;
}

Tetrahedra madeOfSurface(const MeshOptions& options, const ConvertedMesh& converted,
                         const std::filesystem::path& folder) {
  if (options.straight || options.weld)
    throw badInput(
        "{}: is a surface; --straight and --weld are for tetrahedra (a surface is always welded)",
        options.input);
  Fineness fineness;
  fineness.size = options.size;
  if (options.nodes) fineness.nodes = *options.nodes;
  const ClosedSurface surface =
      closedSurface(readTriangles(converted.file), options.input,
                    options.largest ? Bodies::largest : Bodies::only, fineness);
  fmt::print("surface    {}: {} triangles, closed\n", options.input, surface.triangles.size());
  if (surface.triangles.size() > many_triangles)
    spdlog::warn(
        "{}: filling {} triangles takes a minute or more, and thousands of nodes cannot resolve "
        "them all; simplify the surface first (MeshLab: Quadric Edge Collapse Decimation)",
        options.input, surface.triangles.size());
  Tetrahedra made =
      fillWithTetrahedra(surface, fineness, mesherNamed(options.mesher), folder, options.input);
  made.notes.insert(made.notes.begin(), surface.notes.begin(), surface.notes.end());
  made.notes.insert(made.notes.begin(), converted.notes.begin(), converted.notes.end());
  return made;
}

/// Refuses an unsuitable output file before anything is computed.
void refuseOutput(const MeshOptions& options) {
  const std::filesystem::path output = options.output;
  if (output.extension() != ".msh")
    throw badInput("-o {}: the output is a Gmsh file; give it the extension .msh", options.output);
  refuseMeshName(output, "-o");
  const std::filesystem::path input = options.input;
  refuseInput(output, "-o", {&input, 1});
  std::error_code ignored;
  if (std::filesystem::is_directory(output, ignored))
    throw badInput("-o {}: is a folder; give the name of a file", options.output);
  refuseUnwritable(output, "-o");
}

void printUnit(const MeshOptions& options, const LengthUnit& unit,
               const std::optional<GuessedUnit>& guess, double extent) {
  if (!guess)
    fmt::print("warning    {}; scale the mesh before you use it\n", whyNoUnit(extent));
  else if (!options.unit.empty() && !makesABody(extent, unit))
    fmt::print("warning    {}; --unit {} fits\n", whyNotIn(extent, unit), guess->unit.word);
  else if (!options.unit.empty())
    fmt::print("unit       {}\n", unit.name);
  else
    fmt::print("unit       {}, guessed from the size{}; change with --unit\n", unit.name,
               guess->doubt.empty() ? "" : fmt::format(" ({})", guess->doubt));
}

/// Prints the command that makes a scene of the mesh, if the unit gives a body of a plausible size.
void printNext(const MeshOptions& options, const LengthUnit& unit, double extent) {
  if (!makesABody(extent, unit)) return;
  fmt::print("next: palpate new {} --mesh {}{}\n",
             shellWord(std::filesystem::path(options.output).stem().string()),
             shellWord(options.output),
             options.unit.empty() ? "" : fmt::format(" --unit {}", unit.word));
}

/// Prints the report in metres, whatever the unit of the file.
void printMesh(Tetrahedra& made, const MeshOptions& options) {
  const double extent = boundingBox(made.mesh).sizes().maxCoeff();
  const std::optional<GuessedUnit> guess = guessedUnit(extent);
  const LengthUnit unit = !options.unit.empty() ? unitNamed(options.unit)
                          : guess               ? guess->unit
                                                : length_units.front();
  for (Eigen::Vector3d& node : made.mesh.nodes)
    node = node.unaryExpr([&](double x) { return toMetres(x, unit.metres); });
  const MeshQuality quality = measure(made.mesh);
  fmt::print("{}", meshText(made.mesh, quality,
                            std::filesystem::path(options.output).filename().string()));
  for (const std::string& doubt : unjoinedText(made.mesh, quality, options.output))
    fmt::print("warning    {}\n", doubt);
  printUnit(options, unit, guess, extent);
  for (const std::string& note : made.notes) fmt::print("note       {}\n", note);
  printNext(options, unit, extent);
}

void mesh(const MeshOptions& options) {
  if (!options.unit.empty()) unitNamed(options.unit);
  refuseOutput(options);
  catchInterrupts();
  const ScratchFolder folder;
  const ConvertedMesh converted = convertMesh(options.input, folder.path(),
                                              {.straight = options.straight, .weld = options.weld});
  Tetrahedra made = converted.is_volume ? madeOfVolume(options, converted)
                                        : madeOfSurface(options, converted, folder.path());
  replaceFile(options.output, made.msh, "mesh");
  printMesh(made, options);
}

}  // namespace

const Verb mesh_verb = {"mesh", "Make a mesh from a closed surface or a mesh of another format",
                        prepareVerb<MeshOptions, mesh>};

}  // namespace palpate
