#include "common/problem.hpp"

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <span>

#include "common/error.hpp"
#include "common/gmsh_reader.hpp"
#include "common/lattice.hpp"
#include "common/nearest_word.hpp"
#include "proto/palpate.pb.h"

namespace palpate {
namespace {

static_assert(std::endian::native == std::endian::little, "arrays travel as they are in memory");

/// Extents between which a body is taken for meant, and that of an organ, metres.
constexpr double smallest_body = 1e-3, largest_body = 10, usual_body = 0.2;
/// Round-off in the coordinates must not decide whether a node exactly on a sphere is within it.
constexpr double on_the_sphere = 1 + 1e-12;

using Nodes = std::vector<std::int32_t>;

Eigen::AlignedBox3d boundingBox(const Mesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& node : mesh.nodes) box.extend(node);
  return box;
}

std::string text(const Eigen::Vector3d& v) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", v[0], v[1], v[2]);
}

bool contains(const Nodes& sorted, std::int32_t node) {
  return std::binary_search(sorted.begin(), sorted.end(), node);
}

void sortUnique(Nodes& nodes) {
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
}

void refuseMistakenUnit(const Mesh& mesh, double metres_per_unit) {
  const double size = boundingBox(mesh).sizes().maxCoeff();
  if (size >= smallest_body && size <= largest_body) return;
  struct Unit {
    const char* word;
    const char* meaning;
    double metres;
  };
  constexpr Unit units[] = {{"m", "metres", 1}, {"cm", "centimetres", 0.01}, {"mm", "millimetres", 0.001}};
  const auto used = std::min_element(std::begin(units), std::end(units), [&](const Unit& a, const Unit& b) {
    return std::abs(a.metres - metres_per_unit) < std::abs(b.metres - metres_per_unit);
  });
  const auto strangeness = [&](const Unit& unit) {
    return std::abs(std::log(size / used->metres * unit.metres / usual_body));
  };
  const auto best = std::min_element(std::begin(units), std::end(units), [&](const Unit& a, const Unit& b) {
    return strangeness(a) < strangeness(b);
  });
  const double best_size = size / used->metres * best->metres;
  const std::string finding =
      fmt::format("the mesh is {:.4g} m {}", size, size > largest_body ? "wide" : "wide only");
  if (best == used || best_size < smallest_body || best_size > largest_body)
    throw badInput("{}, and no length_unit (m, cm, mm) makes it a body of 1 mm to 10 m: scale the mesh",
                   finding);
  throw badInput(
      "{}: its numbers look like {} taken for {}; write length_unit = \"{}\" in the scene (then it is {:.4g} "
      "m, and the scene's own lengths are in {} too)",
      finding, best->meaning, used->meaning, best->word, best_size, best->word);
}

/// Adds the nodes for which `inside` holds; Error when there are none.
template <class Inside>
void select(Nodes& fixed, const Mesh& mesh, const std::string& key, Inside inside) {
  const std::size_t before = fixed.size();
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
    if (inside(mesh.nodes[n])) fixed.push_back(static_cast<std::int32_t>(n));
  if (fixed.size() > before) return;
  const Eigen::AlignedBox3d box = boundingBox(mesh);
  throw badInput("fixed.{} selects no node; the mesh reaches from {} to {} m", key, text(box.min()),
                 text(box.max()));
}

void selectHalfSpace(Nodes& fixed, const Mesh& mesh, const HalfSpace& half) {
  const Eigen::AlignedBox3d box = boundingBox(mesh);
  const int axis = half.axis;
  const double extent = box.sizes()[axis];
  const double plane = half.at      ? *half.at
                       : half.below ? box.min()[axis] + *half.fraction * extent
                                    : box.max()[axis] - *half.fraction * extent;
  select(fixed, mesh, half.below ? "below" : "above",
         [&](const Eigen::Vector3d& x) { return half.below ? x[axis] < plane : x[axis] > plane; });
}

const Nodes& groupNamed(const Mesh& mesh, const std::string& name) {
  const auto found = mesh.node_groups.find(name);
  if (found != mesh.node_groups.end()) {
    if (found->second.empty())
      throw badInput("fixed.group: no node of \"{}\" belongs to a tetrahedron", name);
    return found->second;
  }
  std::vector<std::string_view> names;
  for (const auto& [group, nodes] : mesh.node_groups) names.push_back(group);
  if (names.empty()) throw badInput("fixed.group: there is no \"{}\": the mesh has no physical groups", name);
  throw badInput("fixed.group: there is no \"{}\"; the mesh has {}", name, listed(names));
}

Nodes selectFixed(const FixedSelection& selection, const Mesh& mesh) {
  Nodes fixed;
  for (const HalfSpace& half : selection.half_spaces) selectHalfSpace(fixed, mesh, half);
  for (const Box& box : selection.boxes)
    select(fixed, mesh, "box", [&](const Eigen::Vector3d& x) {
      return (x.array() >= box.lowest.array()).all() && (x.array() <= box.highest.array()).all();
    });
  for (const Sphere& sphere : selection.spheres)
    select(fixed, mesh, "sphere", [&](const Eigen::Vector3d& x) {
      return (x - sphere.center).squaredNorm() <= sphere.radius * sphere.radius * on_the_sphere;
    });
  for (const std::string& group : selection.groups) {
    const Nodes& nodes = groupNamed(mesh, group);
    fixed.insert(fixed.end(), nodes.begin(), nodes.end());
  }
  for (const std::int32_t node : selection.nodes) {
    if (node >= static_cast<std::int32_t>(mesh.nodes.size()))
      throw badInput("fixed.nodes: there is no node {}; the mesh has nodes 0 to {}", node,
                     mesh.nodes.size() - 1);
    fixed.push_back(node);
  }
  sortUnique(fixed);
  return fixed;
}

std::int32_t nearestOf(const Nodes& candidates, const Mesh& mesh, const Eigen::Vector3d& x) {
  const auto distance = [&](std::int32_t n) { return (mesh.nodes[n] - x).squaredNorm(); };
  return *std::min_element(candidates.begin(), candidates.end(),
                           [&](std::int32_t a, std::int32_t b) { return distance(a) < distance(b); });
}

std::int32_t selectActiveNode(const ActiveSelection& selection, const Mesh& mesh, const Nodes& surface) {
  if (selection.near) {
    const std::int32_t node = nearestOf(surface, mesh, *selection.near);
    const double distance = (mesh.nodes[node] - *selection.near).norm();
    if (distance > boundingBox(mesh).diagonal().norm())
      throw badInput(
          "active \"{}\": near = {} is {:.4g} m away from the nearest surface node, more than the body is "
          "wide; is its unit that of length_unit?",
          selection.name, text(*selection.near), distance);
    return node;
  }
  const std::int32_t node = *selection.node;
  if (node >= static_cast<std::int32_t>(mesh.nodes.size()))
    throw badInput("active \"{}\": there is no node {}; the mesh has nodes 0 to {}", selection.name, node,
                   mesh.nodes.size() - 1);
  if (!contains(surface, node))
    throw badInput("active \"{}\": node {} at {} is inside the body; the nearest surface node is {}",
                   selection.name, node, text(mesh.nodes[node]), nearestOf(surface, mesh, mesh.nodes[node]));
  return node;
}

ActivePatch selectPatch(const ActiveSelection& selection, const Mesh& mesh, const Nodes& surface,
                        const Nodes& fixed) {
  ActivePatch patch;
  patch.name = selection.name;
  patch.node = selectActiveNode(selection, mesh, surface);
  const Eigen::Vector3d& center = mesh.nodes[patch.node];
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    const auto node = static_cast<std::int32_t>(n);
    const bool within =
        (mesh.nodes[n] - center).squaredNorm() <= selection.radius * selection.radius * on_the_sphere;
    if (node == patch.node || (within && !contains(fixed, node))) patch.nodes.push_back(node);
  }
  return patch;
}

/// True when the nodes lie on one line, so that the body can turn around it.
bool onOneLine(const Nodes& nodes, const Mesh& mesh, double size) {
  const Eigen::Vector3d& a = mesh.nodes[nodes.front()];
  const auto distance = [&](std::int32_t n) { return (mesh.nodes[n] - a).norm(); };
  const std::int32_t far = *std::max_element(
      nodes.begin(), nodes.end(), [&](std::int32_t m, std::int32_t n) { return distance(m) < distance(n); });
  const Eigen::Vector3d along = (mesh.nodes[far] - a).stableNormalized();
  return std::all_of(nodes.begin(), nodes.end(),
                     [&](std::int32_t n) { return (mesh.nodes[n] - a).cross(along).norm() <= 1e-6 * size; });
}

void refuseLoosePieces(const Problem& problem) {
  const Mesh& mesh = problem.mesh;
  const std::vector<std::int32_t> piece_of = pieceOfNode(mesh);
  std::vector<Nodes> all(*std::max_element(piece_of.begin(), piece_of.end()) + 1), held(all.size());
  for (std::size_t n = 0; n < piece_of.size(); ++n) all[piece_of[n]].push_back(static_cast<std::int32_t>(n));
  for (const std::int32_t node : problem.fixed) held[piece_of[node]].push_back(node);
  const double size = boundingBox(mesh).diagonal().norm();
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (held[i].empty())
      throw badInput(
          "the mesh consists of {} pieces that share no node, and the one of {} nodes around node {} at {} "
          "has no fixed node: nothing holds it (merge coincident nodes, remove the piece, or fix it)",
          all.size(), all[i].size(), all[i].front(), text(mesh.nodes[all[i].front()]));
    if (onOneLine(held[i], mesh, size))
      throw badInput(
          "[fixed] holds {} node(s) on one line (node {} at {}): the body can turn around it; fix at least "
          "three nodes that are not on a line",
          held[i].size(), held[i].front(), text(mesh.nodes[held[i].front()]));
  }
}

/// Nodes that are there, sorted, each once.
bool isNodeSet(const Nodes& nodes, std::size_t n_nodes) {
  return std::adjacent_find(nodes.begin(), nodes.end(), std::greater_equal<>()) == nodes.end() &&
         (nodes.empty() || (nodes.front() >= 0 && static_cast<std::size_t>(nodes.back()) < n_nodes));
}

void checkFixed(const Problem& problem) {
  const std::size_t n_nodes = problem.mesh.nodes.size();
  if (problem.fixed.empty()) throw badInput("[fixed] selects no node: the body would fly away");
  if (!isNodeSet(problem.fixed, n_nodes))
    throw badInput("the fixed nodes are not a sorted set of nodes of the mesh");
  if (problem.fixed.size() == n_nodes)
    throw badInput("[fixed] selects all {} nodes: nothing is left to move", n_nodes);
}

void checkPatch(const Problem& problem, const ActivePatch& patch, const Nodes& surface) {
  const std::size_t n_nodes = problem.mesh.nodes.size();
  if (!isNodeSet(patch.nodes, n_nodes) || !contains(patch.nodes, patch.node) ||
      !contains(surface, patch.node))
    throw badInput("active \"{}\": its nodes are not a sorted set of nodes around a surface node",
                   patch.name);
  if (contains(problem.fixed, patch.node))
    throw badInput("active \"{}\": node {} at {} is one of the {} fixed nodes; move it, or fix less",
                   patch.name, patch.node, text(problem.mesh.nodes[patch.node]), problem.fixed.size());
  for (const std::int32_t node : patch.nodes)
    if (contains(problem.fixed, node))
      throw badInput("active \"{}\": node {} of its patch is fixed", patch.name, node);
  if (problem.fixed.size() + patch.nodes.size() == n_nodes)
    throw badInput(
        "active \"{}\": its patch of {} nodes and the {} fixed nodes are the whole body: nothing is left to "
        "solve for; make radius smaller",
        patch.name, patch.nodes.size(), problem.fixed.size());
}

/// Everything that must hold of a problem's numbers, wherever it came from.
void check(const Problem& problem) {
  checkFixed(problem);
  const Nodes surface = surfaceNodes(problem.mesh);
  if (problem.active.size() != problem.scene.active.size())
    throw badInput("{} patches for the {} active nodes of the scene", problem.active.size(),
                   problem.scene.active.size());
  for (std::size_t i = 0; i < problem.active.size(); ++i) {
    if (problem.active[i].name != problem.scene.active[i].name)
      throw badInput("patch {} is \"{}\" instead of the scene's \"{}\"", i, problem.active[i].name,
                     problem.scene.active[i].name);
    checkPatch(problem, problem.active[i], surface);
  }
  refuseLoosePieces(problem);
  Lattice::check(problem.scene.workspace.radius, problem.scene.workspace.spacing);
  const double radius = problem.scene.workspace.radius,
               diagonal = boundingBox(problem.mesh).diagonal().norm();
  if (radius > 3 * diagonal)
    throw badInput(
        "workspace.radius = {:.4g} m is more than 3 times the diagonal of the mesh's bounding box ({:.4g} "
        "m); is its unit that of length_unit?",
        radius, diagonal);
}

template <class T>
std::string bytesOfArray(const std::vector<T>& values) {
  return std::string(bytesOf(std::span<const T>(values)));
}

template <class T>
std::vector<T> arrayFrom(const std::string& bytes, const char* what) {
  if (bytes.size() % sizeof(T) != 0)
    throw badInput("{} have {} bytes, not a multiple of {}", what, bytes.size(), sizeof(T));
  std::vector<T> values(bytes.size() / sizeof(T));
  std::memcpy(static_cast<void*>(values.data()), bytes.data(), bytes.size());
  return values;
}

static_assert(sizeof(Eigen::Vector3d) == 3 * sizeof(double) &&
              sizeof(Tetrahedron) == 4 * sizeof(std::int32_t));

wire::Problem toMessage(const Problem& problem) {
  wire::Problem message;
  message.set_scene_toml(resolvedToml(problem.scene));
  message.set_nodes(bytesOfArray(problem.mesh.nodes));
  message.set_tetrahedra(bytesOfArray(problem.mesh.tetrahedra));
  message.set_fixed(bytesOfArray(problem.fixed));
  for (const ActivePatch& patch : problem.active) {
    wire::ActivePatch& active = *message.add_active();
    active.set_name(patch.name);
    active.set_node(patch.node);
    active.set_nodes(bytesOfArray(patch.nodes));
  }
  for (const auto& [name, nodes] : problem.mesh.node_groups) {
    wire::NodeGroup& group = *message.add_node_groups();
    group.set_name(name);
    group.set_nodes(bytesOfArray(nodes));
  }
  return message;
}

Problem fromMessage(const wire::Problem& message) {
  Problem problem;
  problem.scene = parseScene(message.scene_toml(), "its scene");
  problem.mesh.nodes = arrayFrom<Eigen::Vector3d>(message.nodes(), "its nodes");
  problem.mesh.tetrahedra = arrayFrom<Tetrahedron>(message.tetrahedra(), "its tetrahedra");
  for (const wire::NodeGroup& group : message.node_groups())
    problem.mesh.node_groups[group.name()] = arrayFrom<std::int32_t>(group.nodes(), "the nodes of a group");
  finishMesh(problem.mesh, "its mesh");
  if (problem.mesh.dropped_nodes != 0 || problem.mesh.reoriented_tetrahedra != 0)
    throw badInput("its mesh has orphan nodes or inverted elements");
  problem.fixed = arrayFrom<std::int32_t>(message.fixed(), "its fixed nodes");
  problem.region_of.assign(problem.mesh.tetrahedra.size(), 0);
  for (const wire::ActivePatch& active : message.active())
    problem.active.push_back(
        {active.name(), active.node(), arrayFrom<std::int32_t>(active.nodes(), "the nodes of a patch"), {}});
  return problem;
}

Mesh readMesh(const Scene& scene) {
  if (scene.mesh.extension() == ".msh") return readGmsh(scene.mesh, scene.metres_per_unit);
  throw badInput("mesh {}: its format is not read; there is Gmsh .msh, version 2.2 or 4.1",
                 scene.mesh.string());
}

}  // namespace

std::size_t pressureNodes(const Problem& problem) {
  switch (problem.scene.discretization.pressure) {
    case PressureSpace::none:
      return 0;
    case PressureSpace::p1:
    case PressureSpace::p1_stabilized:
      return static_cast<std::size_t>(problem.mesh.vertices());
    case PressureSpace::p2:
      return problem.mesh.nodes.size();
  }
  return 0;
}

Problem resolve(Scene scene, Mesh mesh) {
  refuseMistakenUnit(mesh, scene.metres_per_unit);
  Problem problem;
  problem.fixed = selectFixed(scene.fixed, mesh);
  const Nodes surface = surfaceNodes(mesh);
  for (const ActiveSelection& active : scene.active)
    problem.active.push_back(selectPatch(active, mesh, surface, problem.fixed));
  problem.region_of.assign(mesh.tetrahedra.size(), 0);
  problem.scene = std::move(scene);
  problem.mesh = std::move(mesh);
  check(problem);
  return problem;
}

Problem loadProblem(const std::filesystem::path& scene_file) {
  Scene scene = readScene(scene_file);
  Mesh mesh = readMesh(scene);
  try {
    return resolve(std::move(scene), std::move(mesh));
  } catch (const Error& error) {
    throw Error(error.exitCode(), fmt::format("{}: {}", scene_file.string(), error.what()));
  }
}

std::string encodeProblem(const Problem& problem) {
  const wire::Problem message = toMessage(problem);
  std::string bytes;
  {
    google::protobuf::io::StringOutputStream stream(&bytes);
    google::protobuf::io::CodedOutputStream coded(&stream);
    coded.SetSerializationDeterministic(true);
    if (!message.SerializeToCodedStream(&coded))
      throw failure("the problem is too large for a Protobuf message (2 GB)");
  }
  return bytes;
}

Problem decodeProblem(std::string_view bytes) {
  wire::Problem message;
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()) ||
      !message.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())))
    throw failure("a problem of {} bytes is damaged: it is not a Protobuf message", bytes.size());
  try {
    Problem problem = fromMessage(message);
    check(problem);
    if (encodeProblem(problem) != bytes)
      throw failure("it is not written as this version of Palpate writes it");
    return problem;
  } catch (const Error& error) {
    throw failure("a problem of {} bytes is damaged: {}", bytes.size(), error.what());
  }
}

ContentId problemId(const Problem& problem) {
  Problem bare = problem;
  bare.scene.name = "any";
  bare.scene.mesh = "any";
  bare.scene.fixed = {};
  bare.scene.active = {};
  bare.mesh.node_groups.clear();
  return ContentId::of(encodeProblem(bare));
}

}  // namespace palpate
