#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace palpate {

/// Why a transition ended without an accepted configuration, or why no transition was tried. Never
/// change or reuse a value; new causes are only appended. The values are part of messages, the
/// state directory and the dataset. name() returns the word of a cause.
enum class Cause : std::uint8_t {
  none = 0,                 ///< no failure
  iteration_limit = 1,      ///< Newton used up its iterations or factorisations while descending
  line_search_stalled = 2,  ///< no step along the Newton direction reduced the residual
  /// det F <= 0 in the converged state, or earlier if ln det F must be computed.
  inverted_element = 3,
  wrong_inertia = 4,         ///< negative pivots show an unstable state or another branch
  factorization_failed = 5,  ///< MUMPS failed (mumps_infog1), or could not refine its solution
  not_finite = 6,            ///< NaN or infinity in residual or tangent, or !isUsable()
  step_budget = 7,           ///< the transition was cut into more steps than the budget allows
  worker_lost = 8,           ///< every worker that tried it died
  unreachable = 9,   ///< the point has no expandable neighbour (Tag), so no transition was tried
  limit_point = 10,  ///< the path turns back: the branch has no equilibrium beyond the turn
  /// The force on the finger grew so large that no interpolation would use the configuration.
  beyond_force = 11,
  /// The branch becomes unstable, and no stable branch was found that continues it.
  bifurcation = 12,
};

/// Returns the word for a cause in messages and files, such as "iteration_limit". It is "none" for
/// Cause::none and empty for an invalid value.
std::string_view name(Cause cause);
/// Returns the cause with this value in a message or file, or nullopt for an unknown value.
std::optional<Cause> causeOf(std::uint32_t value);
/// Returns the cause with this word, or nullopt.
std::optional<Cause> causeNamed(std::string_view word);
/// Returns whether a transition can end with this cause: true for all but none and unreachable.
bool stopsTransitions(Cause cause);

/// A cause and the numbers to judge it by. Fields that do not apply keep their defaults.
struct Failure {
  Cause cause = Cause::none;
  double step_reached = 0;  ///< fraction of the transition accepted before the stop, 0 to 1
  double residual = 0;      ///< N, norm of the residual at the stop
  /// Index in Mesh::tetrahedra of the element with the smallest det F; -1 if unknown.
  std::int32_t element = -1;
  double element_det_F = 0;          ///< det F of `element`
  std::int32_t negative_pivots = 0;  ///< in the last factorisation
  std::int32_t expected_negative_pivots = 0;
  std::int32_t mumps_infog1 = 0;  ///< INFOG(1) and INFOG(2) of the last MUMPS call
  std::int32_t mumps_infog2 = 0;
};

/// Describes the failure in one sentence: cause, numbers and the usual remedy.
std::string describe(const Failure& failure);

}  // namespace palpate
