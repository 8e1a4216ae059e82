// Encodes a problem as bytes and computes its id.

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>

#include <algorithm>
#include <bit>
#include <limits>

#include "common/base/error.hpp"
#include "common/problem/problem.hpp"
#include "proto/palpate.pb.h"

namespace palpate {
namespace {

static_assert(std::endian::native == std::endian::little, "messages are little-endian");

template <class Array>
std::string bytesOfArray(const Array& values) {
  return std::string(bytesOf(std::span(values)));
}

template <class T>
std::vector<T> arrayFrom(const std::string& bytes, const char* what) {
  if (bytes.size() % sizeof(T) != 0)
    throw badInput("{} have {} bytes, not a multiple of {}", what, bytes.size(), sizeof(T));
  std::vector<T> values(bytes.size() / sizeof(T));
  // Do not use memcpy, which must not get the null pointer of an empty array.
  std::ranges::copy(bytes, reinterpret_cast<char*>(values.data()));
  return values;
}

static_assert(sizeof(Eigen::Vector3d) == 3 * sizeof(double) &&
              sizeof(Tetrahedron) == 4 * sizeof(std::int32_t));

wire::Problem toMessage(const Problem& problem) {
  wire::Problem message;
  message.set_scene_toml(resolvedToml(problem.scene));
  const auto n_vertices = static_cast<std::size_t>(problem.mesh.vertices());
  message.set_nodes(bytesOfArray(std::span(problem.mesh.nodes).first(n_vertices)));
  message.set_tetrahedra(bytesOfArray(problem.mesh.tetrahedra));
  message.set_fixed(bytesOfArray(problem.fixed));
  for (const ActivePatch& patch : problem.active) {
    wire::ActivePatch& active = *message.add_active();
    active.set_name(patch.name);
    active.set_node(patch.node);
    active.set_nodes(bytesOfArray(patch.nodes));
    active.set_weights(bytesOfArray(patch.weights));
    if (patch.finger) {
      active.set_finger_center(bytesOfArray(std::span(&patch.finger->center, 1)));
      active.set_finger_radius(patch.finger->radius);
      active.set_finger_outward(bytesOfArray(std::span(&patch.finger->reach.outward, 1)));
      active.set_finger_pull(patch.finger->reach.pull);
      active.set_finger_width(patch.finger->reach.width);
    }
    if (patch.probe) active.set_probe(bytesOfArray(std::span(&*patch.probe, 1)));
  }
  for (const auto& [name, nodes] : problem.mesh.node_groups) {
    wire::NodeGroup& group = *message.add_node_groups();
    group.set_name(name);
    // Leave out mid-edge nodes, which come last: the decoder computes them from the vertices.
    const auto end = std::lower_bound(nodes.begin(), nodes.end(), problem.mesh.vertices());
    group.set_nodes(bytesOfArray(std::span(nodes.begin(), end)));
  }
  // Leave region_of out for bodies of one material: they keep their ids from before regions
  // existed.
  if (problem.scene.regions.size() > 1) message.set_region_of(bytesOfArray(problem.region_of));
  message.set_fibers(bytesOfArray(problem.fibers));
  return message;
}

std::optional<Finger> fingerFrom(const wire::ActivePatch& message) {
  const auto center = arrayFrom<Eigen::Vector3d>(message.finger_center(), "the place of a finger");
  if (center.empty()) return std::nullopt;
  const auto outward =
      arrayFrom<Eigen::Vector3d>(message.finger_outward(), "the reach of a finger");
  if (center.size() != 1 || outward.size() != 1)
    throw badInput("a finger has {} places and {} directions", center.size(), outward.size());
  return Finger{center.front(),
                message.finger_radius(),
                {outward.front(), message.finger_pull(), message.finger_width()}};
}

std::optional<Eigen::Vector3d> probeFrom(const wire::ActivePatch& message) {
  const auto probe = arrayFrom<Eigen::Vector3d>(message.probe(), "the displacement of a probe");
  if (probe.size() > 1) throw badInput("a finger has {} probes", probe.size());
  return probe.empty() ? std::nullopt : std::optional(probe.front());
}

Problem fromMessage(const wire::Problem& message) {
  Problem problem;
  problem.scene = parseScene(message.scene_toml(), "its scene");
  problem.mesh.nodes = arrayFrom<Eigen::Vector3d>(message.nodes(), "its nodes");
  problem.mesh.tetrahedra = arrayFrom<Tetrahedron>(message.tetrahedra(), "its tetrahedra");
  for (const wire::NodeGroup& group : message.node_groups())
    problem.mesh.node_groups[group.name()] =
        arrayFrom<std::int32_t>(group.nodes(), "the nodes of a group");
  finishMesh(problem.mesh, "its mesh");
  if (problem.mesh.dropped_nodes != 0 || problem.mesh.reoriented_tetrahedra != 0)
    throw badInput("its mesh has orphan nodes or inverted elements");
  problem.fixed = arrayFrom<std::int32_t>(message.fixed(), "its fixed nodes");
  if (problem.scene.discretization.displacement == DisplacementSpace::p2)
    addMidEdgeNodes(problem.mesh);
  problem.region_of = arrayFrom<std::uint16_t>(message.region_of(), "its regions");
  if (problem.scene.regions.size() == 1 && problem.region_of.empty())
    problem.region_of.assign(problem.mesh.tetrahedra.size(), 0);
  problem.fibers = arrayFrom<std::array<Eigen::Vector3d, 2>>(message.fibers(), "its fibres");
  for (const wire::ActivePatch& active : message.active())
    problem.active.push_back({active.name(), active.node(),
                              arrayFrom<std::int32_t>(active.nodes(), "the nodes of a patch"),
                              arrayFrom<double>(active.weights(), "the weights of a patch"),
                              fingerFrom(active), probeFrom(active)});
  return problem;
}

}  // namespace

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
    throw failure("a problem description of {} bytes is damaged: it is not a Protobuf message",
                  bytes.size());
  try {
    Problem problem = fromMessage(message);
    checkProblem(problem);
    problem.pressures = pressureSlots(problem);
    // Accept only one encoding of each problem, because equal problems must have equal ids.
    if (encodeProblem(problem) != bytes)
      throw failure("its encoding differs from that of this version of Palpate");
    return problem;
  } catch (const Error& error) {
    throw failure("a problem description of {} bytes is damaged: {}", bytes.size(), error.what());
  }
}

ContentId problemId(const Problem& problem) {
  Problem bare = problem;
  // The id does not depend on name and path. Set them to a fixed text that is not empty, because
  // the scene reader refuses empty ones.
  bare.scene.name = "any";
  bare.scene.mesh = "any";
  bare.scene.fixed = {};
  bare.scene.active = {};
  bare.scene.device.reset();
  bare.scene.storage = {};
  bare.scene.contact = {};
  bare.mesh.node_groups.clear();
  // Without refinement, only the number of probes in [accuracy] has an effect.
  if (!bare.scene.accuracy.adaptive()) bare.scene.accuracy = {.probes = bare.scene.accuracy.probes};
  for (std::size_t r = 0; r < bare.scene.regions.size(); ++r) {
    Region& region = bare.scene.regions[r];
    if (!region.isRest()) region = {std::to_string(r), std::move(region.material)};
    if (!region.material.fiber_field.empty()) region.material.fiber_field = "any";
  }
  ContentHasher hasher;
  hasher.add(encodeProblem(bare));
  // Change the id of bodies with pressures that jump between materials. Earlier versions solved
  // these with one pressure per node, which gave other configurations.
  if (problem.pressures.count() > problem.pressures.nodes())
    hasher.add("pressures jump between materials");
  return hasher.finish();
}

}  // namespace palpate
