#include "scheduler/build.hpp"

#include "common/base/assertion.hpp"
#include "scheduler/state/replay.hpp"

namespace palpate {

Build::Build(Problem problem, const std::filesystem::path& state, Coordinator::Time now,
             CoordinatorSettings settings, std::uint64_t segment_bytes)
    : problem_(std::move(problem)),
      problem_bytes_(encodeProblem(problem_)),
      directory_(state),
      store_(directory_, problem_, problem_bytes_, segment_bytes),
      coordinator_(problem_, problem_bytes_, store_, now, settings) {}

JournalRecord Build::recordOf(std::size_t space, std::int32_t point) const {
  const SpacePlan& plan = coordinator_.plans()[space];
  const Lattice& positions = plan.positions();
  auto record = store_.find({static_cast<std::uint32_t>(space), positions.point(point),
                             positions.point(plan.point(point).parent)});
  PALPATE_ASSERT(record, "a plan moves on with recorded results only");
  return std::move(*record);
}

void Build::verify() const {
  const std::vector<SpacePlan>& plans = coordinator_.plans();
  for (std::size_t space = 0; space < plans.size(); ++space)
    for (std::int32_t n = 0; n < plans[space].size(); ++n)
      if (isSolved(plans[space].point(n).tag)) recordOf(space, n);
}

std::vector<SpaceTable> Build::seal(const std::filesystem::path& file) {
  PALPATE_ASSERT(coordinator_.complete(), "a dataset holds every point of its scene");
  std::vector<SpaceTable> tables = spaceTables(coordinator_.plans());
  const auto fields = [&](std::size_t space, std::int32_t point) {
    return NodalFields::decode(recordOf(space, point).payload, problem_.mesh.nodes.size(),
                               pressureNodes(problem_));
  };
  sealDataset(file, problem_, tables, store_.kernelFamily(), fields);
  return tables;
}

ExitCode exitCodeOf(const std::vector<SpaceTable>& spaces) {
  const auto failedWhenTried = [](const PointRecord& point) {
    return point.tag == Tag::failed && point.cause != Cause::unreachable &&
           point.cause != Cause::beyond_force;
  };
  const bool failed = std::ranges::any_of(spaces, [&](const SpaceTable& space) {
    return std::ranges::any_of(space.points, failedWhenTried);
  });
  return failed ? ExitCode::partly_failed : ExitCode::done;
}

}  // namespace palpate
