#pragma once

#include <limits>

#include "tests/measure/speed_up/recording.hpp"

namespace palpate::speed_up {

inline constexpr std::size_t any_number = std::numeric_limits<std::size_t>::max();

/// The dependencies in a recorded build, computed once because refinement takes seconds. After its
/// lattice, a space passes through waves. Each wave begins when the one before has ended. In a
/// wave, a target is tried from one parent after the other (a chain).
struct Dependencies {
  struct Wave {
    std::vector<std::vector<Transition>> chains;
  };
  struct Space {
    Lattice lattice;                      ///< uniform
    CompactPoints points;                 ///< before the first transition
    Frontier frontier;                    ///< before the first transition
    std::vector<Transition> ready;        ///< taken from `frontier`
    std::vector<LatticePoint> positions;  ///< of all points and probes, by number
    std::vector<Wave> waves;
  };
  /// `recording` must outlive this object.
  explicit Dependencies(const Recording& recording);

  const Recording* recording;
  std::vector<Space> spaces;
};

/// A build with the same dependencies and solves, but without scheduler, network or checks. A free
/// worker receives a ready transition at once; starts nearest to the origin come first (greedy list
/// scheduling).
struct Ideal {
  double seconds = 0;
  /// Length of the longest chain of transitions that had to wait for each other.
  int chain = 0;
};

/// With any_number of workers, `seconds` is the time of the longest chain.
Ideal idealOf(const Dependencies& dependencies, std::size_t workers);

}  // namespace palpate::speed_up
