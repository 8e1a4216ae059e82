#pragma once

#include "viewer/report/area_measures.hpp"
#include "viewer/report/compared_lattice.hpp"
#include "viewer/report/dataset_facts.hpp"
#include "viewer/report/field_comparison.hpp"
#include "viewer/report/node_pictures.hpp"
#include "viewer/report/way_measures.hpp"

namespace palpate {

struct ReportOptions {
  /// At least one; several must be of one scene and may differ in spacing or accuracy.
  std::vector<std::filesystem::path> datasets;
  std::vector<std::string> methods;  ///< empty: all
  /// Time for repeated queries of one method on one lattice, s.
  double seconds_per_timing = 0.05;
  /// Largest number of active nodes on which all methods are compared, evenly chosen. The default
  /// method is measured on all nodes.
  std::size_t compared_nodes = 12;  ///< > 0
  /// Number of these nodes, the first ones, on which work around closed loops is measured; a few
  /// seconds each.
  std::size_t looped_nodes = 2;
  /// Number of active nodes with pictures on the page, the worst first. Sampling their fields takes
  /// some tenths of a second each.
  std::size_t pictured_nodes = 0;
};

/// One method on one lattice, pooled over the compared active nodes; timed on one of them.
struct MethodMeasures : MethodTiming {
  std::string problem{};    ///< why the method failed for an active node; otherwise empty
  ErrorMeasures all{};      ///< over the whole ball
  ErrorMeasures covered{};  ///< over covered points only, the same points for every method
  /// Work around closed loops relative to the effort (loopWork): the largest over
  /// ReportOptions::looped_nodes.
  double loop_work = not_measured;
};

/// Measurements on one lattice.
struct LatticeMeasures : ComparedLattice {
  double configurations = 0;                      ///< solved points, mean per compared active node
  double factorizations = 0;                      ///< spent on these points, per active node
  std::vector<MethodMeasures> methods;            ///< in the order of Report::methods
  std::vector<std::int64_t> node_configurations;  ///< solved points, per compared active node
  /// Mean error over the whole ball, N: [compared active node][method].
  std::vector<std::vector<double>> node_errors;
};

/// One active node.
struct NodeMeasures {
  std::string name;
  std::array<std::int32_t, 4> tags{};  ///< lattice points, by Tag
  std::size_t held_out = 0;            ///< exact solutions to measure it with
  std::size_t jumps = 0;               ///< lattice edges whose ends are on different branches
  double largest_force = 0;            ///< N, over solved lattice points
  /// Error bound of the default method over the whole ball, on the shown lattice, N; all NaN
  /// without pictures.
  Spread bound;
  /// Index among the compared active nodes. On the others only the default method is measured.
  std::optional<std::size_t> compared;
  std::vector<ErrorMeasures> methods;  ///< on the measured lattice, in the order of Report::methods
};

/// All measurements of `palpate report`. Its writers only format them (report_text.hpp,
/// report_json.hpp, report_page.hpp).
struct Report {
  std::vector<Dataset> open;  ///< the datasets, as given
  std::vector<DatasetFacts> datasets;
  std::vector<std::string> methods;  ///< the default first
  AccuracyTarget target;
  bool target_of_scene = false;  ///< false: the target is only a yardstick
  HeldOut held_out;
  std::vector<LatticeMeasures> lattices;  ///< from few configurations to many
  /// Index into `lattices` of the lattice that represents the dataset. This is the first dataset as
  /// it is if there are probes, else its densest part that leaves points out. Empty if nothing can
  /// be measured.
  std::optional<std::size_t> measured;
  /// Errors on the measured lattice, by distance from rest. Empty if nothing can be measured, or if
  /// areas_alone.
  std::vector<WayShell> ways;
  std::vector<AreaMeasures> areas;  ///< areas of fingers, in the first dataset
  /// Everything touchable is an area of a finger. A user does not feel a single site there, so
  /// methods are compared on one site only, and text and page omit the comparison.
  bool areas_alone = false;
  std::vector<NodeMeasures> nodes;         ///< all, in the order of Dataset::spaces()
  std::size_t compared = 0;                ///< number of active nodes with all methods compared
  std::map<Cause, FailureCount> failures;  ///< of the first dataset
  std::vector<NodePictures> pictures;      ///< of the first nodes of worstFirst()
};

/// Measures the datasets `open`; ignores ReportOptions::datasets. Takes seconds to two minutes, on
/// all cores for the comparison and on one for the timings. Throws Error (bad input) for datasets
/// of different scenes and for unknown methods.
Report makeReport(const ReportOptions& options, std::vector<Dataset> open);

/// Opens datasets. Throws Error (bad input) if one cannot be opened or `files` is empty.
std::vector<Dataset> openDatasets(const std::vector<std::filesystem::path>& files);

/// Returns the lattice for pictures and summaries: the measured one, else the first dataset as it
/// is.
const LatticeMeasures& shownLattice(const Report& report);

/// Returns the indices of all active nodes by the mean error of the default method: the largest
/// first, unmeasured nodes last.
std::vector<std::size_t> worstFirst(const Report& report);

}  // namespace palpate
