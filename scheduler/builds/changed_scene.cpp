#include "scheduler/builds/changed_scene.hpp"

#include <spdlog/spdlog.h>

#include "common/base/error.hpp"
#include "common/base/whole_file.hpp"
#include "common/dataset/dataset.hpp"
#include "scheduler/state/state_directory.hpp"
#include "scheduler/state/tables.hpp"

namespace palpate {
namespace {

/// Returns an unused name for `out` that contains the build id: "liver.<build>.h5".
std::filesystem::path nameAside(const std::filesystem::path& out, const ContentId& build) {
  std::filesystem::path aside;
  for (int n = 1; n == 1 || std::filesystem::exists(aside) ||
                  std::filesystem::exists(aside.string() + ".state");
       ++n)
    aside = out.parent_path() / fmt::format("{}.{}{}{}", out.stem().string(), build.shortHex(),
                                            n > 1 ? fmt::format("-{}", n) : "",
                                            out.extension().string());
  return aside;
}

void keepAs(const std::filesystem::path& from, const std::filesystem::path& to) {
  std::error_code error;
  std::filesystem::rename(from, to, error);
  if (error)
    throw failure("{}: cannot rename to {}: {}; give another -o", from.string(), to.string(),
                  error.message());
}

std::optional<ContentId> buildOfDataset(const std::filesystem::path& file) {
  try {
    if (std::filesystem::exists(file)) return Dataset(file).buildId();
  } catch (const Error&) {
    // The file is not a dataset, or a damaged one: isSealed() reports which.
  }
  return std::nullopt;
}

/// Returns the build id in the tables of a state directory; none if they cannot be read. The caller
/// holds the lock of the directory.
std::optional<ContentId> buildOfState(const std::filesystem::path& state) {
  try {
    return StoredTables(state, Database::Access::read_only).build().build;
  } catch (const Error&) {
    return std::nullopt;
  }
}

}  // namespace

void setAsideWhatIsOfAnotherScene(const std::filesystem::path& out,
                                  const std::filesystem::path& state, const Problem& problem,
                                  bool replace) {
  const ContentId wanted = problemId(problem);
  std::string kept;
  std::filesystem::path aside;
  const std::optional<ContentId> of_dataset = buildOfDataset(out);
  if (of_dataset && *of_dataset != wanted && !replace) {
    const std::filesystem::path dataset = linkTarget(out);
    aside = nameAside(dataset, *of_dataset);
    keepAs(dataset, aside);
    kept = fmt::format("the previous dataset is now {}", aside.string());
  }
  if (state == out.string() + ".state" &&
      std::filesystem::exists(StateDirectory::databaseIn(state))) {
    const StateDirectory lock(state);
    const std::optional<ContentId> of_state = buildOfState(state);
    if (of_state && *of_state != wanted) {
      if (aside.empty() || of_state != of_dataset || linkTarget(out) != out)
        aside = nameAside(out, *of_state);
      keepAs(state, aside.string() + ".state");
      kept += fmt::format("{}the previous state directory is now {}.state (old scene: -o {})",
                          kept.empty() ? "" : ", ", aside.string(), aside.string());
    }
  }
  if (!kept.empty()) spdlog::info("the scene or its mesh has changed: {}", kept);
}

}  // namespace palpate
