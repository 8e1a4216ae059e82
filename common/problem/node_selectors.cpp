#include "common/problem/node_selectors.hpp"

#include "common/base/error.hpp"
#include "common/base/nearest_word.hpp"

namespace palpate {

bool isIn(const Box& box, const Eigen::Vector3d& x) {
  return (x.array() >= box.lowest.array()).all() && (x.array() <= box.highest.array()).all();
}

bool isIn(const Sphere& sphere, const Eigen::Vector3d& x) {
  return (x - sphere.center).squaredNorm() <= sphere.radius * sphere.radius * on_the_sphere;
}

const NodeSet& groupNamed(const Mesh& mesh, const std::string& name, const std::string& key) {
  const auto found = mesh.node_groups.find(name);
  if (found != mesh.node_groups.end()) {
    if (found->second.empty())
      throw badInput("{}: no node of \"{}\" belongs to a tetrahedron", key, name);
    return found->second;
  }
  std::vector<std::string_view> names;
  for (const auto& [group, nodes] : mesh.node_groups) names.push_back(group);
  if (names.empty())
    throw badInput("{}: there is no \"{}\": the mesh has no physical groups", key, name);
  throw badInput("{}: there is no \"{}\"; the mesh has {}", key, name, listed(names));
}

}  // namespace palpate
