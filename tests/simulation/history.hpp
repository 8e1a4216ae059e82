#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace palpate::simulation {

/// What can go wrong. Names as people read them: nameOf().
enum class Accident : std::uint8_t {
  // Network, for a while, of one worker or of all.
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
  // What they work on.
  deadly_transition,
  // Where mayHaveLiar().
  lying_worker,
  kill_at_verdict,
  count
};
std::string_view nameOf(Accident accident);

/// One accident at a time of the simulation.
struct Event {
  Accident accident = Accident::count;
  double at = 0;          ///< s since the beginning
  double length = 0;      ///< s, of those that last
  std::uint64_t who = 0;  ///< which worker, file, byte: each kind takes what it needs of it
  double how_much = 0;    ///< 0 to 1: a share of messages, a number of changes
};
std::string describe(const Event& event);

/// All accidents happen before this, and all that last have ended.
inline constexpr double accidents_end_s = 300;

/// Whether one of the workers lies under this seed. So that fewer accidents are still the same
/// history, the rest of what is simulated depends on this, and not on whether it does.
bool mayHaveLiar(std::uint64_t seed);

/// What happens under this seed, in order of time. Some kinds are left out of each, so that the
/// others show alone.
std::vector<Event> historyOf(std::uint64_t seed);

}  // namespace palpate::simulation
