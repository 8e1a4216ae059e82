#include "common/space/failure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace palpate {
namespace {

/// The words that name() returns, by value of the cause.
constexpr auto cause_words = std::to_array<std::string_view>(
    {"none", "iteration_limit", "line_search_stalled", "inverted_element", "wrong_inertia",
     "factorization_failed", "not_finite", "step_budget", "worker_lost", "unreachable",
     "limit_point", "beyond_force", "bifurcation"});
static_assert(cause_words.size() == static_cast<std::size_t>(Cause::bifurcation) + 1);

/// Returns the meaning of `f` and the usual remedy. This is a switch, so that the compiler warns
/// about a cause without a case.
std::string meaningOf(const Failure& f) {
  switch (f.cause) {
    case Cause::none: break;
    case Cause::iteration_limit:
      return fmt::format("Newton's method was still descending; residual {:.3g} N", f.residual);
    case Cause::line_search_stalled:
      return fmt::format("residual {:.3g} N does not decrease; element {} has det F = {:.3g}",
                         f.residual, f.element, f.element_det_F);
    case Cause::inverted_element:
      return fmt::format(
          "element {} has det F = {:.3g}; constraint ln-det-F or a larger radius usually helps",
          f.element, f.element_det_F);
    case Cause::wrong_inertia:
      return fmt::format(
          "{} negative pivots instead of {}: the state is beyond a fold or on another branch",
          f.negative_pivots, f.expected_negative_pivots);
    case Cause::factorization_failed:
      if (f.mumps_infog1 >= 0)
        return "the linear solution cannot be refined; the tangent is nearly singular";
      return fmt::format("MUMPS INFOG(1) = {}, INFOG(2) = {}", f.mumps_infog1, f.mumps_infog2);
    case Cause::not_finite: return "NaN or infinity appeared";
    case Cause::step_budget:
      return fmt::format(
          "smaller steps did not get further; residual {:.3g} N, element {} has det F = {:.3g}",
          f.residual, f.element, f.element_det_F);
    case Cause::worker_lost:
      return "every worker that tried this transition died; "
             "see the workers' logs (memory limit?)";
    case Cause::unreachable:
      return "not tried, because every neighbour failed or has a force above workspace.max_force";
    case Cause::limit_point:
      return fmt::format(
          "the equilibrium path turns back there ({} negative pivots instead of {} beyond the "
          "turn); smaller steps do not help, but another path may",
          f.negative_pivots, f.expected_negative_pivots);
    case Cause::beyond_force:
      return "the force there is far above workspace.max_force and would never be rendered; this "
             "is not an error";
    case Cause::bifurcation:
      return fmt::format(
          "{} negative pivots instead of {}: the body buckles, and no stable shape was found near "
          "the unstable one",
          f.negative_pivots, f.expected_negative_pivots);
  }
  return {};
}

}  // namespace

std::string_view name(Cause cause) {
  const auto value = static_cast<std::size_t>(cause);
  return value < cause_words.size() ? cause_words[value] : std::string_view();
}

std::optional<Cause> causeOf(std::uint32_t value) {
  return value < cause_words.size() ? std::optional(static_cast<Cause>(value)) : std::nullopt;
}

std::optional<Cause> causeNamed(std::string_view word) {
  const auto found = std::ranges::find(cause_words, word);
  return causeOf(static_cast<std::uint32_t>(found - cause_words.begin()));
}

bool stopsTransitions(Cause cause) { return cause != Cause::none && cause != Cause::unreachable; }

std::string describe(const Failure& failure) {
  if (failure.cause == Cause::none) return "no failure";
  // A worker that died has not reported how far the transition got.
  const bool has_place = stopsTransitions(failure.cause) && failure.cause != Cause::worker_lost;
  const std::string where =
      has_place ? fmt::format(" at {:.1f} % of the transition", 100 * failure.step_reached) : "";
  return fmt::format("{}{}: {}", name(failure.cause), where, meaningOf(failure));
}

}  // namespace palpate
