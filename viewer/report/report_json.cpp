#include "viewer/report/report_json.hpp"

#include "common/base/assertion.hpp"
#include "common/space/failure.hpp"
#include "viewer/report/comparison.hpp"
#include "viewer/report/report.hpp"
#include "viewer/report/run_accuracy.hpp"

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

Json toJson(const Spread& spread) {
  return {{"mean", spread.mean},
          {"rms", spread.rms},
          {"median", spread.median},
          {"percentile_95", spread.percentile_95},
          {"percentile_99", spread.percentile_99},
          {"maximum", spread.maximum}};
}

Json toJson(const ErrorMeasures& measures) {
  return {{"count", measures.count},
          {"error", toJson(measures.error)},
          {"relative", toJson(measures.relative)},
          {"mean_component", measures.mean_component},
          {"max_component", measures.max_component},
          {"mean_relative_component", measures.mean_relative_component},
          {"max_relative_component", measures.max_relative_component},
          {"relative_to_mean_force", measures.relative_to_mean_force},
          {"within_target", measures.within_target},
          {"covered", measures.covered},
          {"bounds", measures.bounds},
          {"bound_holds", measures.bound_holds},
          {"bound_over_error", measures.bound_over_error.median},
          {"bound_over_error_95", measures.bound_over_error.percentile_95}};
}

Json datasetJson(const Dataset& dataset, const DatasetFacts& facts) {
  const SpaceTable& space = dataset.spaces().front();
  Json sizes = Json::object();
  for (const auto& [kind, stored, unpacked] : facts.sizes)
    sizes[kind] = {{"stored", stored}, {"unpacked", unpacked}};
  return {{"file", dataset.file().string()},
          {"content_hash", dataset.contentId().hex()},
          {"build_id", dataset.buildId().hex()},
          {"kernel_family", dataset.kernelFamily()},
          {"radius", space.lattice.radius()},
          {"spacing", space.lattice.spacing()},
          {"lattice_points", facts.lattice_points},
          {"configurations", facts.configurations},
          {"probes", facts.probes.all},
          {"probes_within_max_force", facts.probes.within_force},
          {"probes_beyond_max_force", facts.probes.beyond_force},
          {"bytes", facts.bytes},
          {"bytes_per_configuration", static_cast<double>(facts.bytes) / facts.configurations},
          {"arrays", sizes}};
}

/// Returns an object with the results of each method; null results are left out.
template <class Results, class ToJson>
Json byMethod(const Report& report, const std::vector<Results>& of_methods, const ToJson& toJson) {
  PALPATE_ASSERT(of_methods.size() == report.methods.size(), "each method must have results");
  Json all = Json::object();
  for (std::size_t m = 0; m < of_methods.size(); ++m)
    if (Json one = toJson(of_methods[m]); !one.is_null()) all[report.methods[m]] = std::move(one);
  return all;
}

Json methodJson(const MethodMeasures& method) {
  return {{"problem", method.problem.empty() ? Json(nullptr) : Json(method.problem)},
          {"loop_work", method.loop_work},
          {"nanoseconds_per_query", method.nanoseconds},
          {"seconds_to_prepare", method.seconds_to_prepare},
          {"whole_ball", toJson(method.all)},
          {"covered_points", toJson(method.covered)}};
}

Json latticeJson(const Report& report, const LatticeMeasures& lattice) {
  return {{"label", lattice.label},
          {"dataset", lattice.dataset},
          {"factor", lattice.factor},
          {"spacing", lattice.spacing},
          {"configurations_per_node", lattice.configurations},
          {"factorizations_per_node", lattice.factorizations},
          {"methods", byMethod(report, lattice.methods, methodJson)}};
}

Json shellJson(const Report& report, const ErrorShell& shell) {
  const auto errorsOf = [](const ErrorMeasures& errors) { return toJson(errors); };
  return {{"from", shell.from},
          {"to", shell.to},
          {"methods", byMethod(report, shell.methods, errorsOf)}};
}

Json nodeJson(const Report& report, const NodeMeasures& node) {
  // If the methods are not compared on a node, only the default method is measured.
  const auto measured = [](const ErrorMeasures& errors) {
    return errors.count > 0 ? toJson(errors) : Json();
  };
  Json tags = Json::object();
  for (std::size_t tag = 0; tag < node.tags.size(); ++tag)
    tags[std::string(name(static_cast<Tag>(tag)))] = node.tags[tag];
  return {{"name", node.name},
          {"points", tags},
          {"inconsistent_edges", node.jumps},
          {"references", node.held_out},
          {"largest_force", node.largest_force},
          {"methods", byMethod(report, node.methods, measured)}};
}

Json areaJson(const AreaMeasures& area) {
  Json depths = Json::array();
  for (const DepthMeasures& depth : area.depths)
    depths.push_back({{"depth", depth.depth},
                      {"relative_bound", toJson(depth.bound)},
                      {"force", depth.force},
                      {"exact", depth.exact},
                      {"relative_error", toJson(depth.error)}});
  return {{"name", area.name},
          {"sites", area.sites},
          {"collocation_points", area.collocation_points},
          {"seconds_to_prepare", area.seconds_to_prepare},
          {"nanoseconds_per_query", area.nanoseconds},
          {"samples", area.samples},
          {"relative_bound", toJson(area.bound)},
          {"depths", depths},
          {"inconsistent_edges", area.jumps},
          {"probes",
           {{"places", area.probes.counts.all},
            {"beyond_max_force", area.probes.counts.beyond_force},
            {"not_reached", area.probes.counts.unsolved()},
            {"not_answered", area.probes.unanswered},
            {"relative_error", toJson(area.probes.error)},
            {"area", toJson(area.probes.area)},
            {"nearest_site", toJson(area.probes.nearest_site)}}}};
}

Json sideJson(const ComparedSide& side) {
  return {{"stiffness", side.stiffness},
          {"mean_force", side.mean_force},
          {"largest_force", side.largest_force},
          {"mean_error_bound", side.mean_bound}};
}

Json placeJson(const ComparedPlace& place) {
  return {{"name", place.name},
          {"apart", place.apart},
          {"displacements", place.displacements},
          {"first", sideJson(place.sides[0])},
          {"second", sideJson(place.sides[1])},
          {"difference",
           {{"mean", place.difference.mean},
            {"median", place.difference.median},
            {"percentile_95", place.difference.percentile_95},
            {"maximum", place.difference.maximum},
            {"relative", place.relative}}}};
}

Json toJson(const AccuracyTarget& target) {
  return {{"force_error", target.force_error}, {"force_floor", target.force_floor}};
}

Json intervalsJson(const std::vector<RunInterval>& intervals) {
  Json all = Json::array();
  for (const auto& [from, to, errors] : intervals)
    all.push_back({{"from", from}, {"to", to}, {"errors", toJson(errors)}});
  return all;
}

}  // namespace

Json toJson(const Report& report) {
  PALPATE_ASSERT(report.open.size() == report.datasets.size(), "each dataset must be described");
  Json json;
  json["scene"] = report.open.front().scene().name;
  for (std::size_t d = 0; d < report.open.size(); ++d)
    json["datasets"].push_back(datasetJson(report.open[d], report.datasets[d]));
  json["references"] = {{"kind", name(report.held_out.kind)}, {"count", report.held_out.count}};
  json["target"] = toJson(report.target);
  json["target"]["of_scene"] = report.target_of_scene;
  json["relative_error_floor"] = relative_error_floor;
  json["methods"] = report.methods;
  json["compared_nodes"] = report.compared;
  json["measured_lattice"] = report.measured ? Json(*report.measured) : Json(nullptr);
  for (const LatticeMeasures& lattice : report.lattices)
    json["lattices"].push_back(latticeJson(report, lattice));
  json["ways"] = Json::array();
  for (const ErrorShell& shell : report.shells) json["ways"].push_back(shellJson(report, shell));
  for (const NodeMeasures& node : report.nodes) json["nodes"].push_back(nodeJson(report, node));
  json["areas"] = Json::array();
  for (const AreaMeasures& area : report.areas) json["areas"].push_back(areaJson(area));
  json["failures"] = Json::object();
  for (const auto& [cause, count] : report.failures)
    json["failures"][std::string(name(cause))] = {
        {"points", count.points}, {"attempts", count.attempts}, {"probes", count.probes}};
  return json;
}

Json toJson(const Comparison& comparison) {
  Json json;
  for (const Dataset& dataset : comparison.open)
    json["compared"].push_back(dataset.file().string());
  json["method"] = comparison.method;
  json["differences"] = comparison.differences;
  for (const auto& [name, first, second] : comparison.properties)
    json["properties"][name] = {first, second};
  json["common_nodes"] = comparison.common;
  for (const ComparedPlace& place : comparison.places) json["nodes"].push_back(placeJson(place));
  json["limits"] = comparison.limits;
  return json;
}

Json toJson(const RunAccuracy& run) {
  return {{"recording", run.recording.string()},
          {"scene", run.scene},
          {"ticks", run.ticks},
          {"touching", run.touching},
          {"held", run.held},
          {"unsolved", run.unsolved},
          {"target", toJson(run.target)},
          {"relative_error_floor", relative_error_floor},
          {"all", toJson(run.all)},
          {"times", intervalsJson(run.times)},
          {"in_contact", intervalsJson(run.in_contact)},
          {"speeds", intervalsJson(run.speeds)}};
}

std::string jsonText(const Json& json) {
  // JSON must be UTF-8, but a file name need not be.
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + '\n';
}

}  // namespace palpate
