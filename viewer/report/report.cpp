#include "viewer/report/report.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "common/base/parallel.hpp"
#include "viewer/fields/field_choice.hpp"
#include "viewer/report/field_comparison.hpp"

namespace palpate {
namespace {

constexpr std::array<std::array<int, 2>, 3> planes = {{{0, 1}, {0, 2}, {1, 2}}};

std::vector<Dataset> opened(const std::vector<std::filesystem::path>& files) {
  if (files.empty()) throw badInput("a report needs at least one dataset");
  std::vector<Dataset> datasets;
  for (const std::filesystem::path& file : files) datasets.emplace_back(file);
  refuseOtherScenes(datasets);
  return datasets;
}

std::vector<std::string> chosenMethods(const std::vector<std::string>& asked) {
  const std::vector<std::string>& known = forceFieldMethods();
  if (asked.empty()) return known;
  std::vector<std::string> chosen;
  for (const std::string& method : asked) {
    if (std::find(known.begin(), known.end(), method) == known.end())
      throw badInput("--methods: there is no method \"{}\"; there are: {}", method,
                     fmt::join(known, ", "));
    if (std::find(chosen.begin(), chosen.end(), method) == chosen.end()) chosen.push_back(method);
  }
  return chosen;
}

/// `count` numbers below `size`, evenly spread.
std::vector<std::size_t> evenly(std::size_t size, std::size_t count) {
  std::vector<std::size_t> chosen;
  for (std::size_t n = 0; n < std::min(size, count); ++n)
    chosen.push_back(size <= count ? n : n * size / count);
  return chosen;
}

bool isFirstDataset(const ComparedLattice& lattice) {
  return lattice.dataset == 0 && lattice.factor == 0;
}

/// Fills a Report step by step.
class Reporter {
 public:
  explicit Reporter(const ReportOptions& options) : options_(options) {
    report_.open = opened(options.datasets);
    report_.methods = chosenMethods(options.methods);
    for (const Dataset& dataset : report_.open) report_.datasets.push_back(factsOf(dataset));
    report_.failures = failuresOf(report_.open.front());
    for (ComparedLattice& lattice : latticesIn(report_.open))
      report_.lattices.push_back({std::move(lattice), 0, 0, {}, {}, {}});
    compared_ = evenly(spaces(), options.compared_nodes);
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
    measureOtherNodes();
    samplePictures();
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
    for (std::size_t s = 0; s < spaces(); ++s) {
      std::vector<const SpaceTable*> tables;
      for (const Dataset& dataset : report_.open) tables.push_back(&dataset.spaces()[s]);
      report_.held_out.push_back(usableProbes(tables));
    }
    if (countHeldOut() > 0) {
      report_.held_out_kind = HeldOutKind::probes;
      return;
    }
    holdOutLatticePoints();
    if (countHeldOut() > 0) report_.held_out_kind = HeldOutKind::lattice_points;
  }

  std::size_t countHeldOut() {
    report_.held_out_count = 0;
    for (const auto& of_space : report_.held_out) report_.held_out_count += of_space.size();
    return report_.held_out_count;
  }

  void holdOutLatticePoints() {
    if (report_.lattices.size() < 2) return;
    const auto densest = std::max_element(
        report_.open.begin(), report_.open.end(), [](const Dataset& a, const Dataset& b) {
          return a.spaces().front().points.size() < b.spaces().front().points.size();
        });
    source_ = static_cast<std::size_t>(densest - report_.open.begin());
    for (std::size_t s = 0; s < spaces(); ++s) {
      std::vector<std::shared_ptr<const SpaceTable>> owners;
      std::vector<const SpaceTable*> tables;
      for (const LatticeMeasures& lattice : report_.lattices)
        if (!isSource(lattice)) {
          owners.push_back(table(lattice, s));
          tables.push_back(owners.back().get());
        }
      report_.held_out[s] = leftOutPoints(densest->spaces()[s], tables);
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
    std::int64_t factorizations = 0;
    for (const std::size_t s : compared_) {
      lattice.node_configurations.push_back(0);
      const std::shared_ptr<const SpaceTable> of_node = table(lattice, s);
      for (const PointRecord& point : of_node->points) {
        if (!isSolved(point.tag)) continue;
        ++lattice.node_configurations.back();
        factorizations += point.cost.factorizations;
      }
    }
    const auto nodes = static_cast<double>(compared_.size());
    lattice.configurations =
        static_cast<double>(std::accumulate(lattice.node_configurations.begin(),
                                            lattice.node_configurations.end(), std::int64_t{0})) /
        nodes;
    lattice.factorizations = static_cast<double>(factorizations) / nodes;
  }

  /// By configurations; and chooses the measured one.
  void orderLattices() {
    std::stable_sort(report_.lattices.begin(), report_.lattices.end(),
                     [](const LatticeMeasures& a, const LatticeMeasures& b) {
                       return a.configurations < b.configurations;
                     });
    for (std::size_t n = 0; n < report_.lattices.size(); ++n) {
      const bool is_settled =
          report_.measured && isFirstDataset(report_.lattices[*report_.measured]);
      if (!is_settled && isMeasurable(report_.lattices[n])) report_.measured = n;
    }
  }

  void describeNodes() {
    for (std::size_t s = 0; s < spaces(); ++s) {
      const SpaceTable& space = report_.open.front().spaces()[s];
      NodeMeasures node;
      node.name = space.patch.name;
      node.held_out = report_.held_out[s].size();
      node.jumps = space.inconsistent_edges.size();
      for (const PointRecord& point : space.points) {
        ++node.tags[static_cast<std::size_t>(point.tag)];
        if (isSolved(point.tag))
          node.largest_force = std::max(node.largest_force, point.equilibrium.force.norm());
      }
      node.methods.resize(report_.methods.size());
      report_.nodes.push_back(std::move(node));
    }
    for (std::size_t n = 0; n < compared_.size(); ++n) report_.nodes[compared_[n]].compared = n;
  }

  /// One after the other, while nothing else runs.
  void timeMethods(LatticeMeasures& lattice) const {
    const auto first = table(lattice, compared_.front());
    for (const std::string& method : report_.methods) {
      const MethodTiming timing = timeMethod(*first, method, options_.seconds_per_timing);
      MethodMeasures& measures = lattice.methods.emplace_back();
      measures.nanoseconds = timing.nanoseconds;
      measures.seconds_to_prepare = timing.seconds_to_prepare;
    }
  }

  void measureLattice(LatticeMeasures& lattice) {
    spdlog::info("{}: comparing {} methods on {} active nodes", lattice.label,
                 report_.methods.size(), compared_.size());
    const bool is_measurable = isMeasurable(lattice);
    std::vector<NodeComparison> nodes(compared_.size());
    inParallel(compared_.size(), [&](std::size_t n) {
      nodes[n] = compareMethods(
          *table(lattice, compared_[n]), report_.methods,
          is_measurable ? report_.held_out[compared_[n]] : std::vector<HeldOutSolution>(),
          n < options_.looped_nodes);
    });
    for (std::size_t m = 0; m < report_.methods.size(); ++m) pool(nodes, m, lattice.methods[m]);
    if (!is_measurable) return;
    for (std::size_t n = 0; n < compared_.size(); ++n) {
      std::vector<double>& errors = lattice.node_errors.emplace_back();
      for (std::size_t m = 0; m < report_.methods.size(); ++m) {
        const ErrorMeasures measures = measureErrors(nodes[n][m].comparisons, report_.target);
        errors.push_back(measures.error.mean);
        if (isMeasured(lattice)) report_.nodes[compared_[n]].methods[m] = measures;
      }
    }
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

  void samplePictures() {
    const std::vector<std::size_t> nodes = worstFirst(report_);
    report_.pictures.resize(std::min(nodes.size(), options_.pictured_nodes));
    inParallel(report_.pictures.size(),
               [&](std::size_t n) { report_.pictures[n] = picturesOf(nodes[n]); });
  }

  NodePictures picturesOf(std::size_t node) const {
    NodePictures pictures;
    pictures.node = node;
    const auto shown = table(shownLattice(report_), node);
    const std::vector<HeldOutSolution>& held_out = report_.held_out[node];
    if (const auto field = tryToMake(report_.methods.front(), *shown).field)
      for (const auto& [across, up] : planes)
        pictures.slices.push_back(sampleSlice(*field, *shown, across, up, held_out));
    const SpaceTable& whole = report_.open.front().spaces()[node];
    for (int axis = 0; axis < 3; ++axis)
      pictures.solved[static_cast<std::size_t>(axis)] = solvedForcesAlong(whole, axis);
    for (const std::string& method : report_.methods) {
      std::array<AxisForces, 3>& sampled = pictures.sampled.emplace_back();
      if (const auto field = tryToMake(method, whole).field)
        for (int axis = 0; axis < 3; ++axis)
          sampled[static_cast<std::size_t>(axis)] =
              sampleForcesAlong(*field, whole.lattice.radius(), axis);
    }
    return pictures;
  }

  const ReportOptions& options_;
  Report report_;
  std::vector<std::size_t> compared_;  ///< numbers of active nodes
  std::optional<std::size_t> source_;  ///< dataset whose points are held out
};

}  // namespace

Report makeReport(const ReportOptions& options) { return Reporter(options).finish(); }

const LatticeMeasures& shownLattice(const Report& report) {
  if (report.measured) return report.lattices[*report.measured];
  const auto first = std::find_if(report.lattices.begin(), report.lattices.end(), isFirstDataset);
  PALPATE_ASSERT(first != report.lattices.end(), "every dataset is one of the lattices");
  return *first;
}

std::vector<std::size_t> worstFirst(const Report& report) {
  std::vector<std::size_t> nodes(report.nodes.size());
  std::iota(nodes.begin(), nodes.end(), 0);
  const auto error = [&](std::size_t node) {
    const double mean = report.nodes[node].methods.front().error.mean;
    return std::isnan(mean) ? -1 : mean;
  };
  std::stable_sort(nodes.begin(), nodes.end(),
                   [&](std::size_t a, std::size_t b) { return error(a) > error(b); });
  return nodes;
}

}  // namespace palpate
