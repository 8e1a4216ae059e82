#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace palpate::simulation {

/// Kinds of accidents; nameOf() gives their names.
enum class Accident : std::uint8_t {
  // Network faults that last a while, for one worker or all.
  slow_network,
  lost_messages,
  doubled_messages,
  reordered_messages,
  cut_to_worker,
  cut_to_scheduler,
  cut_both_ways,
  reset,
  half_open,
  narrow_link,
  // The scheduler and its machine.
  kill_scheduler,
  power_cut,
  stop_scheduler,
  suspend_scheduler,
  scheduler_clock_jump,
  ask_to_stop,
  second_scheduler,
  lock_file_removed,
  // Its disk.
  write_error,
  short_write,
  sync_error,
  rename_error,
  full_disk,
  journal_rot,
  table_rot,
  tables_lost,
  // A worker.
  kill_worker,
  stop_worker,
  suspend_worker,
  worker_clock_jump,
  interrupt_worker,
  hung_solver,
  out_of_memory,
  slow_solve,
  // The work itself.
  deadly_transition,
  // Only if mayHaveLiar().
  lying_worker,
  kill_at_verdict,
  count
};
std::string_view nameOf(Accident accident);

/// An accident at one time of the simulation.
struct Event {
  Accident accident = Accident::count;
  double at = 0;          ///< s since the start
  double length = 0;      ///< s, for accidents that last
  std::uint64_t who = 0;  ///< selects a worker, file or byte, depending on the kind
  double how_much = 0;    ///< 0 to 1, such as the share of lost messages
};
std::string describe(const Event& event);

/// All accidents begin, and lasting ones end, before this time.
inline constexpr double accidents_end_s = 300;

/// Whether a worker may lie under this seed. The rest of the simulation depends on this and not on
/// actual lies, so that it stays the same when accidents are removed from the history.
bool mayHaveLiar(std::uint64_t seed);

/// Returns the accidents under this seed in order of time. Each history leaves out some kinds, so
/// that the effect of others becomes visible.
std::vector<Event> historyOf(std::uint64_t seed);

}  // namespace palpate::simulation
