#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/dataset/dataset.hpp"
#include "viewer/report/dataset_sizes.hpp"
#include "viewer/report/error_measures.hpp"
#include "viewer/report/references.hpp"

namespace palpate {

struct ReportOptions {
  /// At least one; several must be of one scene, with other spacings or accuracies.
  std::vector<std::filesystem::path> datasets;
  std::vector<std::string> methods;  ///< empty: all
  double seconds_per_timing =
      0.05;  ///< how long queries are repeated to time one method on one lattice
  /// Active nodes on which all methods are compared, evenly chosen where there are more; the
  /// default method is measured on all.
  std::size_t compared_nodes = 12;
  /// Of these, nodes on which work around closed loops is measured; a few seconds each.
  std::size_t looped_nodes = 2;
};

/// One method on one lattice, over the compared active nodes together.
struct MethodMeasures {
  std::string problem;    ///< why it could not be made for some active node; empty when it could
  ErrorMeasures all;      ///< over the whole ball
  ErrorMeasures covered;  ///< over covered points alone: the same points for every method
  /// Work around closed loops relative to the effort (loop_work.hpp): the largest of
  /// ReportOptions::looped_nodes.
  double loop_work = std::numeric_limits<double>::quiet_NaN();
  double nanoseconds =
      std::numeric_limits<double>::quiet_NaN();  ///< per query, median, this machine
  double seconds_to_prepare = nanoseconds;       ///< of one active node, this machine
};

/// One lattice: a dataset, or a part of it that is a coarser lattice.
struct LatticeMeasures {
  std::size_t dataset = 0;              ///< index into Report::datasets
  std::int32_t factor = 0;              ///< 0: the dataset as it is; else thinned by this factor
  std::string label;                    ///< "liver.h5", "liver.h5, every 2nd point"
  double spacing = 0;                   ///< m
  double configurations = 0;            ///< solved points per active node, mean of the compared
  double factorizations = 0;            ///< the work they took, per active node
  std::vector<MethodMeasures> methods;  ///< in the order of Report::methods
  std::vector<std::int64_t> node_configurations;  ///< solved points, per compared active node
  /// Mean error over the whole ball, N: per compared active node, in the order of Report::nodes,
  /// per method.
  std::vector<std::vector<double>> node_errors;
};

/// One active node.
struct NodeMeasures {
  std::string name;
  std::size_t space = 0;               ///< index into Dataset::spaces() of the first dataset
  std::array<std::int32_t, 4> tags{};  ///< lattice points, by Tag
  std::size_t references = 0;
  std::size_t jumps = 0;               ///< lattice edges whose ends are on different branches
  double largest_force = 0;            ///< N, of a solved lattice point
  bool compared = false;               ///< else only the default method was measured
  std::vector<ErrorMeasures> methods;  ///< on the measured lattice, in the order of Report::methods
};

struct DatasetFacts {
  std::filesystem::path file;
  std::uintmax_t bytes = 0;
  std::size_t configurations = 0;  ///< solved lattice points, all active nodes
  std::size_t lattice_points = 0;
  std::size_t probes = 0, solved_probes = 0, terminating_probes = 0;
  std::vector<std::pair<std::string, ArraySize>>
      sizes;  ///< what is stored, summed over active nodes
};

/// Failures of the first dataset, by cause.
struct FailureCount {
  std::int64_t points = 0;    ///< lattice points that stayed without a solution
  std::int64_t attempts = 0;  ///< transitions that failed; another may have reached the point
  std::int64_t probes = 0;
};

/// Everything `palpate report` says, measured. Writers (report_text, report_json, report_page) only
/// format.
struct Report {
  std::vector<Dataset> open;  ///< the datasets, as given
  std::vector<DatasetFacts> datasets;
  std::vector<std::string> methods;  ///< the default first
  AccuracyTarget target;
  bool target_of_scene = false;  ///< else the target is only a measuring stick
  ReferenceKind references = ReferenceKind::none;
  std::size_t reference_count = 0;        ///< all active nodes
  std::vector<LatticeMeasures> lattices;  ///< from few configurations to many
  /// Index into lattices of the one that stands for the dataset: the first dataset as it is when
  /// there are probes, else its densest part that leaves something out. Nothing when nothing can be
  /// measured.
  std::optional<std::size_t> measured;
  std::vector<NodeMeasures> nodes;
  std::size_t compared = 0;  ///< active nodes on which all methods were compared
  std::map<Cause, FailureCount> failures;
  std::vector<std::vector<Reference>> positions;  ///< the references, per active node
};

/// Opens the datasets and measures. Takes seconds to two minutes; uses all cores for the
/// comparison, one for the timings. Error (bad input) for a dataset that cannot be opened, datasets
/// of different scenes, and unknown methods.
Report makeReport(const ReportOptions& options);
/// The same of datasets that are open already; options.datasets is not looked at.
Report makeReport(std::vector<Dataset> datasets, const ReportOptions& options);

/// The table that stands for lattice `lattice` of the report at active node `space`. `storage`
/// keeps it alive when it has to be made.
const SpaceTable& tableOf(const Report& report, const LatticeMeasures& lattice, std::size_t space,
                          std::optional<SpaceTable>& storage);

}  // namespace palpate
