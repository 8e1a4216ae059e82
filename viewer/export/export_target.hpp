#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace palpate {

enum class ExportFormat : std::uint8_t { vtu, pvd, csv };

/// The file to write. Its extension selects the format. The files of a .pvd series lie in a folder
/// beside it with the same name (with ? for control characters).
class ExportTarget {
 public:
  /// Error (bad input) for an unknown extension, listing the known ones.
  explicit ExportTarget(std::filesystem::path file);

  const std::filesystem::path& file() const { return file_; }
  ExportFormat format() const { return format_; }
  /// Whether the format holds many configurations along a path of the tool, or one.
  bool holdsWay() const { return format_ == ExportFormat::pvd || format_ == ExportFormat::csv; }
  static std::string endings();  ///< Lists the extensions with their contents, for --help.

  /// Error (bad input) if the file or a non-empty folder of the series exists, unless it may be
  /// replaced. The dataset itself may never be replaced.
  void refuseWhatIsThere(const std::filesystem::path& dataset, bool may_replace) const;

  // For a .pvd: press.pvd, press/press_0000.vtu, press/press_0001.vtu, ...
  std::filesystem::path seriesFolder() const;
  std::filesystem::path seriesFile(std::size_t number) const;
  std::string nameInSeries(std::size_t number) const;  ///< path relative to the .pvd
  /// Makes the folder, and removes an existing list, because its files will be replaced. Error if
  /// either fails.
  void beginSeries() const;
  /// Removes files of an earlier, longer series of this name from the folder.
  void endSeries(std::size_t count) const;

 private:
  std::filesystem::path file_;
  ExportFormat format_;
  std::string series_;  ///< name of the series
};

}  // namespace palpate
