#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace palpate {

/// Why a transition did not end in an accepted configuration, or why none was tried. The closed
/// list: values are part of the wire, the state directory and the dataset, so they are only ever
/// appended to. name() has a word for each, and what has a word is a cause everywhere.
enum class Cause : std::uint8_t {
  none = 0,                  ///< no failure
  iteration_limit = 1,       ///< Newton used up its iterations while still descending
  line_search_stalled = 2,   ///< no step along the Newton direction reduced the residual
  inverted_element = 3,      ///< det F <= 0: in the converged state, or where ln det F is needed
  wrong_inertia = 4,         ///< converged to an unstable or other branch, by its negative pivots
  factorization_failed = 5,  ///< MUMPS gave up; mumps_infog says why
  not_finite = 6,            ///< NaN or infinity in residual or tangent, or !isUsable()
  step_budget = 7,           ///< the transition was cut into more steps than it is worth
  worker_lost = 8,           ///< every worker that tried it died
  unreachable = 9,           ///< of a point, never of a transition: no neighbour is expandable
  limit_point = 10,          ///< the path turns back: no equilibrium on this branch beyond
  /// A finger is pushed so hard there that nothing would be interpolated with the configuration.
  beyond_force = 11,
  /// The branch goes on unstable, and no stable one was found beside it.
  bifurcation = 12,
};

/// The word for a cause, as it stands in messages and files: "iteration_limit". "none" for
/// Cause::none; empty for a value that is no cause.
std::string_view name(Cause cause);
/// The cause with this value in a message or a file; nothing when this program knows none.
std::optional<Cause> causeOf(std::uint32_t value);
/// The cause with this word; nothing when there is none.
std::optional<Cause> causeNamed(std::string_view word);
/// True for what can stop a transition that was tried: every cause but none and unreachable.
bool stopsTransitions(Cause cause);

/// A cause and the numbers to judge it by. Fields that do not apply keep their defaults.
struct Failure {
  Cause cause = Cause::none;
  double step_reached = 0;  ///< accepted fraction of the transition before it stopped, 0..1
  double residual = 0;      ///< N, norm of the residual where it stopped
  std::int32_t element =
      -1;  ///< with the smallest det F there, in Mesh::tetrahedra; -1 not looked at
  double element_det_F = 0;          ///< its det F
  std::int32_t negative_pivots = 0;  ///< of the last factorisation
  std::int32_t expected_negative_pivots = 0;
  std::int32_t mumps_infog1 = 0;  ///< INFOG(1) and INFOG(2) of the last MUMPS call
  std::int32_t mumps_infog2 = 0;
};

/// One sentence for a person: cause, numbers, and what usually helps.
std::string describe(const Failure& failure);

}  // namespace palpate
