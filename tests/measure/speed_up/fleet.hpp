#pragma once

#include <array>
#include <string_view>

#include "tests/measure/speed_up/recording.hpp"

namespace palpate::speed_up {

struct FleetSettings {
  std::size_t workers = 1;
  double latency = 2e-4;  ///< s, for a message in one direction
  /// Time per result for which the scheduler's thread is busy, s, added to the simulated clock.
  double cost_per_result = 0;
  /// Adds the real processor time of the scheduler's turns instead of cost_per_result.
  bool charge_measured = false;
  bool spot_checks = true;
  std::filesystem::path directory;  ///< state directory, which is created; should be on a disk
                                    ///< with fast syncs
};

/// Kinds of work of the scheduler: handling one kind of message; the common work of every turn
/// (Coordinator::advance); sending; and computing the next deadline (Coordinator::nextDeadline).
enum class Work : std::uint8_t { result, request, start, heartbeat, advance, send, deadline };
inline constexpr std::array<std::string_view, 7> work_names = {
    "result", "request", "start", "heartbeat", "advance", "send", "deadline"};

struct FleetRun {
  double seconds = 0;       ///< simulated, from the first hand-out to completion
  double until_solved = 0;  ///< from the first hand-out until only checks remained
  double busy = 0;          ///< share of `seconds` in which the scheduler was busy
  double worked = 0;        ///< s, sum over all workers, including checks
  std::int64_t results = 0, checks = 0, turns = 0, messages = 0;
  std::array<double, work_names.size()> processor = {};  ///< s, by Work
  double processorSeconds() const;
};

/// Simulates a build by this many workers as a sequence of events. The real scheduler (Build:
/// coordinator, plans, journal, tables) decides at simulated times, over a network that only takes
/// time. Workers act as in worker/link/worker_session.hpp (two jobs in advance, starts fetched once
/// and kept, heartbeats) and return the recorded results. All have joined and requested work at the
/// start.
///
/// Not simulated: a worker's time to prepare a start (TransitionSolver::startFrom), ZeroMQ,
/// encryption, bandwidth, the time of disk syncs, the transfer of the problem to workers,
/// accidents.
FleetRun runFleet(const Recording& recording, const FleetSettings& settings);

}  // namespace palpate::speed_up
