#include "common/problem/body_regions.hpp"

#include <algorithm>
#include <limits>

#include "common/base/error.hpp"
#include "common/base/nearest_word.hpp"

namespace palpate {
namespace {

constexpr std::uint16_t nowhere = std::numeric_limits<std::uint16_t>::max();

/// "; the mesh has a, b and c", or that it has none.
template <class Named>
std::string thereAre(const Named& named, const char* what) {
  std::vector<std::string_view> names;
  for (const auto& [name, values] : named) names.push_back(name);
  return names.empty() ? fmt::format("the mesh has no {}", what)
                       : fmt::format("the mesh has {}", listed(names));
}

const std::vector<std::int32_t>& tetrahedraOf(const std::string& group, const Mesh& mesh) {
  const auto found = mesh.element_groups.find(group);
  if (found == mesh.element_groups.end())
    throw badInput("region.group: there is no \"{}\" of volume elements; {}", group,
                   thereAre(mesh.element_groups, "physical groups of volumes"));
  if (found->second.empty()) throw badInput("region.group: \"{}\" has no tetrahedron", group);
  return found->second;
}

/// The vectors that a material takes its fibre from; null when it has fixed ones, or none.
const std::vector<Eigen::Vector3d>* fieldOf(const Material& material, const Mesh& mesh) {
  if (material.fiber_field.empty()) return nullptr;
  const auto found = mesh.element_vectors.find(material.fiber_field);
  if (found == mesh.element_vectors.end())
    throw badInput("material.fiber: there are no element vectors \"{}\"; {}", material.fiber_field,
                   thereAre(mesh.element_vectors, "vectors of elements"));
  return &found->second;
}

}  // namespace

std::vector<std::uint16_t> selectRegions(const std::vector<Region>& regions, const Mesh& mesh) {
  const bool has_rest = regions.front().group.empty();
  std::vector<std::uint16_t> region_of(mesh.tetrahedra.size(), nowhere);
  for (std::size_t r = has_rest ? 1 : 0; r < regions.size(); ++r)
    for (const std::int32_t element : tetrahedraOf(regions[r].group, mesh)) {
      if (region_of[element] != nowhere)
        throw badInput(
            "region.group: {} is in \"{}\" and in \"{}\"; a tetrahedron has one material",
            placeOf(mesh, element), regions[region_of[element]].group, regions[r].group);
      region_of[element] = static_cast<std::uint16_t>(r);
    }
  // [material] takes what no group names; without one every tetrahedron must be named.
  const auto rest = std::ranges::find(region_of, nowhere);
  if (rest == region_of.end() && has_rest)
    throw badInput(
        "[material]: the regions are the whole body and leave no tetrahedron for it; remove it");
  if (rest != region_of.end() && !has_rest)
    throw badInput("[[region]]: {} is in none; write a [material] for what no region names",
                   placeOf(mesh, rest - region_of.begin()));
  std::ranges::replace(region_of, nowhere, std::uint16_t{0});
  return region_of;
}

bool hasFibers(const std::vector<Region>& regions) {
  return std::ranges::any_of(regions, [](const Region& region) {
    return !region.material.fibers.empty() || !region.material.fiber_field.empty();
  });
}

std::vector<std::array<Eigen::Vector3d, 2>> selectFibers(
    const std::vector<Region>& regions, const std::vector<std::uint16_t>& region_of,
    const Mesh& mesh) {
  if (!hasFibers(regions)) return {};
  std::vector<const std::vector<Eigen::Vector3d>*> fields;
  for (const Region& region : regions) fields.push_back(fieldOf(region.material, mesh));
  std::vector<std::array<Eigen::Vector3d, 2>> fibers(
      region_of.size(), {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()});
  for (std::size_t e = 0; e < region_of.size(); ++e) {
    const Material& material = regions[region_of[e]].material;
    if (const auto* field = fields[region_of[e]]) {
      if ((*field)[e].isZero(0))
        throw badInput("material.fiber: \"{}\" is zero, or missing, in {}", material.fiber_field,
                       placeOf(mesh, e));
      fibers[e][0] = (*field)[e].stableNormalized();
    }
    std::ranges::copy(material.fibers, fibers[e].begin());
  }
  return fibers;
}

}  // namespace palpate
