#include "scheduler/builds/build.hpp"

#include "common/base/assertion.hpp"
#include "common/dataset/hdf5_reader.hpp"

namespace palpate {
namespace {

/// Returns the record of the transition that solved a point.
JournalRecord recordOf(const std::vector<SpacePlan>& plans, std::size_t space, std::int32_t point,
                       const RecordSource& find) {
  const Lattice& positions = plans[space].positions();
  auto record = find({static_cast<std::uint32_t>(space), positions.point(point),
                      positions.point(plans[space].points().parent(point))});
  PALPATE_ASSERT(record, "a solved point must have a recorded result");
  return std::move(*record);
}

}  // namespace

Build::Build(Problem problem, const std::filesystem::path& state, Coordinator::Time now,
             const CoordinatorSettings& settings, std::uint64_t segment_bytes)
    : problem_(std::move(problem)),
      problem_bytes_(encodeProblem(problem_)),
      directory_(state),
      store_(directory_, problem_, segment_bytes),
      coordinator_(problem_, problem_bytes_, store_, now, checked(settings)) {
  PALPATE_ASSERT(coordinator_.plans().size() == problem_.active.size(),
                 "each active node must have a plan");
}

/// Checks the kernels before any worker is admitted.
const CoordinatorSettings& Build::checked(const CoordinatorSettings& settings) const {
  const std::string& begun_with = store_.kernelFamily();
  if (settings.kernel_family.empty() || begun_with.empty() || settings.kernel_family == begun_with)
    return settings;
  throw badInput(
      "{}: this build began with the {} kernels, but --kernels asks for {}: omit --kernels, or use "
      "another --state directory",
      directory_.path().string(), begun_with, settings.kernel_family);
}

bool isSealed(const std::filesystem::path& file, const Problem& problem, bool replace) {
  if (!std::filesystem::exists(file)) return false;
  const ContentId build = problemId(problem);
  std::string what;
  try {
    const Dataset dataset(file);
    if (dataset.buildId() == build) {
      // Verify the file now: damage would otherwise be found only when the dataset is used.
      dataset.verifyAll();
      return !dataset.isPartial() && dataset.scene().storage == problem.scene.storage;
    }
    what =
        fmt::format("holds the dataset of another scene or mesh (build {} of scene \"{}\", not {})",
                    dataset.buildId().shortHex(), dataset.scene().name, build.shortHex());
  } catch (const Error& error) {
    // A file that is open for writing may be intact, so do not advise --replace.
    if (!replace && hdf5::isOpenForWriting(file)) throw;
    what = fmt::format("exists, but is not a usable dataset ({})", error.what());
  }
  if (!replace) throw badInput("{}: {}: give another -o, or --replace", file.string(), what);
  return false;
}

SpaceRowsList sealPlans(const std::filesystem::path& file, const Problem& problem,
                        const std::vector<SpacePlan>& plans, const std::string& kernel_family,
                        const RecordSource& find, bool partial) {
  SpaceRowsList rows = rowsOf(plans);
  PALPATE_ASSERT(rows.size() == problem.active.size(), "each active node must have a space");
  const auto fields = [&](std::size_t space, std::int32_t point) {
    return NodalFields::decode(recordOf(plans, space, point, find).payload,
                               problem.mesh.nodes.size(), problem.pressures.count());
  };
  sealDataset(file, problem, rows, kernel_family, fields, partial);
  return rows;
}

RecordSource Build::finder() const {
  return [this](const ResultKey& key) { return store_.find(key); };
}

void Build::verify() const {
  const std::vector<SpacePlan>& plans = coordinator_.plans();
  for (std::size_t space = 0; space < plans.size(); ++space)
    for (std::int32_t n = 0; n < plans[space].size(); ++n)
      if (isSolved(plans[space].points().tag(n))) recordOf(plans, space, n, finder());
}

SpaceRowsList Build::seal(const std::filesystem::path& file) {
  PALPATE_ASSERT(coordinator_.complete(), "a build must be complete before it is sealed");
  return sealPlans(file, problem_, coordinator_.plans(), store_.kernelFamily(), finder(), false);
}

ExitCode exitCodeOf(const SpaceRowsList& spaces) {
  for (const auto& space : spaces)
    for (std::int32_t n = 0; n < space->points(); ++n) {
      if (space->tag(n) != Tag::failed) continue;
      const Cause cause = space->point(n).cause;
      if (cause != Cause::unreachable && cause != Cause::beyond_force)
        return ExitCode::partly_failed;
    }
  return ExitCode::done;
}

}  // namespace palpate
