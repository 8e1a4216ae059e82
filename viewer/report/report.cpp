#include "viewer/report/report.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "common/base/number_text.hpp"
#include "common/base/parallel.hpp"
#include "viewer/fields/field_choice.hpp"

namespace palpate {
namespace {

std::vector<std::string> chosenMethods(const std::vector<std::string>& asked) {
  const std::vector<std::string>& known = forceFieldMethods();
  if (asked.empty()) return known;
  std::vector<std::string> chosen;
  for (const std::string& method : asked) {
    if (std::ranges::find(known, method) == known.end())
      throw badInput("--methods: there is no method \"{}\"; there are: {}", method,
                     fmt::join(known, ", "));
    if (std::ranges::find(chosen, method) == chosen.end()) chosen.push_back(method);
  }
  return chosen;
}

/// At most `count` numbers below `size`, evenly spread.
std::vector<std::size_t> evenly(std::size_t size, std::size_t count) {
  std::vector<std::size_t> chosen(std::min(size, count));
  for (std::size_t n = 0; n < chosen.size(); ++n) chosen[n] = n * size / chosen.size();
  return chosen;
}

bool isFirstDataset(const ComparedLattice& lattice) {
  return lattice.dataset == 0 && lattice.factor == 0;
}

/// Fills a Report step by step.
class Reporter {
 public:
  Reporter(const ReportOptions& options, std::vector<Dataset> open) : options_(options) {
    refuseOtherScenes(open);
    report_.open = std::move(open);
    report_.methods = chosenMethods(options.methods);
    for (const Dataset& dataset : report_.open) report_.datasets.push_back(factsOf(dataset));
    report_.failures = failuresOf(report_.open.front());
    for (ComparedLattice& lattice : latticesIn(report_.open))
      report_.lattices.push_back({std::move(lattice), 0, 0, {}, {}, {}});
    report_.areas_alone = std::ranges::all_of(
        report_.open.front().scene().active,
        [](const ActiveSelection& active) { return !active.area.empty() || active.isProbe(); });
    compared_ = evenly(spaces(), report_.areas_alone ? 1 : options.compared_nodes);
    report_.compared = compared_.size();
  }

  Report finish() {
    PALPATE_ASSERT(!compared_.empty() && !report_.methods.empty(),
                   "a dataset has an active node, and one method is the default");
    setTarget();
    holdOut();
    for (LatticeMeasures& lattice : report_.lattices) measureCost(lattice);
    orderLattices();
    describeNodes();
    for (LatticeMeasures& lattice : report_.lattices) {
      timeMethods(lattice);
      measureLattice(lattice);
    }
    if (!report_.areas_alone) measureOtherNodes();
    report_.areas = measureAreas(report_.open.front(), report_.target);
    if (!report_.areas_alone) samplePictures();
    return std::move(report_);
  }

 private:
  using NodeComparison = std::vector<MethodComparison>;  ///< per method

  std::size_t spaces() const { return report_.open.front().spaces().size(); }
  std::shared_ptr<const SpaceTable> table(const ComparedLattice& lattice, std::size_t space) const {
    return tableOf(report_.open, lattice, space);
  }

  /// The scene's, of the first that has one.
  void setTarget() {
    for (const Dataset& dataset : report_.open) {
      const Accuracy& accuracy = dataset.scene().accuracy;
      if (!accuracy.adaptive() || report_.target_of_scene) continue;
      report_.target = {accuracy.force_error, accuracy.force_floor};
      report_.target_of_scene = true;
    }
  }

  /// Probes where there are any, else lattice points.
  void holdOut() {
    report_.held_out.resize(spaces());
    for (std::size_t s = 0; s < spaces(); ++s) {
      std::vector<const SpaceTable*> tables;
      for (const Dataset& dataset : report_.open) tables.push_back(&dataset.spaces()[s]);
      holdOut(s, usableProbes(tables), HeldOutKind::probes);
    }
    if (report_.held_out_count == 0) holdOutLatticePoints();
  }

  void holdOut(std::size_t space, std::vector<HeldOutSolution> solutions, HeldOutKind kind) {
    if (!solutions.empty()) report_.held_out_kind = kind;
    report_.held_out_count += solutions.size();
    report_.held_out[space] = std::move(solutions);
  }

  void holdOutLatticePoints() {
    // Of the only lattice no other leaves a point out.
    if (report_.lattices.size() < 2) return;
    const auto densest = std::ranges::max_element(report_.open, {}, [](const Dataset& dataset) {
      return dataset.spaces().front().points.size();
    });
    source_ = densest - report_.open.begin();
    for (std::size_t s = 0; s < spaces(); ++s) {
      std::vector<std::shared_ptr<const SpaceTable>> owners;
      std::vector<const SpaceTable*> tables;
      for (const LatticeMeasures& lattice : report_.lattices)
        if (!isSource(lattice)) {
          owners.push_back(table(lattice, s));
          tables.push_back(owners.back().get());
        }
      holdOut(s, leftOutPoints(densest->spaces()[s], tables), HeldOutKind::lattice_points);
    }
  }

  /// The held-out solutions are points of this lattice: it cannot be measured with them.
  bool isSource(const ComparedLattice& lattice) const {
    return source_ == lattice.dataset && lattice.factor == 0;
  }
  bool isMeasurable(const ComparedLattice& lattice) const {
    return report_.held_out_kind == HeldOutKind::probes ||
           (report_.held_out_kind == HeldOutKind::lattice_points && !isSource(lattice));
  }
  bool isMeasured(const LatticeMeasures& lattice) const {
    return report_.measured && &lattice == &report_.lattices[*report_.measured];
  }

  void measureCost(LatticeMeasures& lattice) const {
    // Sums of whole numbers, exact in doubles.
    for (const std::size_t s : compared_) {
      std::int64_t& configurations = lattice.node_configurations.emplace_back(0);
      const std::shared_ptr<const SpaceTable> of_node = table(lattice, s);
      for (const PointRecord& point : of_node->points) {
        if (!isSolved(point.tag)) continue;
        ++configurations;
        lattice.factorizations += point.cost.factorizations;
      }
      lattice.configurations += configurations;
    }
    lattice.configurations /= compared_.size();
    lattice.factorizations /= compared_.size();
  }

  /// By configurations; and chooses the measured one.
  void orderLattices() {
    std::ranges::stable_sort(report_.lattices, {}, &LatticeMeasures::configurations);
    // The densest that can be measured; but the first dataset as it is, where it can.
    for (std::size_t n = 0; n < report_.lattices.size(); ++n)
      if (isMeasurable(report_.lattices[n]) &&
          !(report_.measured && isFirstDataset(report_.lattices[*report_.measured])))
        report_.measured = n;
  }

  void describeNodes() {
    for (std::size_t s = 0; s < spaces(); ++s) {
      const SpaceTable& space = report_.open.front().spaces()[s];
      NodeMeasures& node = report_.nodes.emplace_back();
      node.name = space.patch.name;
      node.held_out = report_.held_out[s].size();
      node.jumps = space.inconsistent_edges.size();
      for (const PointRecord& point : space.points) {
        ++node.tags[static_cast<std::size_t>(point.tag)];
        if (isSolved(point.tag))
          node.largest_force = std::max(node.largest_force, point.equilibrium.force.norm());
      }
      node.methods.resize(report_.methods.size());
    }
    for (std::size_t n = 0; n < compared_.size(); ++n) report_.nodes[compared_[n]].compared = n;
  }

  /// One after the other, while nothing else runs.
  void timeMethods(LatticeMeasures& lattice) const {
    // Preparing takes seconds for some methods, and all nodes are alike: one is enough.
    const auto first = table(lattice, compared_.front());
    for (const std::string& method : report_.methods)
      lattice.methods.push_back({timeMethod(*first, method, options_.seconds_per_timing)});
  }

  void measureLattice(LatticeMeasures& lattice) {
    PALPATE_ASSERT(
        lattice.methods.size() == report_.methods.size() && report_.held_out.size() == spaces(),
        "methods were timed and solutions held out before anything is measured");
    spdlog::info("{}: comparing {} on {}", lattice.label, counted(report_.methods.size(), "method"),
                 counted(compared_.size(), "active node"));
    const bool is_measurable = isMeasurable(lattice);
    // A place each in the result, so that threads share nothing.
    std::vector<NodeComparison> nodes(compared_.size());
    inParallel(compared_.size(), [&](std::size_t n) {
      nodes[n] = compareMethods(
          *table(lattice, compared_[n]), report_.methods,
          is_measurable ? report_.held_out[compared_[n]] : std::vector<HeldOutSolution>(),
          n < options_.looped_nodes);
    });
    for (std::size_t m = 0; m < report_.methods.size(); ++m) pool(nodes, m, lattice.methods[m]);
    if (!is_measurable) return;
    if (isMeasured(lattice) && !report_.areas_alone) measureWaysOf(nodes);
    for (std::size_t n = 0; n < compared_.size(); ++n) {
      std::vector<double>& errors = lattice.node_errors.emplace_back();
      for (std::size_t m = 0; m < report_.methods.size(); ++m) {
        const ErrorMeasures measures = measureErrors(nodes[n][m].comparisons, report_.target);
        errors.push_back(measures.error.mean);
        if (isMeasured(lattice)) report_.nodes[compared_[n]].methods[m] = measures;
      }
    }
  }

  void measureWaysOf(const std::vector<NodeComparison>& nodes) {
    std::vector<std::vector<WayComparison>> methods(report_.methods.size());
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      const std::vector<HeldOutSolution>& held_out = report_.held_out[compared_[n]];
      for (std::size_t m = 0; m < methods.size(); ++m)
        for (std::size_t k = 0; k < nodes[n][m].comparisons.size(); ++k)
          methods[m].push_back({held_out[k].displacement.norm(), nodes[n][m].comparisons[k]});
    }
    const double radius = report_.open.front().spaces().front().lattice.radius();
    report_.ways = measureWays(methods, radius, report_.target);
  }

  /// One method on all compared nodes.
  void pool(const std::vector<NodeComparison>& nodes, std::size_t method,
            MethodMeasures& measures) const {
    std::vector<ForceComparison> pooled;
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      const MethodComparison& node = nodes[n][method];
      pooled.insert(pooled.end(), node.comparisons.begin(), node.comparisons.end());
      measures.loop_work = std::fmax(measures.loop_work, node.loop_work);
      if (!node.problem.empty() && measures.problem.empty())
        measures.problem = report_.nodes[compared_[n]].name + ": " + node.problem;
    }
    measures.all = measureErrors(pooled, report_.target);
    measures.covered = measureCoveredErrors(pooled, report_.target);
  }

  void measureOtherNodes() {
    if (!report_.measured || compared_.size() == spaces()) return;
    const LatticeMeasures& lattice = shownLattice(report_);
    spdlog::info("{}: measuring {} on the other active nodes", lattice.label,
                 report_.methods.front());
    inParallel(spaces(), [&](std::size_t s) {
      NodeMeasures& node = report_.nodes[s];
      if (node.compared) return;
      const NodeComparison result =
          compareMethods(*table(lattice, s), {report_.methods.front()}, report_.held_out[s], false);
      node.methods.front() = measureErrors(result.front().comparisons, report_.target);
    });
  }

  void measureBounds() {
    inParallel(spaces(), [&](std::size_t s) {
      const auto shown = table(shownLattice(report_), s);
      if (const auto field = tryToMake(report_.methods.front(), *shown).field)
        report_.nodes[s].bound = sampleBounds(*field, shown->lattice.radius());
    });
  }

  void samplePictures() {
    if (options_.pictured_nodes == 0) return;
    measureBounds();
    const std::vector<std::size_t> nodes = worstFirst(report_);
    report_.pictures.resize(std::min(nodes.size(), options_.pictured_nodes));
    inParallel(report_.pictures.size(), [&](std::size_t n) {
      const std::size_t node = nodes[n];
      const auto shown = table(shownLattice(report_), node);
      report_.pictures[n] = sampleNode(*shown, report_.open.front().spaces()[node], report_.methods,
                                       report_.held_out[node]);
      report_.pictures[n].node = node;
    });
  }

  const ReportOptions& options_;
  Report report_;
  std::vector<std::size_t> compared_;  ///< numbers of active nodes
  std::optional<std::size_t> source_;  ///< dataset whose points are held out
};

}  // namespace

std::vector<Dataset> openDatasets(const std::vector<std::filesystem::path>& files) {
  if (files.empty()) throw badInput("a report needs at least one dataset");
  std::vector<Dataset> datasets(files.begin(), files.end());
  std::ranges::for_each(datasets, warnIfPartial);
  return datasets;
}

Report makeReport(const ReportOptions& options) {
  return makeReport(options, openDatasets(options.datasets));
}

Report makeReport(const ReportOptions& options, std::vector<Dataset> open) {
  return Reporter(options, std::move(open)).finish();
}

const LatticeMeasures& shownLattice(const Report& report) {
  return report.measured ? report.lattices[*report.measured] : firstAsItIs(report);
}

const LatticeMeasures& firstAsItIs(const Report& report) {
  const auto first = std::ranges::find_if(report.lattices, isFirstDataset);
  PALPATE_ASSERT(first != report.lattices.end(), "every dataset is one of the lattices");
  return *first;
}

std::vector<std::size_t> worstFirst(const Report& report) {
  std::vector<std::size_t> nodes(report.nodes.size());
  std::iota(nodes.begin(), nodes.end(), 0);
  const auto error = [&](std::size_t node) {
    const double mean = report.nodes[node].methods.front().error.mean;
    // Not measured: after all that are.
    return std::isnan(mean) ? -1 : mean;
  };
  std::ranges::stable_sort(nodes, std::greater(), error);
  return nodes;
}

}  // namespace palpate
