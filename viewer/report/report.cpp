#include "viewer/report/report.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "common/base/index.hpp"
#include "common/base/number_text.hpp"
#include "common/base/parallel.hpp"
#include "viewer/fields/field_choice.hpp"

namespace palpate {
namespace {

/// Returns at most `count` indices below `size`, evenly spread.
std::vector<std::size_t> evenly(std::size_t size, std::size_t count) {
  std::vector<std::size_t> chosen(std::min(size, count));
  for (std::size_t n = 0; n < chosen.size(); ++n) chosen[n] = n * size / chosen.size();
  return chosen;
}

bool isFirstDataset(const ComparedLattice& lattice) {
  return lattice.dataset == 0 && lattice.factor == 0;
}

/// Returns the accuracy target of the first dataset that has a target in its scene, and true. If no
/// scene has a target, returns a default target, and false.
std::pair<AccuracyTarget, bool> targetOf(const std::vector<Dataset>& open) {
  for (const Dataset& dataset : open)
    if (const Accuracy& accuracy = dataset.scene().accuracy; accuracy.adaptive())
      return {{accuracy.force_error, accuracy.force_floor}, true};
  return {};
}

bool isTouchedByFingersAlone(const Scene& scene) {
  return std::ranges::all_of(scene.active, [](const ActiveSelection& active) {
    return !active.area.empty() || active.isProbe();
  });
}

/// Everything that the comparison of the methods needs.
struct Study {
  const ReportOptions& options;
  const Report& report;               ///< with datasets, methods, target and held-out solutions
  std::vector<std::size_t> compared;  ///< indices of active nodes
};

using NodeComparison = std::vector<MethodComparison>;        ///< per method
using NodeErrors = std::vector<std::vector<ErrorMeasures>>;  ///< [compared node][method]

/// Returns a lattice with its costs: the numbers of solved points and of factorizations.
LatticeMeasures costOf(const Study& study, ComparedLattice&& lattice) {
  LatticeMeasures measures{std::move(lattice), 0, 0, {}, {}, {}};
  // The sums are integers, so they are exact in doubles.
  for (const std::size_t s : study.compared) {
    std::int64_t& configurations = measures.node_configurations.emplace_back(0);
    const std::shared_ptr<const SpaceTable> of_node = tableOf(study.report.open, measures, s);
    for (const PointRecord& point : of_node->points) {
      if (!isSolved(point.tag)) continue;
      ++configurations;
      measures.factorizations += point.cost.factorizations;
    }
    measures.configurations += configurations;
  }
  measures.configurations /= study.compared.size();
  measures.factorizations /= study.compared.size();
  return measures;
}

/// Returns the complete lattice of the first dataset if its errors can be measured, otherwise the
/// densest lattice whose errors can be measured.
std::optional<std::size_t> measuredOf(const std::vector<LatticeMeasures>& lattices,
                                      const HeldOut& held_out) {
  std::optional<std::size_t> measured;
  for (std::size_t n = 0; n < lattices.size(); ++n)
    if (held_out.measures(lattices[n]) && !(measured && isFirstDataset(lattices[*measured])))
      measured = n;
  return measured;
}

/// Measures the times of the methods one after the other, while nothing else runs.
std::vector<MethodMeasures> timed(const Study& study, const ComparedLattice& lattice) {
  // One node is enough, because all nodes are alike. Preparing takes seconds for some methods.
  const auto first = tableOf(study.report.open, lattice, study.compared.front());
  return mapped(study.report.methods, [&](const std::string& method) {
    return MethodMeasures{timeMethod(*first, method, study.options.seconds_per_timing)};
  });
}

/// Returns the results of all methods on each compared node.
std::vector<NodeComparison> compared(const Study& study, const ComparedLattice& lattice) {
  spdlog::info("{}: comparing {} on {}", lattice.label,
               counted(study.report.methods.size(), "method"),
               counted(study.compared.size(), "active node"));
  const bool is_measurable = study.report.held_out.measures(lattice);
  // Each task writes only its own element.
  std::vector<NodeComparison> nodes(study.compared.size());
  inParallel(nodes.size(), [&](std::size_t n) {
    const std::size_t space = study.compared[n];
    nodes[n] = compareMethods(
        *tableOf(study.report.open, lattice, space), study.report.methods,
        is_measurable ? study.report.held_out.of_space[space] : std::vector<HeldOutSolution>(),
        n < study.options.looped_nodes);
  });
  return nodes;
}

/// Pools the results of one method over all compared nodes.
void pool(const Study& study, const std::vector<NodeComparison>& nodes, std::size_t method,
          MethodMeasures& measures) {
  std::vector<ForceComparison> pooled;
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    const MethodComparison& node = nodes[n][method];
    pooled.insert(pooled.end(), node.comparisons.begin(), node.comparisons.end());
    measures.loop_work = std::fmax(measures.loop_work, node.loop_work);
    if (!node.problem.empty() && measures.problem.empty())
      measures.problem =
          study.report.open.front().spaces()[study.compared[n]].patch.name + ": " + node.problem;
  }
  measures.all = measureErrors(pooled, study.report.target);
  measures.covered = measureCoveredErrors(pooled, study.report.target);
}

NodeErrors errorsOf(const Study& study, const std::vector<NodeComparison>& nodes) {
  NodeErrors errors(nodes.size());
  for (std::size_t n = 0; n < nodes.size(); ++n)
    for (const MethodComparison& method : nodes[n])
      errors[n].push_back(measureErrors(method.comparisons, study.report.target));
  return errors;
}

std::vector<ErrorShell> shellsOf(const Study& study, const std::vector<NodeComparison>& nodes) {
  std::vector<std::vector<ForceComparison>> methods(study.report.methods.size());
  for (const NodeComparison& node : nodes) {
    PALPATE_ASSERT(node.size() == methods.size(), "each node needs results of every method");
    for (std::size_t m = 0; m < methods.size(); ++m)
      methods[m].insert(methods[m].end(), node[m].comparisons.begin(), node[m].comparisons.end());
  }
  const double radius = study.report.open.front().spaces().front().lattice.radius();
  return measureShells(methods, radius, study.report.target);
}

/// Returns the measurements of all active nodes. errors: errors of the compared nodes on the
/// measured lattice; empty if no lattice is measured.
std::vector<NodeMeasures> nodesOf(const Study& study, const NodeErrors& errors) {
  PALPATE_ASSERT(errors.empty() || errors.size() == study.compared.size(),
                 "a measured lattice must have errors of every compared node");
  std::vector<NodeMeasures> nodes;
  for (const SpaceTable& space : study.report.open.front().spaces()) {
    const std::size_t held_out = study.report.held_out.of_space[nodes.size()].size();
    NodeMeasures& node = nodes.emplace_back();
    node.name = space.patch.name;
    node.held_out = held_out;
    node.jumps = space.inconsistent_edges.size();
    node.largest_force = largestForce(space);
    for (const PointRecord& point : space.points) ++node.tags[static_cast<std::size_t>(point.tag)];
    node.methods.resize(study.report.methods.size());
  }
  for (std::size_t n = 0; n < study.compared.size(); ++n) {
    nodes[study.compared[n]].compared = n;
    if (!errors.empty()) nodes[study.compared[n]].methods = errors[n];
  }
  return nodes;
}

/// Measures the default method on the nodes on which the methods are not compared.
void measureOthers(const Study& study, const LatticeMeasures& measured,
                   std::vector<NodeMeasures>& nodes) {
  if (study.compared.size() == nodes.size()) return;
  spdlog::info("{}: measuring {} on the other active nodes", measured.label,
               study.report.methods.front());
  inParallel(nodes.size(), [&](std::size_t s) {
    if (nodes[s].compared) return;
    const NodeComparison result =
        compareMethods(*tableOf(study.report.open, measured, s), {study.report.methods.front()},
                       study.report.held_out.of_space[s], false);
    nodes[s].methods.front() = measureErrors(result.front().comparisons, study.report.target);
  });
}

void measureBounds(const Study& study, const LatticeMeasures& shown,
                   std::vector<NodeMeasures>& nodes) {
  inParallel(nodes.size(), [&](std::size_t s) {
    const auto table = tableOf(study.report.open, shown, s);
    if (const auto field = tryToMake(study.report.methods.front(), *table).field)
      nodes[s].bound = sampleBounds(*field, table->lattice.radius());
  });
}

std::vector<NodePictures> picturesOf(const Study& study, const LatticeMeasures& shown,
                                     const std::vector<std::size_t>& worst) {
  std::vector<NodePictures> pictures(std::min(worst.size(), study.options.pictured_nodes));
  inParallel(pictures.size(), [&](std::size_t n) {
    const std::size_t node = worst[n];
    pictures[n] = sampleNode(*tableOf(study.report.open, shown, node),
                             study.report.open.front().spaces()[node], study.report.methods,
                             study.report.held_out.of_space[node]);
    pictures[n].node = node;
  });
  return pictures;
}

}  // namespace

std::vector<std::string> chosenMethods(const std::vector<std::string>& asked) {
  const std::vector<std::string>& known = forceFieldMethods();
  if (asked.empty()) return known;
  std::vector<std::string> chosen;
  for (const std::string& method : asked) {
    if (std::ranges::find(known, method) == known.end())
      throw badInput("--methods: unknown method \"{}\"; known: {}", method, fmt::join(known, ", "));
    if (std::ranges::find(chosen, method) == chosen.end()) chosen.push_back(method);
  }
  return chosen;
}

Report makeReport(const ReportOptions& options, std::vector<Dataset> open) {
  refuseOtherScenes(open);
  Report report;
  report.open = std::move(open);
  report.methods = chosenMethods(options.methods);
  for (const Dataset& dataset : report.open) report.datasets.push_back(factsOf(dataset));
  report.failures = failuresOf(report.open.front());
  report.areas_alone = isTouchedByFingersAlone(report.open.front().scene());
  std::tie(report.target, report.target_of_scene) = targetOf(report.open);
  std::vector<ComparedLattice> lattices = latticesIn(report.open);
  report.held_out = heldOutOf(report.open, lattices);
  const Study study = {
      options, report,
      evenly(report.open.front().spaces().size(), report.areas_alone ? 1 : options.compared_nodes)};
  PALPATE_ASSERT(!study.compared.empty() && !study.report.methods.empty(),
                 "a report needs an active node and a method");
  PALPATE_ASSERT(study.report.held_out.of_space.size() == report.open.front().spaces().size(),
                 "each active node must have its held-out solutions");
  report.compared = study.compared.size();

  for (ComparedLattice& lattice : lattices)
    report.lattices.push_back(costOf(study, std::move(lattice)));
  std::ranges::stable_sort(report.lattices, {}, &LatticeMeasures::configurations);
  report.measured = measuredOf(report.lattices, study.report.held_out);
  PALPATE_ASSERT(!report.measured || study.report.held_out.measures(shownLattice(report)),
                 "a lattice must not be measured with its own points");
  NodeErrors errors;
  for (std::size_t n = 0; n < report.lattices.size(); ++n) {
    LatticeMeasures& lattice = report.lattices[n];
    lattice.methods = timed(study, lattice);
    const std::vector<NodeComparison> nodes = compared(study, lattice);
    for (std::size_t m = 0; m < study.report.methods.size(); ++m)
      pool(study, nodes, m, lattice.methods[m]);
    if (!study.report.held_out.measures(lattice)) continue;
    NodeErrors of_nodes = errorsOf(study, nodes);
    for (const std::vector<ErrorMeasures>& methods : of_nodes)
      lattice.node_errors.push_back(
          mapped(methods, [](const ErrorMeasures& method) { return method.error.mean; }));
    if (report.measured != n) continue;
    errors = std::move(of_nodes);
    if (!report.areas_alone) report.shells = shellsOf(study, nodes);
  }
  report.nodes = nodesOf(study, errors);
  report.areas = measureAreas(report.open.front(), report.target);
  if (report.areas_alone) return report;
  if (report.measured) measureOthers(study, shownLattice(report), report.nodes);
  if (options.pictured_nodes == 0) return report;
  measureBounds(study, shownLattice(report), report.nodes);
  report.pictures = picturesOf(study, shownLattice(report), worstFirst(report));
  return report;
}

const LatticeMeasures& shownLattice(const Report& report) {
  if (report.measured) return report.lattices[*report.measured];
  const auto first = std::ranges::find_if(report.lattices, isFirstDataset);
  PALPATE_ASSERT(first != report.lattices.end(), "the first dataset must be one of the lattices");
  return *first;
}

std::vector<std::size_t> worstFirst(const Report& report) {
  std::vector<std::size_t> nodes = countUp<std::size_t>(report.nodes.size());
  const auto error = [&](std::size_t node) {
    const double mean = report.nodes[node].methods.front().error.mean;
    // nodes without a measurement last
    return std::isnan(mean) ? -1 : mean;
  };
  std::ranges::stable_sort(nodes, std::greater(), error);
  return nodes;
}

}  // namespace palpate
