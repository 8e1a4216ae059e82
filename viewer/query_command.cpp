#include "viewer/query_command.hpp"

#include <CLI/CLI.hpp>
#include <cmath>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "common/base/displacement_input.hpp"
#include "common/dataset/dataset.hpp"
#include "viewer/fields/field_choice.hpp"

namespace palpate {
namespace {

/// Zero without its sign: -0 means nothing to a reader.
template <class Derived>
auto plain(const Eigen::MatrixBase<Derived>& values) {
  return (values.array() + 0.0).matrix().eval();
}

nlohmann::ordered_json toJson(const Eigen::Vector3d& v) { return {v[0], v[1], v[2]}; }

std::string describeJson(const Eigen::Vector3d& displacement, const ForceSample& sample,
                         std::string_view method) {
  nlohmann::ordered_json answer;  // prints what is not finite as null
  answer["displacement"] = toJson(displacement);
  answer["force"] = toJson(sample.force);
  for (int row = 0; row < 3; ++row)
    answer["stiffness"].push_back(toJson(sample.stiffness.row(row)));
  answer["energy"] = sample.energy + 0.0;
  answer["error_bound"] = sample.error_bound;
  answer["coverage"] = sample.coverage;
  answer["inside"] = sample.inside;
  answer["method"] = method;
  return answer.dump() + '\n';
}

/// Why a displacement is not inside, and what the answer is then, for a person.
std::string describeOutside(const Lattice& lattice, const Eigen::Vector3d& displacement) {
  if (displacement.stableNorm() > lattice.radius())
    return fmt::format(
        "|displacement| = {:.6g} m is beyond the workspace radius {:.6g} m.\n"
        "              The values are those at the nearest point of the workspace ball",
        displacement.stableNorm(), lattice.radius());
  return "none of the lattice points around it was solved.\n"
         "              The values are an extrapolation";
}

/// What is missing around a displacement in the ball, for a person; of the uniform lattice.
std::string describeGaps(const SpaceTable& space, const Eigen::Vector3d& displacement) {
  const Lattice& lattice = space.lattice;
  int beyond = 0;
  std::string gaps;
  for (int c = 0; c < 8; ++c) {
    LatticePoint corner{};
    for (int axis = 0; axis < 3; ++axis)
      corner[axis] =
          lattice.divisions() *
          (static_cast<int>(std::floor(displacement[axis] / lattice.spacing())) + (c >> axis & 1));
    const auto number = lattice.indexOf(corner);
    // Corners of the cell that are no lattice point lie outside of the ball.
    beyond += number ? 0 : 1;
    if (!number || isSolved(space.points[*number].tag)) continue;
    const PointRecord& point = space.points[*number];
    gaps += fmt::format(", ({}, {}, {}) {}", corner[0], corner[1], corner[2], name(point.tag));
    if (point.tag == Tag::failed) gaps += fmt::format(" ({})", name(point.cause));
  }
  if (beyond > 0)
    gaps += fmt::format(", {} of 8 corners beyond the rim of the workspace ball", beyond);
  return gaps;
}

std::string describeForPerson(const SpaceTable& space, const Eigen::Vector3d& displacement,
                              const ForceSample& sample, std::string_view method) {
  std::string text = fmt::format("displacement  {:11.6g} {:11.6g} {:11.6g}  m\n", displacement.x(),
                                 displacement.y(), displacement.z());
  text += fmt::format("force         {:11.6g} {:11.6g} {:11.6g}  N    |force| = {:.6g} N\n",
                      sample.force.x(), sample.force.y(), sample.force.z(), sample.force.norm());
  for (int i = 0; i < 3; ++i)
    text += fmt::format("{}{:11.6g} {:11.6g} {:11.6g}  N/m\n",
                        i == 0 ? "stiffness     " : "              ", sample.stiffness(i, 0),
                        sample.stiffness(i, 1), sample.stiffness(i, 2));
  if (std::isfinite(sample.error_bound))
    text +=
        fmt::format("error bound   {:11.4g}  N, on |force|, estimated to hold at 99 % of places\n",
                    sample.error_bound);
  if (!sample.inside)
    return text +
           fmt::format("inside        NO: {}.\n\n", describeOutside(space.lattice, displacement));
  text += fmt::format("inside        yes, method {}", method);
  if (sample.coverage < 1)
    text += fmt::format("; {:.0f} % of it stands on solved lattice points of one branch{}",
                        100 * sample.coverage, describeGaps(space, displacement));
  return text + "\n\n";
}

const SpaceTable& spaceToQuery(const Dataset& dataset, const std::string& active) {
  if (!active.empty()) return dataset.spaces()[dataset.spaceNamed(active)];
  if (dataset.spaces().size() == 1) return dataset.spaces()[0];
  std::vector<std::string> names;
  for (const SpaceTable& space : dataset.spaces()) names.push_back(space.patch.name);
  throw badInput("{}: has several active nodes; choose one with --active: {}",
                 dataset.file().string(), fmt::join(names, ", "));
}

std::function<ExitCode()> prepareQuery(CLI::App& app) {
  auto options = std::make_shared<QueryOptions>();
  app.add_option("DATASET", options->dataset, "Sealed dataset, OUT.h5, as palpate build makes it")
      ->required()
      ->type_name("FILE");
  app.add_option("--active", options->active, "Active node; not needed when there is only one")
      ->type_name("NAME");
  addDisplacementOption(app, options->displacement);
  app.add_option("--method", options->method,
                 fmt::format("Interpolation: {}", fmt::join(forceFieldMethods(), " or ")))
      ->capture_default_str();
  app.add_flag("--json", options->json, "One JSON object per line (docs/commands.md)");
  app.footer(
      "Prints the force on the tool in N and the stiffness d force / d displacement in N/m.\n"
      "coverage (--json): share of the answer that stands on solved lattice points of one branch.\n"
      "Exit codes: 0 done, 1 failed, 2 wrong usage, "
      "3 some displacement lies outside of the workspace ball, or\n"
      "where nothing around was solved (it is answered all the same, and marked), "
      "130 interrupted.");
  return [options] { return query(*options, std::cin, std::cout); };
}

}  // namespace

ExitCode query(const QueryOptions& options, std::istream& input, std::ostream& output) {
  const Dataset dataset(options.dataset);
  const SpaceTable& space = spaceToQuery(dataset, options.active);
  const std::unique_ptr<ForceField> field = makeForceField(options.method, space);
  ExitCode code = ExitCode::done;
  const auto answer = [&](const Eigen::Vector3d& displacement) {
    ForceSample sample = field->evaluate(displacement);
    sample.force = plain(sample.force);
    sample.stiffness = plain(sample.stiffness);
    if (!sample.inside) code = ExitCode::partly_failed;
    // At once: whoever asks line by line waits for each answer.
    output << (options.json ? describeJson(displacement, sample, field->name())
                            : describeForPerson(space, displacement, sample, field->name()))
           << std::flush;
    if (!output) throw failure("cannot write the answer to standard output");
  };
  forEachTouch({}, options.displacement, input, space.lattice.radius(),
               [&](const Touch& touch) { answer(touch.displacement); });
  return code;
}

Verb queryVerb() {
  return {"query", "Interpolated force and stiffness at displacements of an active node",
          prepareQuery};
}

}  // namespace palpate
