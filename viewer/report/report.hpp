#pragma once

#include "viewer/report/area_measures.hpp"
#include "viewer/report/compared_lattice.hpp"
#include "viewer/report/dataset_facts.hpp"
#include "viewer/report/field_comparison.hpp"
#include "viewer/report/node_pictures.hpp"
#include "viewer/report/way_measures.hpp"

namespace palpate {

struct ReportOptions {
  /// At least one; several must be of one scene, with other spacings or accuracies.
  std::vector<std::filesystem::path> datasets;
  std::vector<std::string> methods;  ///< empty: all
  /// How long queries are repeated to time one method on one lattice.
  double seconds_per_timing = 0.05;
  /// Active nodes on which all methods are compared, evenly chosen where there are more; the
  /// default method is measured on all.
  std::size_t compared_nodes = 12;  ///< > 0
  /// Of these, nodes on which work around closed loops is measured; a few seconds each.
  std::size_t looped_nodes = 2;
  /// Active nodes, the worst first, whose fields are sampled for the pictures of the page; some
  /// tenths of a second each.
  std::size_t pictured_nodes = 0;
};

/// One method on one lattice, over the compared active nodes together; timed on one of them.
struct MethodMeasures : MethodTiming {
  std::string problem{};    ///< why it could not be made for some active node; empty when it could
  ErrorMeasures all{};      ///< over the whole ball
  ErrorMeasures covered{};  ///< over covered points alone: the same points for every method
  /// Work around closed loops relative to the effort (loopWork): the largest of
  /// ReportOptions::looped_nodes.
  double loop_work = not_measured;
};

/// What was measured on a lattice.
struct LatticeMeasures : ComparedLattice {
  double configurations = 0;            ///< solved points per active node, mean of the compared
  double factorizations = 0;            ///< the work they took, per active node
  std::vector<MethodMeasures> methods;  ///< in the order of Report::methods
  std::vector<std::int64_t> node_configurations;  ///< solved points, per compared active node
  /// Mean error over the whole ball, N: per compared active node, per method.
  std::vector<std::vector<double>> node_errors;
};

/// One active node.
struct NodeMeasures {
  std::string name;
  std::array<std::int32_t, 4> tags{};  ///< lattice points, by Tag
  std::size_t held_out = 0;            ///< exact solutions that it is measured with
  std::size_t jumps = 0;               ///< lattice edges whose ends are on different branches
  double largest_force = 0;            ///< N, of a solved lattice point
  /// N, error bound of the default method all over the ball, on the shown lattice; all NaN unless
  /// there are pictures.
  Spread bound;
  /// Its number among the compared active nodes; on the others only the default method was
  /// measured.
  std::optional<std::size_t> compared;
  std::vector<ErrorMeasures> methods;  ///< on the measured lattice, in the order of Report::methods
};

/// Everything `palpate report` says, measured; its writers only format (report_text.hpp,
/// report_json.hpp, report_page.hpp).
struct Report {
  std::vector<Dataset> open;  ///< the datasets, as given
  std::vector<DatasetFacts> datasets;
  std::vector<std::string> methods;  ///< the default first
  AccuracyTarget target;
  bool target_of_scene = false;  ///< else the target is only a measuring stick
  HeldOut held_out;
  std::vector<LatticeMeasures> lattices;  ///< from few configurations to many
  /// Index into lattices of the one that stands for the dataset: the first dataset as it is when
  /// there are probes, else its densest part that leaves something out. Nothing when nothing can be
  /// measured.
  std::optional<std::size_t> measured;
  /// Of the measured lattice, by distance from rest; empty when nothing can be measured, and of
  /// areas alone.
  std::vector<WayShell> ways;
  std::vector<AreaMeasures> areas;  ///< of fingers, of the first dataset
  /// All that can be touched are fingers' areas. What their sites are as active nodes is not what
  /// is felt: methods are compared on one of them only, and text and page leave it out.
  bool areas_alone = false;
  std::vector<NodeMeasures> nodes;         ///< all, as Dataset::spaces()
  std::size_t compared = 0;                ///< active nodes on which all methods were compared
  std::map<Cause, FailureCount> failures;  ///< of the first dataset
  std::vector<NodePictures> pictures;      ///< of the first of worstFirst()
};

/// Measures the datasets `open`; ReportOptions::datasets is not looked at. Takes seconds to two
/// minutes; uses all cores for the comparison, one for the timings. Error (bad input) for datasets
/// of different scenes, and unknown methods.
Report makeReport(const ReportOptions& options, std::vector<Dataset> open);

/// Error (bad input) for one that cannot be opened, or when there is none.
std::vector<Dataset> openDatasets(const std::vector<std::filesystem::path>& files);

/// The lattice that pictures and summaries speak of: the measured one, else the first dataset as it
/// is.
const LatticeMeasures& shownLattice(const Report& report);

/// Numbers of all active nodes, by the mean error of the default method: the largest first, those
/// without one last.
std::vector<std::size_t> worstFirst(const Report& report);

}  // namespace palpate
