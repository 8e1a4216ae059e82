#include "viewer/report/compared_properties.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "common/base/index.hpp"
#include "common/base/number_text.hpp"
#include "common/scene/material_toml.hpp"
#include "viewer/report/report_words.hpp"

namespace palpate {
namespace {

std::string namedMesh(const Dataset& dataset) {
  return dataset.scene().mesh.filename().string() + ": " + describeMesh(dataset.mesh());
}

std::string describeExtent(const Dataset& dataset) {
  const Eigen::Vector3d size = 1e3 * boundingBox(dataset.mesh()).sizes();
  return fmt::format("{:.4g} x {:.4g} x {:.4g} mm", size.x(), size.y(), size.z());
}

std::string describeDiscretization(const Dataset& dataset) {
  const Discretization& discretization = dataset.scene().discretization;
  return fmt::format("displacement {}, pressure {}", word(discretization.displacement),
                     word(discretization.pressure));
}

std::string describeGravity(const Dataset& dataset) {
  const Eigen::Vector3d& g = dataset.scene().gravity;
  return g.isZero() ? "none" : fmt::format("({}) m/s²", vectorText(g, 4));
}

std::string describeForce(const Dataset& dataset) {
  return formatNumber(std::ranges::max(mapped(dataset.spaces(), largestForce)), 3) + " N";
}

std::string materialOf(const Dataset& dataset, const std::string& group) {
  for (const Region& region : dataset.scene().regions)
    if (region.name() == group) return inWords(region.material);
  return "-";
}

}  // namespace

std::vector<ComparedProperty> comparedProperties(const std::vector<Dataset>& datasets,
                                                 const std::vector<DatasetFacts>& facts) {
  const Dataset &first = datasets[0], &second = datasets[1];
  std::vector<ComparedProperty> properties;
  const auto add = [&](const std::string& name, const auto& of) {
    properties.push_back({name, of(first), of(second)});
  };
  add("scene", [](const Dataset& dataset) { return dataset.scene().name; });
  add("mesh", namedMesh);
  add("extent", describeExtent);
  add("fixed nodes", [](const Dataset& d) { return std::to_string(d.fixedNodes().size()); });
  std::set<std::string> groups;
  for (const Dataset& dataset : datasets)
    for (const Region& region : dataset.scene().regions) groups.insert(region.name());
  for (const std::string& group : groups)
    add(group.empty() ? "material" : "material of " + group,
        [&](const Dataset& dataset) { return materialOf(dataset, group); });
  add("discretization", describeDiscretization);
  add("gravity", describeGravity);
  add("active nodes", [](const Dataset& d) { return std::to_string(d.spaces().size()); });
  add("workspace", describeBall);
  add("force limit", [](const Dataset& dataset) {
    return fmt::format("{:.3g} N", dataset.scene().workspace.max_force);
  });
  properties.push_back({"solved configurations", std::to_string(facts[0].configurations),
                        std::to_string(facts[1].configurations)});
  add("largest solved force", describeForce);
  properties.push_back({"file", formatBytes(facts[0].bytes), formatBytes(facts[1].bytes)});
  add("kernel family", [](const Dataset& dataset) { return dataset.kernelFamily(); });
  return properties;
}

}  // namespace palpate
