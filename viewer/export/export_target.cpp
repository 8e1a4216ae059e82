#include "viewer/export/export_target.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/base/whole_file.hpp"

namespace palpate {
namespace {

struct Ending {
  std::string_view text;
  ExportFormat format;
  const char* holds;
};

constexpr std::array<Ending, 3> known_endings = {
    {{".vtu", ExportFormat::vtu, "one configuration, VTK's XML"},
     {".pvd", ExportFormat::pvd, "a way, as a series of .vtu"},
     {".csv", ExportFormat::csv, "forces along a way"}}};

ExportFormat formatOf(const std::filesystem::path& file) {
  for (const Ending& ending : known_endings)
    if (file.extension() == ending.text) return ending.format;
  throw badInput("-o {}: nothing is written with this ending; there are {}", file.string(),
                 ExportTarget::endings());
}

bool isThere(const std::filesystem::path& file) {
  std::error_code ignored;
  return std::filesystem::exists(std::filesystem::symlink_status(file, ignored));
}

/// Of "press_0012.vtu" with the stem "press" 12; nothing of other names.
std::optional<std::size_t> numberIn(const std::string& name, const std::string& stem) {
  const std::string begin = stem + "_", end = ".vtu";
  if (!name.starts_with(begin) || !name.ends_with(end) || name.size() <= begin.size() + end.size())
    return std::nullopt;
  std::size_t number = 0;
  const char *first = name.data() + begin.size(), *last = name.data() + name.size() - end.size();
  const auto [stop, error] = std::from_chars(first, last, number);
  return error == std::errc() && stop == last ? std::optional(number) : std::nullopt;
}

}  // namespace

ExportTarget::ExportTarget(std::filesystem::path file)
    : file_(std::move(file)), format_(formatOf(file_)) {}

std::string ExportTarget::endings() {
  std::vector<std::string> texts;
  for (const Ending& ending : known_endings)
    texts.push_back(fmt::format("{} ({})", ending.text, ending.holds));
  return fmt::format("{}", fmt::join(texts, ", "));
}

/// A .pvd names its files, which XML can do of no control character.
void ExportTarget::refuseNameForXml() const {
  const std::string name = file_.filename().string();
  if (format_ == ExportFormat::pvd &&
      std::ranges::any_of(name, [](unsigned char c) { return c < 0x20 || c == 0x7f; }))
    throw badInput("-o {}: a .pvd cannot name its files so; give a name without control characters",
                   printable(name, longest_reason));
}

void ExportTarget::refuseWhatIsThere(const std::filesystem::path& dataset, bool may_replace) const {
  refuseInput(file_, "-o", {&dataset, 1});
  refuseNameForXml();
  std::error_code ignored;
  if (std::filesystem::is_directory(file_, ignored))
    throw badInput("-o {}: is a directory; name a file", file_.string());
  if (isThere(file_) && !may_replace)
    throw badInput("{} is there already: give another -o, or --replace", file_.string());
  if (format_ != ExportFormat::pvd || !isThere(seriesFolder())) return;
  if (!std::filesystem::is_directory(seriesFolder(), ignored))
    throw badInput(
        "{} is there already, and no folder, which {} needs for its files: give another -o",
        seriesFolder().string(), file_.string());
  if (!std::filesystem::is_empty(seriesFolder(), ignored) && !may_replace)
    throw badInput("{} is there already: give another -o, or --replace for the series in it",
                   seriesFolder().string());
}

std::filesystem::path ExportTarget::seriesFolder() const {
  return file_.parent_path() / file_.stem();
}

std::string ExportTarget::nameInSeries(std::size_t number) const {
  const std::string stem = file_.stem().string();
  return fmt::format("{}/{}_{:04}.vtu", stem, stem, number);
}

std::filesystem::path ExportTarget::seriesFile(std::size_t number) const {
  return file_.parent_path() / nameInSeries(number);
}

void ExportTarget::beginSeries() const {
  std::error_code error;
  std::filesystem::create_directory(seriesFolder(), error);
  if (!error) std::filesystem::remove(file_, error);
  if (error)
    throw failure("{}: the series cannot be begun: {}", seriesFolder().string(), error.message());
}

void ExportTarget::endSeries(std::size_t count) const {
  const std::string stem = file_.stem().string();
  std::vector<std::filesystem::path> longer;
  try {
    for (const auto& entry : std::filesystem::directory_iterator(seriesFolder()))
      if (const auto number = numberIn(entry.path().filename().string(), stem);
          number && *number >= count)
        longer.push_back(entry.path());
    for (const std::filesystem::path& file : longer) std::filesystem::remove(file);
  } catch (const std::filesystem::filesystem_error& error) {
    throw failure("{}: files of an earlier series cannot be removed: {}", seriesFolder().string(),
                  error.code().message());
  }
}

}  // namespace palpate
