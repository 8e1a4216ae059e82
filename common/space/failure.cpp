#include "common/space/failure.hpp"

#include <fmt/format.h>

#include <array>

namespace palpate {
namespace {

constexpr std::array<std::string_view, 11> words = {
    "none",          "iteration_limit",      "line_search_stalled", "inverted_element",
    "wrong_inertia", "factorization_failed", "not_finite",          "step_budget",
    "worker_lost",   "unreachable",          "limit_point"};

}  // namespace

std::string_view name(Cause cause) { return words.at(static_cast<std::size_t>(cause)); }

std::optional<Cause> causeNamed(std::string_view word) {
  for (std::size_t i = 0; i < words.size(); ++i)
    if (words[i] == word) return static_cast<Cause>(i);
  return std::nullopt;
}

std::string describe(const Failure& f) {
  const std::string where = fmt::format("at {:.1f} % of the transition", 100 * f.step_reached);
  switch (f.cause) {
    case Cause::none:
      return "no failure";
    case Cause::iteration_limit:
      return fmt::format("iteration_limit {}: Newton was still descending, residual {:.3g} N",
                         where, f.residual);
    case Cause::line_search_stalled:
      return fmt::format(
          "line_search_stalled {}: residual {:.3g} N does not go down; "
          "element {} has det F = {:.3g}",
          where, f.residual, f.element, f.element_det_F);
    case Cause::inverted_element:
      return fmt::format(
          "inverted_element {}: element {} has det F = {:.3g}; "
          "ln-det-F or a larger patch radius usually helps",
          where, f.element, f.element_det_F);
    case Cause::wrong_inertia:
      return fmt::format(
          "wrong_inertia {}: {} negative pivots instead of {}, "
          "a fold or another branch lies between",
          where, f.negative_pivots, f.expected_negative_pivots);
    case Cause::factorization_failed:
      if (f.mumps_infog1 >= 0)
        return fmt::format(
            "factorization_failed {}: the solution with the factors cannot be refined, "
            "the tangent is nearly singular",
            where);
      return fmt::format("factorization_failed {}: MUMPS INFOG(1) = {}, INFOG(2) = {}", where,
                         f.mumps_infog1, f.mumps_infog2);
    case Cause::not_finite:
      return fmt::format("not_finite {}: NaN or infinity appeared", where);
    case Cause::step_budget:
      return fmt::format(
          "step_budget {}: smaller steps did not get further; residual {:.3g} N, "
          "element {} has det F = {:.3g}",
          where, f.residual, f.element, f.element_det_F);
    case Cause::worker_lost:
      return "worker_lost: every worker that tried this transition died; "
             "see the workers' logs (memory limit?)";
    case Cause::unreachable:
      return "unreachable: no neighbour can be expanded: "
             "it lies behind points that are terminating or failed; nothing was tried";
    case Cause::limit_point:
      return fmt::format(
          "limit_point {}: the equilibrium path turns back there, "
          "{} negative pivots instead of {} beyond the turn; a patch (radius) "
          "carries further than a single node",
          where, f.negative_pivots, f.expected_negative_pivots);
  }
  return "unknown cause";
}

}  // namespace palpate
