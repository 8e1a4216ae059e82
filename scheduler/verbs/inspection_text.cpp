#include "scheduler/verbs/inspection_text.hpp"

#include <array>
#include <nlohmann/json.hpp>

#include "common/base/number_text.hpp"
#include "common/base/text.hpp"
#include "scheduler/verbs/status_text.hpp"

namespace palpate {
namespace {

/// Limit on the listed entries of each kind; the others are only counted.
constexpr std::size_t most_told = 20;

std::string sizeText(std::uint64_t bytes) {
  if (bytes < 10'000) return fmt::format("{} bytes", bytes);
  if (bytes < 10'000'000) return fmt::format("{} kB", bytes / 1000);
  return fmt::format("{:.1f} MB", static_cast<double>(bytes) / 1e6);
}

/// Returns one line for each of the first `most_told` places, and a line with the number of the
/// others.
std::string linesOf(std::string_view kind, const std::vector<JournalDamage>& places) {
  std::string lines;
  for (std::size_t n = 0; n < std::min(places.size(), most_told); ++n)
    lines += fmt::format("           {}: {}\n", kind, places[n].text);
  if (places.size() > most_told)
    lines += fmt::format("           {}: {} more\n", kind, places.size() - most_told);
  return lines;
}

std::string journalText(const Inspection& found) {
  std::string text = fmt::format("journal    {}, {}, {}\n", counted(found.segments, "segment"),
                                 counted(found.records, "whole record"), sizeText(found.bytes)) +
                     linesOf("damaged", found.damage) + linesOf("foreign", found.foreign);
  if (!found.dropped.empty())
    text += fmt::format("           note: {} marked as dropped earlier\n",
                        counted(found.dropped.size(), "place"));
  if (found.unfinished > 0 && !found.scheduler)
    text += fmt::format(
        "           note: {} after the last record, as after a crash; the next start removes "
        "them\n",
        counted(found.unfinished, "byte"));
  return text;
}

std::string tablesText(const Inspection& found) {
  using TableState = Inspection::TableState;
  if (found.tables == TableState::damaged)
    return fmt::format("tables     {}; {}\n", found.tables_text,
                       "no result depends on them; they can be created again");
  if (found.tables == TableState::missing)
    return "tables     none; the next start of the build creates them from the journal\n";
  return "tables     whole\n";
}

std::string costText(const Inspection& found) {
  std::string text;
  if (const std::size_t lost = std::max(found.lost_results, found.lost.size()); lost > 0) {
    std::vector<std::string> points;
    for (const Inspection::LostPoint& point : found.lost) {
      if (points.size() == most_told) break;
      points.push_back(point.active + ' ' + pointText(point.point, point.divisions));
    }
    if (lost > points.size() && !points.empty())
      points.push_back(fmt::format("{} more", lost - points.size()));
    text = fmt::format("cost       {} computed again{}{}\n", counted(lost, "result"),
                       points.empty() ? "" : ": ", fmt::join(points, ", "));
  }
  if (found.spare > 0)
    text += fmt::format(
        "           {} not needed{}\n", counted(found.spare, "result"),
        found.damage.empty() && found.dropped.empty()
            ? ", although nothing is lost: use the version of palpate that began this build"
            : " until the lost results are computed again");
  return text;
}

std::string verdictText(const Inspection& found, const std::filesystem::path& directory) {
  if (found.whole()) return "whole: the next start of the build continues from all results\n";
  if (!found.foreign.empty())
    return "damaged: records of several builds; move the segments of the other build elsewhere\n";
  if (found.scheduler)
    return "damaged: the running scheduler drops bad records and computes their results again\n";
  return fmt::format(
      "damaged: the next start of the build computes the lost results again; palpate check {} "
      "--repair drops the damaged records now\n",
      shellWord(directory.string()));
}

const char* wordOf(Inspection::TableState state) {
  constexpr std::array words = {"whole", "missing", "damaged"};
  return words.at(static_cast<std::size_t>(state));
}

nlohmann::ordered_json placesJson(const std::vector<JournalDamage>& places) {
  auto list = nlohmann::ordered_json::array();
  for (const JournalDamage& place : places)
    list.push_back({{"segment", place.where.segment},
                    {"byte", place.where.offset},
                    {"bytes", place.where.length},
                    {"text", place.text}});
  return list;
}

}  // namespace

std::string describe(const Inspection& found, const std::filesystem::path& directory) {
  std::string text = fmt::format("state      {}: ", directory.string());
  text += found.scene_name.empty() ? "scene unknown" : "scene " + found.scene_name;
  text += fmt::format(", build {}\n", found.build ? found.build->shortHex() : "unknown");
  if (found.scheduler)
    text +=
        fmt::format("           process {} is writing there; its newest results may be missing\n",
                    *found.scheduler);
  text += journalText(found) + tablesText(found) + costText(found);
  for (const std::string& file : found.leftovers)
    text += fmt::format("leftover   {}: not needed, can be removed\n", file);
  return text + verdictText(found, directory);
}

std::string inspectionJson(const Inspection& found, const std::filesystem::path& directory,
                           const std::vector<std::string>& repaired) {
  auto lost = nlohmann::ordered_json::array();
  for (const auto& [active, p, divisions] : found.lost)
    lost.push_back({{"active", active},
                    {"point", {{"i", p[0]}, {"j", p[1]}, {"k", p[2]}}},
                    {"divisions", divisions}});
  const nlohmann::ordered_json report = {
      {"directory", directory.string()},
      {"scene", found.scene_name},
      {"build", found.build ? found.build->hex() : ""},
      {"whole", found.whole()},
      {"scheduler", found.scheduler.value_or("")},
      {"segments", found.segments},
      {"records", found.records},
      {"bytes", found.bytes},
      {"unfinished_bytes", found.unfinished},
      {"damaged", placesJson(found.damage)},
      {"foreign", placesJson(found.foreign)},
      {"dropped", found.dropped.size()},
      {"tables", {{"state", wordOf(found.tables)}, {"text", found.tables_text}}},
      {"lost_results", found.lost_results},
      {"computed_again", lost},
      {"spare_results", found.spare},
      {"leftovers", found.leftovers},
      {"repaired", repaired}};
  // Replace invalid UTF-8, because file names may contain it.
  return report.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace palpate
