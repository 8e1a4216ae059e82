#include "scheduler/build.hpp"

#include <utility>

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

bool isSealed(const std::filesystem::path& file, const Problem& problem, bool force) {
  if (!std::filesystem::exists(file)) return false;
  const ContentId build = problemId(problem);
  std::string what;
  try {
    const Dataset dataset(file);
    if (dataset.buildId() == build) {
      // A damaged file is no finished work: it would be found out only when somebody touches it.
      dataset.verifyAll();
      return dataset.scene().storage == problem.scene.storage;
    }
    what =
        fmt::format("holds the dataset of another scene or mesh (build {} of scene \"{}\", not {})",
                    dataset.buildId().shortHex(), dataset.scene().name, build.shortHex());
  } catch (const Error& error) {
    what = fmt::format("exists and is not a usable dataset ({})", error.what());
  }
  if (!force)
    throw badInput("{}: {}: give another -o, or --force to replace it", file.string(), what);
  return false;
}

}  // namespace palpate
