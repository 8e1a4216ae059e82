#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace palpate {

enum class ExportFormat : std::uint8_t { vtu, pvd, csv };

/// The file that is to be written: its format by its ending, and the folder beside a .pvd that its
/// series lies in, which has its name (with ? for control characters).
class ExportTarget {
 public:
  /// Error (bad input) that lists the endings for another one.
  explicit ExportTarget(std::filesystem::path file);

  const std::filesystem::path& file() const { return file_; }
  ExportFormat format() const { return format_; }
  /// Many configurations along a way of the tool; else one.
  bool holdsWay() const { return format_ == ExportFormat::pvd || format_ == ExportFormat::csv; }
  static std::string endings();  ///< for --help: each with what it holds

  /// Error (bad input) when the file, or the folder of the series with anything in it, is there and
  /// may not be replaced. Never is the dataset itself.
  void refuseWhatIsThere(const std::filesystem::path& dataset, bool may_replace) const;

  // Of a .pvd: press.pvd, press/press_0000.vtu, press/press_0001.vtu, ...
  std::filesystem::path seriesFolder() const;
  std::filesystem::path seriesFile(std::size_t number) const;
  std::string nameInSeries(std::size_t number) const;  ///< as the .pvd names it
  /// Makes the folder. The list that is there goes first: it is of files that will be others. Error
  /// when either cannot be.
  void beginSeries() const;
  /// Removes files of an earlier, longer series of this name from the folder.
  void endSeries(std::size_t count) const;

 private:
  std::filesystem::path file_;
  ExportFormat format_;
  std::string series_;  ///< its name
};

}  // namespace palpate
