#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace palpate {

enum class ExportFormat : std::uint8_t { vtu, pvd, csv };

/// The file to write. Its extension selects the format. A .pvd file lists a series of files in a
/// folder beside it. The folder has the name of the .pvd file without extension, with ? for control
/// characters.
class ExportTarget {
 public:
  /// Error (bad input) for an unknown extension, listing the known ones.
  explicit ExportTarget(std::filesystem::path file);

  const std::filesystem::path& file() const { return file_; }
  ExportFormat format() const { return format_; }
  /// Returns whether the format holds the many configurations along a path of the tool, and not
  /// just one.
  bool holdsWay() const { return format_ == ExportFormat::pvd || format_ == ExportFormat::csv; }
  static std::string endings();  ///< Lists the extensions and their contents, for --help.

  /// Error (bad input) if the file, or a non-empty folder of the series, exists and `may_replace`
  /// is false. The dataset itself is never replaced.
  void refuseWhatIsThere(const std::filesystem::path& dataset, bool may_replace) const;

  // Names of a series: press.pvd lists press/press_0000.vtu, press/press_0001.vtu, ...
  std::filesystem::path seriesFolder() const;
  std::filesystem::path seriesFile(std::size_t number) const;
  std::string nameInSeries(std::size_t number) const;  ///< path relative to the .pvd
  /// Creates the folder of the series, and removes an existing .pvd file, because the files that it
  /// lists will be replaced. Error if either fails.
  void beginSeries() const;
  /// Removes the files numbered `count` and above from the folder; an earlier, longer series of
  /// this name left them.
  void endSeries(std::size_t count) const;

 private:
  std::filesystem::path file_;
  ExportFormat format_;
  std::string series_;  ///< name of the series
};

}  // namespace palpate
