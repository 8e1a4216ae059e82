#include <fmt/format.h>

#include "viewer/report/comparison.hpp"
#include "viewer/report/report_words.hpp"

namespace palpate {
namespace {

std::string placeRow(const std::string& name, const std::array<std::string, 8>& cells) {
  return fmt::format("{:<20}{:>9}{:>9}{:>10}{:>10}{:>10}{:>10}{:>9}{:>10}\n", name, cells[0],
                     cells[1], cells[2], cells[3], cells[4], cells[5], cells[6], cells[7]);
}

}  // namespace

std::string comparisonText(const Comparison& comparison) {
  std::string text;
  for (std::size_t s = 0; s < 2; ++s)
    text += fmt::format("{}: {}\n", s == 0 ? 'A' : 'B', comparison.datasets[s].file.string());
  text += wrapped(fmt::format("They differ in {}; compared by {}.",
                              fmt::join(comparison.differences, ", "), comparison.method)) +
          "\n";
  for (const auto& [name, first, second] : comparison.properties)
    if (first != second)
      text += fmt::format("{:<24}", name) + wrapped("A: " + first, 24) + std::string(24, ' ') +
              wrapped("B: " + second, 24);
  text += "\n" + placeRow("", {"stiffness", "", "mean", "", "|B - A|", "|B - A|", "of", "mean"}) +
          placeRow("active node",
                   {"A, N/m", "B, N/m", "force A", "force B", "mean", "max", "force A", "bounds"});
  for (const ComparedPlace& place : comparison.places) {
    const auto& [a, b] = place.sides;
    text += placeRow(place.name,
                     {formatNumber(a.stiffness, 3), formatNumber(b.stiffness, 3),
                      formatNumber(a.mean_force, 3), formatNumber(b.mean_force, 3),
                      formatNumber(place.difference.mean), formatNumber(place.difference.maximum),
                      formatShare(place.relative), formatNumber(a.mean_bound + b.mean_bound)});
  }
  text += "\n" +
          wrapped(
              "Forces and differences of the force vectors in N, over a grid of displacements that "
              "both answer, with forces within the limits of their scenes. Stiffness at rest, mean "
              "over directions. Bounds: the sum of both error bounds; a difference below it says "
              "nothing.");
  for (const std::string& limit : comparison.limits) text += "\n" + wrapped(limit);
  return text;
}

}  // namespace palpate
