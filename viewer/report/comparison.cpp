#include "viewer/report/comparison.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "common/base/index.hpp"
#include "common/base/number_text.hpp"
#include "common/base/parallel.hpp"
#include "common/scene/material_toml.hpp"
#include "viewer/report/field_comparison.hpp"
#include "viewer/report/report_words.hpp"

namespace palpate {
namespace {

constexpr int ball_samples = 13;  ///< samples along one axis of the grid over the ball
constexpr std::size_t most_differences = 400;
constexpr int distance_samples = 24;  ///< number of distances from rest to the sphere

/// Spaces of the same active node in the two datasets.
using SpacePair = std::array<const SpaceTable*, 2>;

Eigen::Vector3d restPlace(const Dataset& dataset, const SpaceTable& space) {
  return space.patch.finger ? space.patch.finger->center
                            : dataset.mesh().nodes[at(space.patch.node)];
}

/// Returns whether two spaces of the same name are also at the same place. The names of an area's
/// sites are numbers, and on another body the same number can mean another place.
bool isOnePlace(const SpaceTable& a, const SpaceTable& b) {
  if (a.patch.finger.has_value() != b.patch.finger.has_value()) return false;
  return !a.patch.finger || (a.patch.finger->center - b.patch.finger->center).norm() <=
                                0.5 * std::min(a.patch.finger->radius, b.patch.finger->radius);
}

std::vector<SpacePair> commonSpaces(const Dataset& first, const Dataset& second) {
  std::vector<SpacePair> pairs;
  for (const SpaceTable& a : first.spaces())
    for (const SpaceTable& b : second.spaces())
      if (a.patch.name == b.patch.name && isOnePlace(a, b)) pairs.push_back({&a, &b});
  return pairs;
}

/// Returns the first few active nodes by name, such as "tip, edge-2 and 12 more".
std::string namesIn(const Dataset& dataset) {
  constexpr std::size_t most_names = 4;
  auto names = mapped(dataset.spaces(), [](const SpaceTable& space) { return space.patch.name; });
  const std::size_t more = names.size() - std::min(names.size(), most_names);
  names.resize(names.size() - more);
  return fmt::format("{}{}", fmt::join(names, ", "),
                     more > 0 ? fmt::format(" and {} more", more) : "");
}

using BothFields = std::array<std::unique_ptr<ForceField>, 2>;

BothFields bothFields(const Comparison& comparison, const SpacePair& pair) {
  BothFields fields;
  for (std::size_t s = 0; s < 2; ++s) {
    MadeField made = tryToMake(comparison.method, *pair[s]);
    if (!made.field)
      throw badInput(
          "{} of {} cannot be compared with method {}: {}. Build it again, or choose another "
          "method with --methods",
          pair[s]->patch.name, comparison.open[s].file().string(), comparison.method, made.problem);
    fields[s] = std::move(made.field);
  }
  return fields;
}

/// Returns whether a sample can be compared: the field has an answer, and the force is at most the
/// scene's max_force.
bool isComparable(const ForceSample& sample, const Dataset& dataset) {
  return sample.inside && sample.force.norm() <= dataset.scene().workspace.max_force;
}

void compareOverBall(const Comparison& comparison, const BothFields& fields, double radius,
                     ComparedPlace& place) {
  std::vector<double> differences;
  std::array<std::vector<double>, 2> forces, bounds;
  const auto coordinate = [&](int n) { return radius * (2.0 * n / (ball_samples - 1) - 1); };
  for (int n = 0; n < ball_samples * ball_samples * ball_samples; ++n) {
    const int column = n % ball_samples, row = n / ball_samples % ball_samples,
              layer = n / (ball_samples * ball_samples);
    const Eigen::Vector3d p(coordinate(column), coordinate(row), coordinate(layer));
    const std::array<ForceSample, 2> samples = {fields[0]->evaluate(p), fields[1]->evaluate(p)};
    if (p.norm() > radius || !isComparable(samples[0], comparison.open[0]) ||
        !isComparable(samples[1], comparison.open[1]))
      continue;
    differences.push_back((samples[1].force - samples[0].force).norm());
    for (std::size_t s = 0; s < 2; ++s) {
      forces[s].push_back(samples[s].force.norm());
      if (std::isfinite(samples[s].error_bound)) bounds[s].push_back(samples[s].error_bound);
    }
  }
  place.displacements = differences.size();
  for (std::size_t s = 0; s < 2; ++s) {
    const Spread force = spreadOf(forces[s]);
    place.sides[s] = {-fields[s]->evaluate(Eigen::Vector3d::Zero()).stiffness.trace() / 3,
                      force.mean, force.maximum, spreadOf(bounds[s]).mean};
  }
  place.difference = spreadOf(std::move(differences));
  if (place.sides[0].mean_force > 0)
    place.relative = place.difference.mean / place.sides[0].mean_force;
}

void compareOverDistance(const BothFields& fields, double radius, ComparedPlace& place) {
  const auto directions = mapped(neighbor_steps, [](const LatticePoint& step) {
    return Eigen::Vector3d(step[0], step[1], step[2]).normalized();
  });
  for (int n = 0; n <= distance_samples; ++n) {
    // Use slightly less than the radius, because rounding may put a point outside the sphere.
    const double distance = radius * (1 - 1e-9) * n / distance_samples;
    Eigen::Array3d sum = Eigen::Array3d::Zero();
    int count = 0;
    for (const Eigen::Vector3d& direction : directions) {
      const Eigen::Vector3d a = forceInside(fields[0]->evaluate(distance * direction)),
                            b = forceInside(fields[1]->evaluate(distance * direction));
      if (!a.allFinite() || !b.allFinite()) continue;
      sum += Eigen::Array3d(a.norm(), b.norm(), (b - a).norm());
      ++count;
    }
    sum /= count;  // NaN if neither dataset has forces there
    place.distances.push_back({distance, sum[0], sum[1], sum[2]});
  }
}

double commonRadius(const SpacePair& pair) {
  return std::min(pair[0]->lattice.radius(), pair[1]->lattice.radius());
}

PlaceDifference differenceAt(const Comparison& comparison, const SpacePair& pair) {
  ComparedPlace place;
  compareOverBall(comparison, bothFields(comparison, pair), commonRadius(pair), place);
  return {pair[0]->patch.name, restPlace(comparison.open[0], *pair[0]), place.relative};
}

ComparedPlace comparePlace(const Comparison& comparison, const SpacePair& pair) {
  const BothFields fields = bothFields(comparison, pair);
  const double radius = commonRadius(pair);
  ComparedPlace place;
  place.name = pair[0]->patch.name;
  place.apart =
      (restPlace(comparison.open[0], *pair[0]) - restPlace(comparison.open[1], *pair[1])).norm();
  compareOverBall(comparison, fields, radius, place);
  compareOverDistance(fields, radius, place);
  for (int axis = 0; axis < 3; ++axis)
    for (std::size_t s = 0; s < 2; ++s) {
      ForceWay& way = place.axes[static_cast<std::size_t>(axis)][s];
      way.direction = Eigen::Vector3d::Unit(axis);
      way.solved = solvedOnWay(*pair[s], way.direction, true);
      const double own = pair[s]->lattice.radius() * (1 - 1e-9);
      way.sampled.push_back(sampledOnWay(
          [&](const Eigen::Vector3d& p) { return forceInside(fields[s]->evaluate(p)); },
          way.direction, -own, own));
    }
  return place;
}

/// Returns sentences about the limits of the comparison, with remedies.
std::vector<std::string> limitsOf(const Comparison& comparison) {
  const Dataset &first = comparison.open[0], &second = comparison.open[1];
  std::vector<std::string> limits;
  if (std::ranges::find(comparison.differences, "mesh") != comparison.differences.end()) {
    const double apart = std::ranges::max(mapped(comparison.places, &ComparedPlace::apart));
    limits.push_back(fmt::format(
        "The meshes differ. Active nodes of the same name are compared, although they lie up to "
        "{:.3g} mm apart at rest. Their differences come from shape, elements and material. To "
        "compare only materials, build both scenes on the same mesh.",
        1e3 * apart));
  }
  const std::size_t alone = first.spaces().size() + second.spaces().size() - 2 * comparison.common;
  if (alone > 0)
    limits.push_back(fmt::format(
        "{} left out, present in only one dataset or at different places. To compare all, give "
        "both scenes the same [[active]] and build again.",
        counted(alone, "active node")));
  const double a = first.scene().workspace.radius, b = second.scene().workspace.radius;
  if (a != b)
    limits.push_back(
        fmt::format("The workspace balls differ ({:.4g} and {:.4g} mm): only the smaller one is "
                    "compared. To compare all, set the same workspace.radius in both scenes.",
                    1e3 * a, 1e3 * b));
  return limits;
}

std::string materialOf(const Dataset& dataset, const std::string& group) {
  for (const Region& region : dataset.scene().regions)
    if (region.name() == group) return inWords(region.material);
  return "-";
}

/// Returns the bodies, materials, workspaces and sizes of two datasets side by side.
std::vector<ComparedProperty> comparedProperties(const std::vector<Dataset>& datasets,
                                                 const std::vector<DatasetFacts>& facts) {
  const Dataset &first = datasets[0], &second = datasets[1];
  std::vector<ComparedProperty> properties;
  const auto add = [&](const std::string& name, const auto& of) {
    properties.push_back({name, of(first), of(second)});
  };
  add("scene", [](const Dataset& dataset) { return dataset.scene().name; });
  add("mesh", [](const Dataset& d) {
    return d.scene().mesh.filename().string() + ": " + describeMesh(d.mesh());
  });
  add("extent", [](const Dataset& dataset) {
    const Eigen::Vector3d size = 1e3 * boundingBox(dataset.mesh()).sizes();
    return fmt::format("{:.4g} x {:.4g} x {:.4g} mm", size.x(), size.y(), size.z());
  });
  add("fixed nodes", [](const Dataset& d) { return std::to_string(d.fixedNodes().size()); });
  std::set<std::string> groups;
  for (const Dataset& dataset : datasets)
    for (const Region& region : dataset.scene().regions) groups.insert(region.name());
  for (const std::string& group : groups)
    add(group.empty() ? "material" : "material of " + group,
        [&](const Dataset& dataset) { return materialOf(dataset, group); });
  add("discretization", [](const Dataset& dataset) {
    const Discretization& used = dataset.scene().discretization;
    return fmt::format("displacement {}, pressure {}", word(used.displacement),
                       word(used.pressure));
  });
  add("gravity", [](const Dataset& dataset) -> std::string {
    const Eigen::Vector3d& g = dataset.scene().gravity;
    return g.isZero() ? "none" : fmt::format("({}) m/s²", vectorText(g, 4));
  });
  add("active nodes", [](const Dataset& d) { return std::to_string(d.spaces().size()); });
  add("workspace", describeBall);
  add("force limit", [](const Dataset& dataset) {
    return fmt::format("{:.3g} N", dataset.scene().workspace.max_force);
  });
  properties.push_back({"solved configurations", std::to_string(facts[0].configurations),
                        std::to_string(facts[1].configurations)});
  add("largest solved force", [](const Dataset& d) {
    return formatNumber(std::ranges::max(mapped(d.spaces(), largestForce)), 3) + " N";
  });
  properties.push_back({"file", formatBytes(facts[0].bytes), formatBytes(facts[1].bytes)});
  add("kernel family", [](const Dataset& dataset) { return dataset.kernelFamily(); });
  return properties;
}

}  // namespace

Comparison compareDatasets(std::vector<Dataset> datasets, const std::string& method,
                           std::size_t most_places) {
  PALPATE_ASSERT(datasets.size() == 2 && most_places > 0,
                 "a comparison needs two datasets and a place");
  Comparison comparison;
  comparison.open = std::move(datasets);
  comparison.method = method;
  const Dataset &first = comparison.open[0], &second = comparison.open[1];
  comparison.differences = sceneDifferences(first, second);
  const std::vector<SpacePair> pairs = commonSpaces(first, second);
  if (pairs.empty())
    throw badInput(
        "{} and {} cannot be compared: they have no active node of the same name and kind (the "
        "first has {}; the second {}). Use the same names in [[active]] of both scenes and build "
        "again, or report on each",
        first.file().string(), second.file().string(), namesIn(first), namesIn(second));
  comparison.common = pairs.size();
  for (const Dataset& dataset : comparison.open) comparison.datasets.push_back(factsOf(dataset));
  // Compares at most `most` pairs, evenly spread.
  const auto fill = [&](auto& results, std::size_t most, auto compare) {
    results.resize(std::min(most, pairs.size()));
    inParallel(results.size(), [&](std::size_t n) {
      results[n] = compare(comparison, pairs[n * pairs.size() / results.size()]);
    });
  };
  fill(comparison.places, most_places, comparePlace);
  fill(comparison.everywhere, most_differences, differenceAt);
  comparison.properties = comparedProperties(comparison.open, comparison.datasets);
  comparison.limits = limitsOf(comparison);
  return comparison;
}

}  // namespace palpate
