#include "common/mesh/mesh_text.hpp"

#include <fmt/format.h>

#include <iterator>

#include "common/base/number_text.hpp"
#include "common/base/text.hpp"

namespace palpate {
namespace {

std::string tetrahedraText(std::size_t count) {
  return counted(count, "tetrahedron", "tetrahedra");
}

}  // namespace

std::string meshText(const Mesh& mesh, const MeshQuality& quality, const std::string& name) {
  std::string text;
  const auto out = std::back_inserter(text);
  const std::string middles =
      mesh.edges.empty() ? "" : " and " + counted(mesh.edges.size(), "mid-edge node");
  fmt::format_to(out, "mesh       {}: {}{}, {}, {} with {}, {}\n", name,
                 counted(mesh.vertices(), "node"), middles, tetrahedraText(mesh.tetrahedra.size()),
                 counted(mesh.surface.size(), "surface triangle"),
                 counted(surfaceNodes(mesh).size(), "node"), counted(quality.pieces, "piece"));
  fmt::format_to(out, "           from {} to {} m, {:.4g} litres\n", placeText(quality.lowest, 4),
                 placeText(quality.highest, 4), 1000 * quality.volume);
  fmt::format_to(
      out,
      "           edges {:.4g} to {:.4g} m, mean {:.4g}; shape (1 regular, 0 flat) mean {:.3g}, "
      "worst {:.3g} in element {}\n",
      quality.shortest_edge, quality.longest_edge, quality.mean_edge, quality.mean_shape,
      quality.worst_shape, quality.worst_element);
  if (mesh.dropped_nodes > 0)
    fmt::format_to(out,
                   "           note: {} without a tetrahedron dropped; later nodes renumbered\n",
                   counted(mesh.dropped_nodes, "node"));
  if (mesh.reoriented_tetrahedra > 0)
    fmt::format_to(out, "           note: {} had negative volume; two nodes of each were swapped\n",
                   tetrahedraText(mesh.reoriented_tetrahedra));
  for (const auto& [group, nodes] : mesh.node_groups)
    fmt::format_to(out, "group      \"{}\": {}\n", group, counted(nodes.size(), "node"));
  for (const auto& [group, elements] : mesh.element_groups)
    fmt::format_to(out, "group      \"{}\": {}\n", group, tetrahedraText(elements.size()));
  return text;
}

std::vector<std::string> unjoinedText(const Mesh& mesh, const MeshQuality& quality,
                                      const std::string& file) {
  std::vector<std::string> text;
  if (!quality.coincident.empty()) {
    const auto& [node, other] = quality.coincident.front();
    text.push_back(fmt::format(
        "coincident nodes: {}, the first is node {} on node {} at {}: the parts that meet there "
        "are not joined and pass through each other; unless this is a cut, merge the nodes: "
        "palpate mesh {} --weld -o NEW.msh",
        quality.coincident.size(), node, other, placeText(mesh.nodes[node], 4), shellWord(file)));
  }
  if (!quality.hinges.empty())
    text.push_back(fmt::format(
        "the {} of the body meet without a common face in {}, the first is node {} at {}: the "
        "pieces turn there as on hinges; join them by faces",
        counted(quality.pieces, "piece"), counted(quality.hinges.size(), "node"),
        quality.hinges.front(), placeText(mesh.nodes[quality.hinges.front()], 4)));
  return text;
}

}  // namespace palpate
