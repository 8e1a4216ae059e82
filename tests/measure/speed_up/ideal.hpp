#pragma once

#include <limits>

#include "tests/measure/speed_up/recording.hpp"

namespace palpate::speed_up {

inline constexpr std::size_t any_number = std::numeric_limits<std::size_t>::max();

/// What has to wait for what in a recorded build. Found once, because refinement takes a scheduler
/// seconds: after its lattice a space goes through waves, each of which begins when the one before
/// has ended, and in which a target is tried from one parent after the other.
struct Dependencies {
  struct Wave {
    std::vector<std::vector<Transition>> chains;
  };
  struct Space {
    Lattice lattice;                      ///< uniform
    CompactPoints points;                 ///< of it, before its first transition
    Frontier frontier;                    ///< likewise
    std::vector<Transition> ready;        ///< of it
    std::vector<LatticePoint> positions;  ///< of all points and probes, by number
    std::vector<Wave> waves;
  };
  /// `recording` must outlive this.
  explicit Dependencies(const Recording& recording);

  const Recording* recording;
  std::vector<Space> spaces;
};

/// How a build goes whose workers are given what is ready the moment it is, the start nearest to
/// the origin first (greedy list scheduling): same dependencies, same solves, no scheduler, no
/// network, no checks.
struct Ideal {
  double seconds = 0;
  /// Of the transitions of which each had to wait for the one before, until the last one ended.
  int chain = 0;
};

/// With any_number of workers its seconds are those of the longest chain.
Ideal idealOf(const Dependencies& dependencies, std::size_t workers);

}  // namespace palpate::speed_up
