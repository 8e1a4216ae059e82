#include "viewer/query/query_command.hpp"

#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>

#include "common/base/assertion.hpp"
#include "common/base/required_option.hpp"
#include "common/dataset/dataset.hpp"
#include "viewer/answers/force_answers.hpp"
#include "viewer/fields/field_choice.hpp"

namespace palpate {
namespace {

nlohmann::ordered_json toJson(const Eigen::Vector3d& v) { return {v[0], v[1], v[2]}; }

std::string describeJson(const ForceAnswer& given, const Eigen::Vector3d& displacement,
                         const std::string& method) {
  const auto& [sample, place] = given;
  nlohmann::ordered_json answer;  // prints numbers that are not finite as null
  answer["displacement"] = toJson(displacement);
  answer["force"] = toJson(sample.force);
  for (int row = 0; row < 3; ++row)
    answer["stiffness"].push_back(toJson(sample.stiffness.row(row)));
  answer["energy"] = sample.energy;
  answer["error_bound"] = sample.error_bound;
  answer["coverage"] = sample.coverage;
  answer["inside"] = sample.inside;
  answer["method"] = method;
  if (place) {
    answer["at"] = toJson(place->at);
    answer["drive"] = toJson(place->drive);
    answer["distance"] = place->distance;
  }
  return answer.dump() + '\n';
}

/// Explains why a displacement is outside the answered region, and how the force continues there.
std::string describeOutside(const Lattice& lattice, const Eigen::Vector3d& displacement) {
  const double length = displacement.stableNorm();
  const std::string reason =
      length > lattice.radius()
          ? fmt::format("|displacement| = {:.6g} m is beyond the workspace radius {:.6g} m", length,
                        lattice.radius())
          : "nothing was solved this deep in this direction";
  return reason +
         ".\n              The force continues from the edge of the solved region and only stiffens";
}

/// Describes the unsolved corners of the cell of the uniform lattice that contains a displacement
/// in the ball.
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
    // Corners that are not lattice points lie outside the ball.
    beyond += number ? 0 : 1;
    if (!number || isSolved(space.points[*number].tag)) continue;
    const PointRecord& point = space.points[*number];
    gaps += fmt::format(", ({}, {}, {}) {}", corner[0], corner[1], corner[2], name(point.tag));
    if (point.tag == Tag::failed) gaps += fmt::format(" ({})", name(point.cause));
  }
  if (beyond > 0) gaps += fmt::format(", {} of 8 corners outside the workspace ball", beyond);
  return gaps;
}

/// Formats the numbers of an answer, one per line.
std::string describeSample(const std::optional<FingerPlace>& place,
                           const Eigen::Vector3d& displacement, const ForceSample& sample) {
  std::string text;
  const auto addVector = [&text](const char* label, const Eigen::Vector3d& v, const char* rest) {
    text += fmt::format("{:<13} {:11.6g} {:11.6g} {:11.6g}  {}", label, v.x(), v.y(), v.z(), rest);
  };
  if (place) addVector("at", place->at, "m\n");
  addVector("displacement", displacement, "m\n");
  addVector("force", sample.force, "N");
  text += fmt::format("    |force| = {:.6g} N\n", sample.force.norm());
  for (int i = 0; i < 3; ++i)
    addVector(i == 0 ? "stiffness" : "", sample.stiffness.row(i), "N/m\n");
  if (place) addVector("drive", place->drive, "N, along the surface\n");
  if (std::isfinite(sample.error_bound))
    text +=
        fmt::format("error bound   {:11.4g}  N, on |force|, estimated to hold at 99 % of places\n",
                    sample.error_bound);
  return text;
}

/// Explains why `inside` is false in an answer of an area.
std::string describeFault(const FingerPlace& place, bool in_ball) {
  switch (place.fault) {
    case FingerPlace::Fault::away:
      return fmt::format(
          "--at is {:.4g} m away from the surface.\n"
          "              The values are those of the nearest surface point",
          place.distance);
    case FingerPlace::Fault::no_site: return "no site of the finger is nearby";
    case FingerPlace::Fault::fixed: return "the finger rests on fixed nodes";
    case FingerPlace::Fault::none: break;
  }
  return in_ball ? "nothing was solved nearby" : "the displacement is beyond the workspace";
}

std::string answerText(const ForceAnswers& answers, const Eigen::Vector3d& p,
                       const ForceAnswer& answer, bool json) {
  const auto& [sample, place] = answer;
  if (json) return describeJson(answer, p, answers.method());
  const SpaceTable& space = answers.firstSpace();
  std::string text = describeSample(place, p, sample);
  if (!sample.inside)
    text += "inside        NO: " +
            (place ? describeFault(*place, p.stableNorm() <= answers.workspaceRadius())
                   : describeOutside(space.lattice, p)) +
            ".";
  else if (place)
    text += fmt::format("inside        yes; {:.0f} % based on solved lattice points",
                        100 * sample.coverage);
  else
    text += fmt::format("inside        yes, method {}", answers.method());
  if (sample.inside && !place && sample.coverage < 1)
    text += fmt::format("; {:.0f} % based on solved lattice points of one branch{}",
                        100 * sample.coverage, describeGaps(space, p));
  return text + "\n\n";
}

}  // namespace

void QueryOptions::addTo(CLI::App& app) {
  addRequired(app, "DATASET", dataset, "Sealed dataset from palpate build, OUT.h5", "FILE");
  app.add_option("--active", active, "Active node, or surface that a finger touches [the only one]")
      ->type_name("NAME");
  addPlaceOption(app, at);
  addDisplacementOption(app, displacement);
  app.add_option("--method", method,
                 fmt::format("Interpolation: {}", fmt::join(forceFieldMethods(), " or ")))
      ->capture_default_str();
  app.add_flag("--json", json, "One JSON object per line (docs/commands.md)");
  app.footer(
      "Prints the force on the tool in N and the stiffness d force / d displacement in N/m.\n"
      "coverage (--json): share of the force based on solved lattice points of one branch.\n"
      "Exit codes: 0 done, 1 failed, 2 wrong usage, 3 some force is not reliable: it is beyond\n"
      "the workspace or the solved points, or its place is away from the surface, has no site\n"
      "nearby, or rests on fixed nodes (printed as not inside), 130 interrupted.");
}

ExitCode query(const QueryOptions& options, std::istream& input, std::ostream& output) {
  const Dataset dataset(options.dataset);
  warnIfPartial(dataset);
  const ForceAnswers answers(dataset, options.active, !options.at.empty(), options.method);
  ExitCode code = ExitCode::done;
  forEachTouch(options.at, options.displacement, input, answers.workspaceRadius(),
               [&](const TouchInput& touch) {
                 const ForceAnswer answer = answers.answer(touch);
                 PALPATE_ASSERT(answer.finger.has_value() == touch.at.has_value(),
                                "an answer must have a place if its touch has one");
                 if (!answer.sample.inside) code = ExitCode::partly_failed;
                 // Flushed at once: a caller that sends line by line waits for each answer.
                 output << answerText(answers, touch.displacement, answer, options.json)
                        << std::flush;
                 if (!output) throw failure("cannot write the answer to standard output");
               });
  return code;
}

const Verb query_verb = {"query",
                         "Interpolated force and stiffness at displacements of an active node",
                         prepareVerb<QueryOptions, query, std::cin, std::cout>};

}  // namespace palpate
