#include "viewer/report/report.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/base/error.hpp"
#include "common/base/parallel.hpp"
#include "viewer/fields/field_choice.hpp"
#include "viewer/report/field_comparison.hpp"
#include "viewer/report/thinned_space.hpp"

namespace palpate {
namespace {

/// Coarser lattices that are looked at: every 2nd, 3rd and 4th point.
constexpr std::array<std::int32_t, 3> thinning_factors = {2, 3, 4};
/// Radius / spacing below which a thinned lattice says nothing; only every 2nd point may have less.
constexpr double smallest_ratio = 1.5;
constexpr double same_spacing = 1e-3;  ///< relative

/// Why the datasets are not of one scene; empty when they are.
std::string differenceOf(const Dataset& a, const Dataset& b) {
  const Scene &s = a.scene(), &t = b.scene();
  if (s.regions != t.regions) return "material";
  if (!(s.discretization == t.discretization)) return "discretization";
  if (s.gravity != t.gravity) return "gravity";
  if (a.mesh().nodes != b.mesh().nodes || a.mesh().tetrahedra != b.mesh().tetrahedra) return "mesh";
  if (a.fixedNodes() != b.fixedNodes()) return "fixed nodes";
  if (s.workspace.radius != t.workspace.radius) return "workspace.radius";
  if (s.workspace.max_force != t.workspace.max_force) return "workspace.max_force";
  if (s.workspace.reject_inverted != t.workspace.reject_inverted)
    return "workspace.reject_inverted";
  const auto same_patch = [](const SpaceTable& x, const SpaceTable& y) {
    return x.patch.name == y.patch.name && x.patch.nodes == y.patch.nodes &&
           x.patch.weights == y.patch.weights;
  };
  if (!std::equal(a.spaces().begin(), a.spaces().end(), b.spaces().begin(), b.spaces().end(),
                  same_patch))
    return "active nodes";
  return "";
}

void refuseOtherScenes(const std::vector<Dataset>& datasets) {
  for (const Dataset& dataset : datasets)
    if (const std::string what = differenceOf(datasets.front(), dataset); !what.empty())
      throw badInput(
          "{} and {} are not of one scene: they differ in {}. "
          "Only workspace.spacing and [accuracy] may differ",
          datasets.front().file().string(), dataset.file().string(), what);
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

/// "mesh", "points", "displacement": the group of an array, or itself where it is of nodal fields.
std::string kindOf(const std::string& path) {
  for (const char* field : {"displacement", "pressure"})
    if (path == std::string("/points/") + field) return field;
  return path.substr(1, std::min(path.find('/', 1), path.size()) - 1);
}

DatasetFacts factsOf(const Dataset& dataset) {
  DatasetFacts facts;
  facts.file = dataset.file();
  std::error_code ignored;
  facts.bytes = std::filesystem::file_size(dataset.file(), ignored);
  for (const SpaceTable& space : dataset.spaces()) {
    facts.lattice_points += space.points.size();
    facts.probes += space.probes.size();
    for (const PointRecord& point : space.points)
      facts.configurations += isSolved(point.tag) ? 1 : 0;
    for (const Probe& probe : space.probes) {
      facts.solved_probes += isSolved(probe.record.tag) ? 1 : 0;
      facts.terminating_probes += probe.record.tag == Tag::terminating ? 1 : 0;
    }
  }
  std::map<std::string, ArraySize> kinds;
  for (const ArraySize& array : arraySizes(dataset.file())) {
    ArraySize& kind = kinds[kindOf(array.path)];
    kind.stored += array.stored;
    kind.unpacked += array.unpacked;
  }
  facts.sizes.assign(kinds.begin(), kinds.end());
  std::stable_sort(facts.sizes.begin(), facts.sizes.end(),
                   [](const auto& a, const auto& b) { return a.second.stored > b.second.stored; });
  return facts;
}

std::map<Cause, FailureCount> failuresOf(const Dataset& dataset) {
  std::map<Cause, FailureCount> failures;
  for (const SpaceTable& space : dataset.spaces()) {
    for (const PointRecord& point : space.points)
      if (point.tag == Tag::failed) ++failures[point.cause].points;
    for (const FailedAttempt& attempt : space.attempts) ++failures[attempt.failure.cause].attempts;
    for (const Probe& probe : space.probes)
      if (probe.record.tag == Tag::failed) ++failures[probe.record.cause].probes;
  }
  return failures;
}

/// The datasets as they are, and the coarser lattices in them that are not another dataset already.
std::vector<LatticeMeasures> latticesIn(const std::vector<Dataset>& datasets) {
  std::vector<LatticeMeasures> lattices;
  const auto offer = [&](std::size_t dataset, std::int32_t factor) {
    const SpaceTable& space = datasets[dataset].spaces().front();
    const double spacing = std::max(factor, 1) * space.lattice.spacing();
    const bool known =
        std::any_of(lattices.begin(), lattices.end(), [&](const LatticeMeasures& other) {
          const Dataset& its = datasets[other.dataset];
          const bool refined = other.factor == 0 && its.scene().accuracy.adaptive();
          return !refined && std::abs(other.spacing - spacing) <= same_spacing * spacing;
        });
    const bool is_coarse = factor > 2 && space.lattice.radius() < smallest_ratio * spacing;
    if (factor > 0 && (known || is_coarse || !isThinnable(space.lattice, factor))) return;
    LatticeMeasures lattice;
    lattice.dataset = dataset;
    lattice.factor = factor;
    lattice.spacing = spacing;
    lattice.label = datasets[dataset].file().filename().string();
    if (factor == 1) lattice.label += ", not refined";
    if (factor > 1)
      lattice.label += fmt::format(", every {} point", factor == 2   ? "2nd"
                                                       : factor == 3 ? "3rd"
                                                                     : "4th");
    lattices.push_back(std::move(lattice));
  };
  for (std::size_t d = 0; d < datasets.size(); ++d) offer(d, 0);
  for (std::size_t d = 0; d < datasets.size(); ++d) {
    if (datasets[d].scene().accuracy.adaptive()) offer(d, 1);
    for (const std::int32_t factor : thinning_factors) offer(d, factor);
  }
  return lattices;
}

/// `count` numbers below `size`, evenly spread.
std::vector<std::size_t> evenly(std::size_t size, std::size_t count) {
  std::vector<std::size_t> chosen;
  for (std::size_t n = 0; n < std::min(size, count); ++n)
    chosen.push_back(size <= count ? n : n * size / count);
  return chosen;
}

/// Fills a Report step by step.
class Reporter {
 public:
  Reporter(std::vector<Dataset> datasets, const ReportOptions& options) : options_(options) {
    refuseOtherScenes(datasets);
    report_.open = std::move(datasets);
    report_.methods = chosenMethods(options.methods);
    for (const Dataset& dataset : report_.open) report_.datasets.push_back(factsOf(dataset));
    report_.failures = failuresOf(report_.open.front());
    setTarget();
    report_.lattices = latticesIn(report_.open);
    compared_ = evenly(spaces(), options.compared_nodes);
    report_.compared = compared_.size();
  }

  Report finish() {
    chooseReferences();
    for (LatticeMeasures& lattice : report_.lattices) measureCost(lattice);
    orderLattices();
    describeNodes();
    for (std::size_t n = 0; n < report_.lattices.size(); ++n) measureLattice(n);
    measureOtherNodes();
    return std::move(report_);
  }

 private:
  using NodeComparison = std::vector<MethodComparison>;  ///< per method

  std::vector<std::vector<Reference>>& references() { return report_.positions; }
  std::size_t spaces() const { return report_.open.front().spaces().size(); }

  void setTarget() {
    for (const Dataset& dataset : report_.open) {
      const Accuracy& accuracy = dataset.scene().accuracy;
      if (!accuracy.adaptive() || report_.target_of_scene) continue;
      report_.target = {accuracy.force_error, accuracy.force_floor};
      report_.target_of_scene = true;
    }
  }

  void chooseReferences() {
    references().resize(spaces());
    for (std::size_t s = 0; s < spaces(); ++s) {
      std::vector<const SpaceTable*> tables;
      for (const Dataset& dataset : report_.open) tables.push_back(&dataset.spaces()[s]);
      references()[s] = usableProbes(tables);
    }
    if (anyReference()) {
      report_.references = ReferenceKind::probes;
    } else {
      chooseLeftOutPoints();
      if (anyReference()) report_.references = ReferenceKind::left_out;
    }
    for (const auto& references : references()) report_.reference_count += references.size();
  }

  bool anyReference() const {
    return std::any_of(report_.positions.begin(), report_.positions.end(),
                       [](const auto& r) { return !r.empty(); });
  }

  void chooseLeftOutPoints() {
    const auto most = std::max_element(
        report_.open.begin(), report_.open.end(), [](const Dataset& a, const Dataset& b) {
          return a.spaces().front().points.size() < b.spaces().front().points.size();
        });
    source_ = static_cast<std::size_t>(most - report_.open.begin());
    if (report_.lattices.size() < 2) return;
    for (std::size_t s = 0; s < spaces(); ++s) {
      std::vector<std::optional<SpaceTable>> storage(report_.lattices.size());
      std::vector<const SpaceTable*> tables;
      for (std::size_t n = 0; n < report_.lattices.size(); ++n)
        if (!isSource(report_.lattices[n]))
          tables.push_back(&tableOf(report_, report_.lattices[n], s, storage[n]));
      references()[s] = leftOutPoints(most->spaces()[s], tables);
    }
  }

  /// The references are points of this lattice: it cannot be measured with them.
  bool isSource(const LatticeMeasures& lattice) const {
    return source_ == lattice.dataset && lattice.factor == 0;
  }
  bool isMeasurable(const LatticeMeasures& lattice) const {
    return report_.references == ReferenceKind::probes ||
           (report_.references == ReferenceKind::left_out && !isSource(lattice));
  }

  void measureCost(LatticeMeasures& lattice) const {
    std::int64_t configurations = 0, factorizations = 0;
    for (const std::size_t s : compared_) {
      std::optional<SpaceTable> storage;
      std::int64_t solved = 0;
      for (const PointRecord& point : tableOf(report_, lattice, s, storage).points) {
        if (!isSolved(point.tag)) continue;
        ++solved;
        factorizations += point.cost.factorizations;
      }
      lattice.node_configurations.push_back(solved);
      configurations += solved;
    }
    lattice.configurations =
        static_cast<double>(configurations) / static_cast<double>(compared_.size());
    lattice.factorizations =
        static_cast<double>(factorizations) / static_cast<double>(compared_.size());
  }

  void orderLattices() {
    std::stable_sort(report_.lattices.begin(), report_.lattices.end(),
                     [](const LatticeMeasures& a, const LatticeMeasures& b) {
                       return a.configurations < b.configurations;
                     });
    for (std::size_t n = 0; n < report_.lattices.size(); ++n) {
      const LatticeMeasures& lattice = report_.lattices[n];
      if (!isMeasurable(lattice)) continue;
      const bool is_first_dataset = lattice.dataset == 0 && lattice.factor == 0;
      const bool is_settled = report_.measured &&
                              report_.lattices[*report_.measured].dataset == 0 &&
                              report_.lattices[*report_.measured].factor == 0;
      if (is_first_dataset || !is_settled) report_.measured = n;
    }
  }

  void describeNodes() {
    for (std::size_t s = 0; s < spaces(); ++s) {
      const SpaceTable& space = report_.open.front().spaces()[s];
      NodeMeasures node;
      node.name = space.patch.name;
      node.space = s;
      node.references = references()[s].size();
      node.jumps = space.inconsistent_edges.size();
      for (const PointRecord& point : space.points) {
        ++node.tags[static_cast<std::size_t>(point.tag)];
        if (isSolved(point.tag))
          node.largest_force = std::max(node.largest_force, point.equilibrium.force.norm());
      }
      node.compared = std::find(compared_.begin(), compared_.end(), s) != compared_.end();
      node.methods.resize(report_.methods.size());
      report_.nodes.push_back(std::move(node));
    }
  }

  void measureLattice(std::size_t number) {
    LatticeMeasures& lattice = report_.lattices[number];
    lattice.methods.resize(report_.methods.size());
    timeMethods(lattice);
    const bool is_measurable = isMeasurable(lattice);
    spdlog::info("{}: comparing {} methods on {} active nodes", lattice.label,
                 report_.methods.size(), compared_.size());
    std::vector<NodeComparison> nodes(compared_.size());
    inParallel(compared_.size(), [&](std::size_t n) {
      std::optional<SpaceTable> storage;
      const SpaceTable& table = tableOf(report_, lattice, compared_[n], storage);
      nodes[n] =
          compareMethods(table, report_.methods,
                         is_measurable ? references()[compared_[n]] : std::vector<Reference>(),
                         n < options_.looped_nodes);
    });
    for (std::size_t m = 0; m < report_.methods.size(); ++m) pool(nodes, m, lattice.methods[m]);
    if (!is_measurable) return;
    for (std::size_t n = 0; n < compared_.size(); ++n) {
      lattice.node_errors.emplace_back();
      for (std::size_t m = 0; m < report_.methods.size(); ++m) {
        const ErrorMeasures measures = measureErrors(nodes[n][m].comparisons, report_.target);
        lattice.node_errors.back().push_back(measures.error.mean);
        if (report_.measured == number) report_.nodes[compared_[n]].methods[m] = measures;
      }
    }
  }

  /// One after the other, while nothing else runs.
  void timeMethods(LatticeMeasures& lattice) const {
    std::optional<SpaceTable> storage;
    const SpaceTable& table = tableOf(report_, lattice, compared_.front(), storage);
    for (std::size_t m = 0; m < report_.methods.size(); ++m) {
      const MethodTiming timing =
          timeMethod(table, report_.methods[m], options_.seconds_per_timing);
      lattice.methods[m].nanoseconds = timing.nanoseconds;
      lattice.methods[m].seconds_to_prepare = timing.seconds_to_prepare;
    }
  }

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
    if (!report_.measured) return;
    const LatticeMeasures& lattice = report_.lattices[*report_.measured];
    if (compared_.size() < spaces())
      spdlog::info("{}: measuring {} on the other active nodes", lattice.label,
                   report_.methods.front());
    inParallel(spaces(), [&](std::size_t s) {
      NodeMeasures& node = report_.nodes[s];
      if (node.compared) return;
      std::optional<SpaceTable> storage;
      const NodeComparison result = compareMethods(
          tableOf(report_, lattice, s, storage), {report_.methods.front()}, references()[s], false);
      node.methods.front() = measureErrors(result.front().comparisons, report_.target);
    });
  }

  ReportOptions options_;
  Report report_;
  std::vector<std::size_t> compared_;  ///< numbers of active nodes
  std::optional<std::size_t> source_;  ///< dataset whose points are the references
};

}  // namespace

const SpaceTable& tableOf(const Report& report, const LatticeMeasures& lattice, std::size_t space,
                          std::optional<SpaceTable>& storage) {
  const SpaceTable& whole = report.open[lattice.dataset].spaces()[space];
  if (lattice.factor == 0) return whole;
  storage = thinned(whole, lattice.factor);
  return *storage;
}

Report makeReport(const ReportOptions& options) {
  std::vector<Dataset> datasets;
  for (const std::filesystem::path& file : options.datasets) datasets.emplace_back(file);
  return makeReport(std::move(datasets), options);
}

Report makeReport(std::vector<Dataset> datasets, const ReportOptions& options) {
  if (datasets.empty()) throw badInput("a report needs at least one dataset");
  return Reporter(std::move(datasets), options).finish();
}

}  // namespace palpate
