#include "viewer/export/export_target.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/number_in.hpp"
#include "common/base/whole_file.hpp"

namespace palpate {
namespace {

struct Ending {
  std::string_view text;
  ExportFormat format;
  const char* holds;
};

constexpr std::array<Ending, 3> known_endings = {
    {{".vtu", ExportFormat::vtu, "one configuration, VTK XML"},
     {".pvd", ExportFormat::pvd, "a path, as a series of .vtu"},
     {".csv", ExportFormat::csv, "forces along a path"}}};

ExportFormat formatOf(const std::filesystem::path& file) {
  for (const Ending& ending : known_endings)
    if (file.extension() == ending.text) return ending.format;
  throw badInput("-o {}: unknown ending; known: {}", file.string(), ExportTarget::endings());
}

bool isThere(const std::filesystem::path& file) {
  std::error_code ignored;
  return std::filesystem::exists(std::filesystem::symlink_status(file, ignored));
}

}  // namespace

ExportTarget::ExportTarget(std::filesystem::path file)
    : file_(std::move(file)), format_(formatOf(file_)), series_(file_.stem().string()) {
  // The .pvd file is XML, which cannot represent control characters.
  std::ranges::replace_if(
      series_, [](unsigned char c) { return c < 0x20 || c == 0x7f; }, '?');
}

std::string ExportTarget::endings() {
  std::vector<std::string> texts;
  for (const Ending& ending : known_endings)
    texts.push_back(fmt::format("{} ({})", ending.text, ending.holds));
  return fmt::format("{}", fmt::join(texts, ", "));
}

void ExportTarget::refuseWhatIsThere(const std::filesystem::path& dataset, bool may_replace) const {
  refuseInput(file_, "-o", {&dataset, 1});
  std::error_code ignored;
  const std::filesystem::path folder = seriesFolder();
  const bool has_folder = format_ == ExportFormat::pvd && isThere(folder);
  if (std::filesystem::is_directory(file_, ignored) ||
      (has_folder && !std::filesystem::is_directory(folder, ignored)))
    throw badInput(
        "-o {}: it is a folder, or the folder of its series is a file; give another name",
        file_.string());
  if (may_replace) return;
  const bool has_series = has_folder && !std::filesystem::is_empty(folder, ignored);
  if (isThere(file_) || has_series)
    throw badInput("{} already exists: give another -o, or --replace",
                   (has_series ? folder : file_).string());
}

std::filesystem::path ExportTarget::seriesFolder() const { return file_.parent_path() / series_; }

std::string ExportTarget::nameInSeries(std::size_t number) const {
  return fmt::format("{0}/{0}_{1:04}.vtu", series_, number);
}

std::filesystem::path ExportTarget::seriesFile(std::size_t number) const {
  return file_.parent_path() / nameInSeries(number);
}

void ExportTarget::beginSeries() const {
  std::error_code error;
  std::filesystem::create_directory(seriesFolder(), error);
  if (error)
    throw failure("{}: cannot create the folder: {}", seriesFolder().string(), error.message());
  std::filesystem::remove(file_, error);
  if (error)
    throw failure("{}: cannot remove the earlier list: {}", file_.string(), error.message());
}

void ExportTarget::endSeries(std::size_t count) const {
  std::vector<std::filesystem::path> longer;
  try {
    for (const auto& entry : std::filesystem::directory_iterator(seriesFolder()))
      if (const auto number =
              numberBetween<std::size_t>(series_ + '_', entry.path().filename().string(), ".vtu");
          number && *number >= count)
        longer.push_back(entry.path());
    for (const std::filesystem::path& file : longer) std::filesystem::remove(file);
  } catch (const std::filesystem::filesystem_error& error) {
    throw failure("{}: cannot remove the files of an earlier series: {}", seriesFolder().string(),
                  error.code().message());
  }
}

}  // namespace palpate
