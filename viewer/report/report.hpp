#pragma once

#include "viewer/report/area_measures.hpp"
#include "viewer/report/compared_lattice.hpp"
#include "viewer/report/dataset_facts.hpp"
#include "viewer/report/field_comparison.hpp"
#include "viewer/report/node_pictures.hpp"

namespace palpate {

struct ReportOptions {
  /// At least one. Several datasets must be of one scene, but may differ in spacing or accuracy.
  std::vector<std::filesystem::path> datasets;
  std::vector<std::string> methods;  ///< empty: all
  /// Time that is spent on timing the queries of one method on one lattice, s.
  double seconds_per_timing = 0.05;
  /// Largest number of active nodes on which all methods are compared; they are chosen evenly. The
  /// default method is measured on all nodes.
  std::size_t compared_nodes = 12;  ///< > 0
  /// Number of compared nodes on which the work around closed loops is measured, beginning with the
  /// first. Takes a few seconds per node.
  std::size_t looped_nodes = 2;
  /// Number of active nodes that have pictures on the page. The nodes with the largest errors come
  /// first. Sampling takes a few tenths of a second per node.
  std::size_t pictured_nodes = 0;
};

/// Results of one method on one lattice. Errors are pooled over the compared active nodes; times
/// are measured on one of them.
struct MethodMeasures : MethodTiming {
  std::string problem{};    ///< why the method failed for an active node; otherwise empty
  ErrorMeasures all{};      ///< over the whole ball
  ErrorMeasures covered{};  ///< over the covered points, which are the same for every method
  /// Largest relative work around closed loops (loopWork) on the ReportOptions::looped_nodes nodes.
  double loop_work = not_measured;
};

/// Measurements of all methods on one lattice.
struct LatticeMeasures : ComparedLattice {
  double configurations = 0;                      ///< number of solved points, mean over the
                                                  ///< compared active nodes
  double factorizations = 0;                      ///< number of factorisations for these points,
                                                  ///< per active node
  std::vector<MethodMeasures> methods;            ///< in the order of Report::methods
  std::vector<std::int64_t> node_configurations;  ///< number of solved points of each compared
                                                  ///< active node
  /// Mean error over the whole ball, N: [compared active node][method].
  std::vector<std::vector<double>> node_errors;
};

/// Measurements of one active node.
struct NodeMeasures {
  std::string name;
  std::array<std::int32_t, 4> tags{};  ///< number of lattice points with each Tag
  std::size_t held_out = 0;            ///< number of exact solutions that test it
  std::size_t jumps = 0;               ///< number of inconsistent lattice edges
  double largest_force = 0;            ///< N, largest at any solved lattice point
  /// Error bound of the default method over the whole ball, on the shown lattice, N; all NaN in a
  /// report without pictures.
  Spread bound;
  /// Index of this node among the compared ones; empty if only the default method is measured on
  /// it.
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
  bool target_of_scene = false;  ///< true if a scene sets the target; otherwise it is a default
  HeldOut held_out;
  std::vector<LatticeMeasures> lattices;  ///< ascending in the number of configurations
  /// Index into `lattices` of the lattice whose errors represent the dataset. It has all points of
  /// the first dataset or, if these include the held-out solutions, it is the densest lattice
  /// without them. Empty if no errors can be measured.
  std::optional<std::size_t> measured;
  /// Errors on the measured lattice, by distance from rest. Empty if no errors can be measured, or
  /// if areas_alone.
  std::vector<ErrorShell> shells;
  std::vector<AreaMeasures> areas;  ///< areas of fingers, in the first dataset
  /// Whether everything touchable belongs to the area of a finger. A user then never feels a
  /// single site. Methods are therefore compared on one site only, and text and page omit the
  /// comparison.
  bool areas_alone = false;
  std::vector<NodeMeasures> nodes;         ///< all, in the order of Dataset::spaces()
  std::size_t compared = 0;                ///< number of active nodes on which all methods are
                                           ///< compared
  std::map<Cause, FailureCount> failures;  ///< of the first dataset
  std::vector<NodePictures> pictures;      ///< of the first nodes of worstFirst()
};

/// Measures the datasets `open`; ReportOptions::datasets is ignored. Takes seconds to two minutes.
/// The comparison uses all cores, the timings use one. Throws Error (bad input) for datasets of
/// different scenes and for unknown methods.
Report makeReport(const ReportOptions& options, std::vector<Dataset> open);

/// Returns the methods `asked` for, each once; all methods if `asked` is empty. Throws Error (bad
/// input) for an unknown method.
std::vector<std::string> chosenMethods(const std::vector<std::string>& asked);

/// Returns the lattice for pictures and summaries: the measured lattice if there is one, otherwise
/// that of all points of the first dataset.
const LatticeMeasures& shownLattice(const Report& report);

/// Returns the indices of all active nodes, ordered by the mean error of the default method. The
/// largest error comes first, and nodes without a measured error come last.
std::vector<std::size_t> worstFirst(const Report& report);

}  // namespace palpate
