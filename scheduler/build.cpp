#include "scheduler/build.hpp"

#include "common/base/assertion.hpp"
#include "scheduler/state/replay.hpp"

namespace palpate {

Build::Build(Problem problem, const std::filesystem::path& state, CoordinatorSettings settings)
    : problem_(std::move(problem)),
      problem_bytes_(encodeProblem(problem_)),
      directory_(state),
      store_(directory_, problem_, problem_bytes_),
      journal_(directory_.path(), store_.committed()),
      coordinator_(problem_, problem_bytes_, store_, journal_, std::chrono::steady_clock::now(),
                   settings) {}

std::vector<SpaceTable> Build::seal(const std::filesystem::path& file) {
  PALPATE_ASSERT(coordinator_.complete(), "a dataset holds every point of its scene");
  const std::vector<SpacePlan>& plans = coordinator_.plans();
  std::vector<SpaceTable> tables = spaceTables(plans);
  const auto fields = [&](std::size_t space, std::int32_t point) {
    const auto kept =
        store_.find({static_cast<std::uint32_t>(space), point, plans[space].point(point).parent});
    PALPATE_ASSERT(kept, "a plan moves on with recorded results only");
    return NodalFields::decode(journal_.read(kept->where).payload, problem_.mesh.nodes.size(),
                               pressureNodes(problem_));
  };
  sealDataset(file, problem_, tables, store_.build().kernel_family, fields);
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
