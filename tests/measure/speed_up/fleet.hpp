#pragma once

#include <array>
#include <string_view>

#include "tests/measure/speed_up/recording.hpp"

namespace palpate::speed_up {

struct FleetSettings {
  std::size_t workers = 1;
  double latency = 2e-4;  ///< s, of a message, one way
  /// Of the scheduler's thread, s a result, in which it does nothing else: what the simulated clock
  /// is charged.
  double cost_per_result = 0;
  /// Instead: the processor time that its turns really took here.
  bool charge_measured = false;
  bool spot_checks = true;
  std::filesystem::path directory;  ///< of the state, which is made; on a disk that syncs quickly
};

/// What the scheduler's processor time went to: handling one kind of message, and then what every
/// turn does (Coordinator::advance), what is sent, and when to wake up (Coordinator::nextDeadline).
enum class Work : std::uint8_t { result, request, start, heartbeat, advance, send, deadline };
inline constexpr std::array<std::string_view, 7> work_names = {
    "result", "request", "start", "heartbeat", "advance", "send", "deadline"};

struct FleetRun {
  double seconds = 0;  ///< simulated, from the first hand-out until the scheduler says: complete
  double until_solved = 0;  ///< until no plan asked for anything any more: the rest was checks
  double busy = 0;          ///< share of `seconds` that the scheduler was charged for
  double worked = 0;        ///< s, of all workers together, checks included
  std::int64_t results = 0, checks = 0, turns = 0, messages = 0;
  std::array<double, work_names.size()> processor = {};  ///< s, by Work
  double processorSeconds() const;
};

/// A build by so many workers, event by event: the real scheduler (Build: coordinator, plans,
/// journal, tables) decides, at simulated times, over a network that only takes time; workers do
/// what worker/link/worker_session.hpp does (two jobs in advance, starts fetched once and kept,
/// heartbeats), and find what is recorded. All have joined and asked for work when it begins.
///
/// Left out: what a worker needs to make a start ready (TransitionSolver::startFrom), ZeroMQ,
/// encryption, the bytes on the wire, the time that a disk takes to sync, the problem's way to
/// workers, accidents.
FleetRun runFleet(const Recording& recording, const FleetSettings& settings);

}  // namespace palpate::speed_up
