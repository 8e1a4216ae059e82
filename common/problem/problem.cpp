#include "common/problem/problem.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <numeric>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "common/base/index.hpp"
#include "common/base/number_text.hpp"
#include "common/base/parallel.hpp"
#include "common/base/text.hpp"
#include "common/base/units.hpp"
#include "common/mesh/mesh_reader.hpp"
#include "common/mesh/tetrahedron.hpp"
#include "common/problem/finger.hpp"
#include "common/problem/selection.hpp"
#include "common/scene/key_lines.hpp"

namespace palpate {
namespace {

/// Typical extent of an organ, metres.
constexpr double usual_body = 0.2;

void refuseMistakenUnit(const Mesh& mesh, double metres_per_unit) {
  const double size = boundingBox(mesh).sizes().maxCoeff();
  if (size >= smallest_body && size <= largest_body) return;
  // Find the unit by its size, because a scene does not keep the name of its unit.
  const auto* const used = std::ranges::min_element(length_units, {}, [&](const LengthUnit& unit) {
    return std::abs(unit.metres - metres_per_unit);
  });
  const auto* const best = std::ranges::min_element(length_units, {}, [&](const LengthUnit& unit) {
    return std::abs(std::log(size / used->metres * unit.metres / usual_body));
  });
  const double best_size = size / used->metres * best->metres;
  const std::string finding =
      fmt::format("the mesh is {}{:.4g} m wide", size < smallest_body ? "only " : "", size);
  if (best == used || best_size < smallest_body || best_size > largest_body)
    throw badInput(
        "{}, and no length_unit (m, cm, mm) gives it a width of 1 mm to 10 m; scale the mesh",
        finding);
  throw badInput(
      "{}; its numbers look like {} read as {}. Write length_unit = \"{}\" in the scene: then the "
      "mesh is {:.4g} m wide, and the lengths in the scene are in {} too",
      finding, best->name, used->name, best->word, best_size, best->word);
}

/// Refuses a body with a component that can move freely. A component is held if its fixed nodes,
/// together with the nodes that it shares with other held components, do not lie on one line.
void refuseLoosePieces(const Problem& problem) {
  const Mesh& mesh = problem.mesh;
  const std::vector<NodeSet> pieces = piecesOf(mesh);
  std::vector<bool> held(mesh.nodes.size());
  for (const std::int32_t node : problem.fixed) held[at(node)] = true;
  std::vector<const NodeSet*> loose;
  for (const NodeSet& piece : pieces) loose.push_back(&piece);
  const auto heldOf = [&](const NodeSet& piece) {
    NodeSet nodes;
    std::ranges::copy_if(piece, std::back_inserter(nodes), [&](auto n) { return held[at(n)]; });
    return nodes;
  };
  const auto hold = [&](const NodeSet* piece) {
    const NodeSet nodes = heldOf(*piece);
    if (nodes.empty() || areCollinear(nodes, mesh)) return false;
    for (const std::int32_t node : *piece) held[at(node)] = true;
    return true;
  };
  while (std::erase_if(loose, hold) > 0) {
  }
  if (loose.empty()) return;
  const NodeSet& piece = *loose.front();
  const NodeSet nodes = heldOf(piece);
  const int mesh_line = problem.scene.lines.of("mesh");
  const std::string where = fmt::format("the piece of {} nodes around node {} at {}", piece.size(),
                                        piece.front(), placeText(mesh.nodes[at(piece.front())]));
  if (nodes.empty())
    throw badInputAt(
        mesh_line,
        "the mesh consists of {} pieces that share no face, and {} has no fixed node; fix some of "
        "its nodes, remove it, or join it to the others (palpate mesh --weld)",
        pieces.size(), where);
  const std::string hinge = placeText(mesh.nodes[at(nodes.front())]);
  if (!std::ranges::includes(problem.fixed, nodes))
    throw badInputAt(
        mesh_line,
        "the mesh consists of {} pieces that share no face, and {} is joined to the others by {} "
        "on one line (node {} at {}), around which it can turn; join it by faces, or remove it",
        pieces.size(), where, counted(nodes.size(), "node"), nodes.front(), hinge);
  throw badInputAt(
      problem.scene.fixed.lines.table,
      "[fixed] holds {} on one line (node {} at {}): the body can turn around it; fix at least "
      "three nodes that are not on one line",
      counted(nodes.size(), "node"), nodes.front(), hinge);
}

/// Returns whether `nodes` is a sorted set of nodes of a mesh with `n_nodes` nodes. Data from other
/// processes may violate this.
bool isNodeSet(const NodeSet& nodes, std::size_t n_nodes) {
  return std::ranges::adjacent_find(nodes, std::greater_equal<>()) == nodes.end() &&
         (nodes.empty() ||
          (nodes.front() >= 0 && static_cast<std::size_t>(nodes.back()) < n_nodes));
}

void checkFixed(const Problem& problem) {
  const std::size_t n_nodes = problem.mesh.nodes.size();
  if (problem.fixed.empty()) throw badInput("[fixed] selects no node, so nothing holds the body");
  if (!isNodeSet(problem.fixed, n_nodes))
    throw badInput("the fixed nodes are not a sorted set of nodes of the mesh");
  if (problem.fixed.size() == n_nodes)
    throw badInput("[fixed] selects all {} nodes: nothing is left to move", n_nodes);
}

/// Error unless the patch fits the tool. The patch of a rigid tool must have no weights, other
/// patches one weight per node with sum 1. A finger must have ActivePatch::finger, and other tools
/// must not.
void checkWeights(const ActivePatch& patch, ToolKind tool) {
  const bool weighted = tool != ToolKind::rigid, finger = tool == ToolKind::finger;
  if (patch.finger.has_value() != finger || (finger && !isFinger(*patch.finger)))
    throw badInput("active \"{}\": only a finger has a centre and reach, and these must be valid",
                   patch.name);
  const double sum = std::accumulate(patch.weights.begin(), patch.weights.end(), 0.0);
  if (patch.weights.size() != (weighted ? patch.nodes.size() : 0) ||
      (weighted && !(std::abs(sum - 1) < 1e-9)))
    throw badInput("active \"{}\": its {} weights (sum {}) do not fit its {} nodes", patch.name,
                   patch.weights.size(), sum, patch.nodes.size());
}

/// Largest allowed ratio of stiffness between the materials of a body. At larger ratios, the
/// round-off of the stiff part exceeds the forces in the soft part.
constexpr double largest_contrast = 1e7;

void refuseContrast(const std::vector<Region>& regions) {
  const auto shear = [](const Region& region) { return shearModulus(region.material); };
  const auto young = [](const Region& region) { return youngModulus(region.material); };
  const Region &soft = *std::ranges::min_element(regions, {}, shear),
               &stiff = *std::ranges::max_element(regions, {}, young);
  const auto named = [](const Region& region) {
    return region.isRest() ? std::string("[material]") : "[[region]] \"" + region.name() + '"';
  };
  if (young(stiff) > largest_contrast * shear(soft))
    throw badInputAt(
        stiff.lines.table,
        "{} has a Young's modulus of {:.3g} Pa at rest, more than {:g} times the shear modulus of "
        "{}, {:.3g} Pa: forces would be lost in round-off; make it {:.1g} Pa, which is nearly "
        "rigid, or fix the rigid part",
        named(stiff), young(stiff), largest_contrast, named(soft), shear(soft), 1e5 * shear(soft));
}

void checkRegions(const Problem& problem) {
  refuseContrast(problem.scene.regions);
  const std::size_t n_elements = problem.mesh.tetrahedra.size(),
                    n_regions = problem.scene.regions.size();
  if (problem.region_of.size() != n_elements ||
      std::ranges::any_of(problem.region_of, [&](auto r) { return r >= n_regions; }))
    throw badInput("the regions of the {} tetrahedra do not match the scene", n_elements);
  if (const std::size_t needed = hasFibers(problem.scene.regions) ? n_elements : 0;
      problem.fibers.size() != needed)
    throw badInput("the problem has fibres for {} of {} tetrahedra, but its materials need {}",
                   problem.fibers.size(), n_elements, needed);
  for (const auto& fibers : problem.fibers)
    for (const Eigen::Vector3d& fiber : fibers)
      if (!fiber.isZero(0) && !(std::abs(fiber.squaredNorm() - 1) < 1e-12))
        throw badInput("a fibre of length {} is not a direction", fiber.norm());
}

/// Refuses a patch with which some elements cannot keep their volume. The pressure at a node keeps
/// the volume of the elements around the node constant. If all nodes of these elements are fixed or
/// move with the tool, a displacement changes their volume, and no free node can compensate for
/// this.
void refuseSqueezed(const Problem& problem, const ActivePatch& patch) {
  const PressureSpace pressure = problem.scene.discretization.pressure;
  const bool exact = pressure == PressureSpace::p1 || pressure == PressureSpace::p2;
  if (!exact || !patch.weights.empty()) return;
  enum Holder : std::uint8_t { nobody = 0, support = 1, tool = 2 };
  const Mesh& mesh = problem.mesh;
  std::vector<std::uint8_t> holder(mesh.nodes.size(), nobody), keeps(holder.size(), 0);
  for (const std::int32_t node : problem.fixed) holder[node] = support;
  for (const std::int32_t node : patch.nodes) holder[node] = tool;
  std::vector<std::size_t> squeezed;
  for (std::size_t element = 0; element < mesh.tetrahedra.size(); ++element) {
    const Material& material = problem.scene.regions[problem.region_of[element]].material;
    if (!isMixed(material)) continue;
    const std::vector<std::int32_t> nodes = nodesOf(mesh, element);
    const auto heldBy = [&](Holder who) {
      return std::ranges::count(nodes, who, [&](std::int32_t node) { return holder[node]; });
    };
    const bool can_move = heldBy(nobody) > 0 || !isIncompressible(material);
    if (!can_move && heldBy(support) > 0 && heldBy(tool) > 0) squeezed.push_back(element);
    for (const std::int32_t node : nodes)
      if (can_move) keeps[node] = 1;
  }
  for (const std::size_t element : squeezed)
    for (const std::int32_t node : nodesOf(mesh, element))
      if (!keeps[node] && (pressure == PressureSpace::p2 || node < mesh.vertices()))
        throw badInput(
            "active \"{}\": every node around node {} at {} is fixed or moves with the tool, so {} "
            "cannot keep its volume; make radius smaller, fix fewer nodes, or give the material a "
            "bulk modulus",
            patch.name, node, placeText(mesh.nodes[node]), placeOf(mesh, element));
}

void checkPatch(const Problem& problem, std::size_t number, const NodeSet& surface) {
  const ActivePatch& patch = problem.active[number];
  checkWeights(patch, problem.scene.active[number].tool);
  const std::size_t n_nodes = problem.mesh.nodes.size();
  if (!isNodeSet(patch.nodes, n_nodes) || !contains(patch.nodes, patch.node) ||
      !contains(surface, patch.node))
    throw badInput("active \"{}\": its nodes are not a sorted set of nodes around a surface node",
                   patch.name);
  if (contains(problem.fixed, patch.node))
    throw badInput(
        "active \"{}\": node {} at {} is one of the {} fixed nodes; move it, or fix fewer nodes",
        patch.name, patch.node, placeText(problem.mesh.nodes[patch.node]), problem.fixed.size());
  for (const std::int32_t node : patch.nodes)
    if (contains(problem.fixed, node))
      throw badInput("active \"{}\": node {} of its patch is fixed", patch.name, node);
  if (patch.weights.empty() && problem.fixed.size() + patch.nodes.size() == n_nodes)
    throw badInput(
        "active \"{}\": its patch of {} nodes and the {} fixed nodes are the whole body: "
        "nothing is left to solve for; make radius smaller",
        patch.name, patch.nodes.size(), problem.fixed.size());
  refuseSqueezed(problem, patch);
}

/// Error unless problem and scene agree on the probe, and the lattice can hold its displacement.
void checkProbe(const Problem& problem, std::size_t number) {
  const auto& probe = problem.active[number].probe;
  if (probe != problem.scene.active[number].probe)
    throw badInput("active \"{}\": its probe differs from that of the scene",
                   problem.active[number].name);
  const Workspace& workspace = problem.scene.workspace;
  const double least = 2 * workspace.spacing / lattice_divisions;
  if (probe && !(probe->norm() >= least && probe->norm() <= workspace.radius))
    throw badInput(
        "active \"{}\": probe = {} is outside the workspace, {:.4g} to {:.4g} m from rest",
        problem.active[number].name, placeText(*probe), least, workspace.radius);
}

void checkActive(const Problem& problem, std::size_t i, const NodeSet& surface) {
  if (problem.active[i].name != problem.scene.active[i].name)
    throw badInput("patch {} is \"{}\" instead of the scene's \"{}\"", i, problem.active[i].name,
                   problem.scene.active[i].name);
  checkPatch(problem, i, surface);
  checkProbe(problem, i);
  if (i > 0 && problem.active[i - 1].probe && !problem.active[i].probe)
    throw badInput("active \"{}\" comes after a probe place, but probe places must be last",
                   problem.active[i].name);
}

void checkWorkspace(const Problem& problem) {
  const double radius = problem.scene.workspace.radius,
               diagonal = boundingBox(problem.mesh).diagonal().norm();
  Lattice::check(radius, problem.scene.workspace.spacing);
  if (radius > 3 * diagonal)
    throw badInput(
        "workspace.radius = {:.4g} m is more than 3 times the diagonal of the mesh's bounding box "
        "({:.4g} m); is it given in length_unit?",
        radius, diagonal);
}

/// Refuses a mesh file that does not exist or has another format. Done here, because the mesh
/// reader cannot name the scene file and the key in its error.
void refuseOtherMeshes(const Scene& scene) {
  std::error_code ignored;
  if (!std::filesystem::exists(scene.mesh, ignored))
    throw badInput("mesh = \"{}\": there is no such file", scene.mesh.string());
  if (scene.mesh.extension() != ".msh")
    throw badInput(
        "mesh = \"{}\": a scene needs a Gmsh .msh file; make one with: palpate mesh {} -o {}, and "
        "name it here",
        scene.mesh.string(), shellWord(scene.mesh.string()),
        shellWord(std::filesystem::path(scene.mesh).replace_extension(".msh").string()));
}

/// Returns the error with the scene file and, if known, the line in front of its message.
Error inScene(const std::filesystem::path& scene_file, const Error& error) {
  const auto* const of_line = dynamic_cast<const SceneError*>(&error);
  const std::string line =
      of_line != nullptr && of_line->line() > 0 ? fmt::format(":{}", of_line->line()) : "";
  return {error.exitCode(), fmt::format("{}{}: {}", scene_file.string(), line, error.what())};
}

}  // namespace

void checkProblem(const Problem& problem) {
  const Scene& scene = problem.scene;
  atLine(scene.fixed.lines.table, [&] { checkFixed(problem); });
  checkRegions(problem);
  const NodeSet surface = surfaceNodes(problem.mesh);
  if (problem.active.size() != scene.active.size())
    throw badInput("there are {} patches for the {} active nodes of the scene",
                   problem.active.size(), scene.active.size());
  for (std::size_t i = 0; i < problem.active.size(); ++i)
    atLine(scene.active[i].lines.of("name"), [&] { checkActive(problem, i, surface); });
  refuseLoosePieces(problem);
  atLine(scene.workspace.lines.of("radius"), [&] { checkWorkspace(problem); });
}

PressureSlots pressureSlots(const Problem& problem) {
  return {problem.scene.discretization.pressure, problem.mesh,
          mapped(problem.scene.regions, &Region::material), problem.region_of};
}

std::size_t fieldsBytes(const Problem& problem) {
  return sizeof(float) * (3 * problem.mesh.nodes.size() + problem.pressures.count());
}

std::vector<std::int32_t> storedNodes(const Scene& scene, const Mesh& mesh) {
  return scene.storage.displacement == StoredNodes::surface ? surfaceNodes(mesh) : allNodes(mesh);
}

std::size_t storedPressures(const Problem& problem) {
  if (problem.scene.storage.displacement == StoredNodes::surface) return 0;
  return problem.pressures.count();
}

std::size_t storedBytes(const Problem& problem) {
  const bool integers = problem.scene.storage.precision == StoredPrecision::int16;
  const std::size_t component = integers ? sizeof(std::int16_t) : sizeof(float);
  return 3 * component * storedNodes(problem.scene, problem.mesh).size() +
         sizeof(float) * storedPressures(problem);
}

Lattice uniformLattice(const Scene& scene, const ActivePatch& patch) {
  const Workspace& workspace = scene.workspace;
  if (patch.probe) return Lattice::ofRest(workspace.radius, workspace.spacing, lattice_divisions);
  const bool divided = scene.accuracy.adaptive() || scene.accuracy.probes > 0 ||
                       std::ranges::any_of(scene.active, &ActiveSelection::isProbe);
  return {workspace.radius, workspace.spacing, divided ? lattice_divisions : 1,
          patch.finger ? patch.finger->reach : PushedPart{}};
}

std::int32_t probesIn(const Scene& scene, std::size_t space) {
  PALPATE_ASSERT(space < scene.active.size(), "the active node must exist in the scene");
  const ActiveSelection& active = scene.active[space];
  if (active.isProbe()) return 1;
  const auto measures = [&](const ActiveSelection& other) {
    return other.isProbe() && other.probe_of == active.area;
  };
  return std::ranges::any_of(scene.active, measures) ? 0 : scene.accuracy.probes;
}

Problem resolve(Scene scene, Mesh mesh) {
  atLine(scene.lines.of("mesh"), [&] { refuseMistakenUnit(mesh, scene.metres_per_unit); });
  // Add mid-edge nodes before selectors are resolved, because these also select mid-edge nodes.
  if (scene.discretization.displacement == DisplacementSpace::p2) addMidEdgeNodes(mesh);
  Problem problem;
  problem.region_of = selectRegions(scene.regions, mesh);
  problem.fibers = selectFibers(scene.regions, problem.region_of, mesh);
  problem.fixed = selectFixed(scene.fixed, mesh);
  scene.active = expandSurfaces(scene, mesh, problem.fixed);
  problem.active.resize(scene.active.size());
  inParallel(scene.active.size(), [&](std::size_t n) {
    const ActiveSelection& active = scene.active[n];
    ActivePatch& patch = problem.active[n];
    patch =
        atLine(active.lines.of("name"), [&] { return selectPatch(active, mesh, problem.fixed); });
    if (patch.finger && scene.contact == ContactMode::unilateral)
      patch.finger->reach = pushedAround(mesh, *patch.finger);
  });
  PALPATE_ASSERT(
      std::ranges::none_of(
          scene.active, [](const ActiveSelection& active) { return active.surface.has_value(); }),
      "areas must be split into sites");
  problem.scene = std::move(scene);
  problem.mesh = std::move(mesh);
  checkProblem(problem);
  problem.pressures = pressureSlots(problem);
  return problem;
}

Problem loadProblem(const std::filesystem::path& scene_file) {
  Scene scene = readScene(scene_file);
  try {
    atLine(scene.lines.of("mesh"), [&] { refuseOtherMeshes(scene); });
  } catch (const Error& error) {
    throw inScene(scene_file, error);
  }
  Mesh mesh = readGmsh(scene.mesh, scene.metres_per_unit);
  try {
    return resolve(std::move(scene), std::move(mesh));
  } catch (const Error& error) {
    throw inScene(scene_file, error);
  }
}

}  // namespace palpate
