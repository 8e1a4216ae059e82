#include "tests/simulation/history.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "tests/simulation/random.hpp"

namespace palpate::simulation {
namespace {

constexpr auto kinds = static_cast<std::size_t>(Accident::count);
constexpr std::array<std::string_view, kinds> names = {"slow_network",
                                                       "lost_messages",
                                                       "doubled_messages",
                                                       "reordered_messages",
                                                       "cut_to_worker",
                                                       "cut_to_scheduler",
                                                       "cut_both_ways",
                                                       "reset",
                                                       "half_open",
                                                       "narrow_link",
                                                       "kill_scheduler",
                                                       "power_cut",
                                                       "stop_scheduler",
                                                       "suspend_scheduler",
                                                       "scheduler_clock_jump",
                                                       "ask_to_stop",
                                                       "second_scheduler",
                                                       "lock_file_removed",
                                                       "write_error",
                                                       "short_write",
                                                       "sync_error",
                                                       "rename_error",
                                                       "full_disk",
                                                       "journal_rot",
                                                       "table_rot",
                                                       "tables_lost",
                                                       "kill_worker",
                                                       "stop_worker",
                                                       "suspend_worker",
                                                       "worker_clock_jump",
                                                       "interrupt_worker",
                                                       "hung_solver",
                                                       "out_of_memory",
                                                       "slow_solve",
                                                       "deadly_transition"};

/// Most accidents last a moment, some longer than any patience.
double lengthOf(Random& random) {
  const double longest = random.chance(0.3) ? 100 : random.chance(0.5) ? 15 : 3;
  return random.between(0.01, longest);
}

}  // namespace

std::string_view nameOf(Accident accident) { return names[static_cast<std::size_t>(accident)]; }

std::string describe(const Event& event) {
  return fmt::format("at {:.3f} s {} for {:.3f} s (who {}, how much {:.3f})", event.at,
                     nameOf(event.accident), event.length, event.who % 1000, event.how_much);
}

std::vector<Event> historyOf(std::uint64_t seed) {
  Random random(seed ^ 0x68697374);
  std::vector<Accident> possible;
  const double share = random.between(0.1, 0.9);
  for (std::size_t kind = 0; kind < kinds; ++kind)
    if (random.chance(share)) possible.push_back(static_cast<Accident>(kind));
  std::vector<Event> events;
  if (possible.empty()) return events;
  const std::size_t count = 1 + random.below(random.chance(0.2) ? 40 : 12);
  // A build without accidents takes some minutes.
  const double span = random.chance(0.5) ? 50 : 200;
  for (std::size_t n = 0; n < count; ++n) {
    Event event;
    event.accident = possible[random.below(possible.size())];
    event.at = random.between(0, span);
    event.length = std::min(lengthOf(random), accidents_end_s - event.at);
    event.who = random.next() >> 1;
    event.how_much = random.between(0, 1);
    events.push_back(event);
  }
  std::ranges::sort(events, {}, &Event::at);
  return events;
}

}  // namespace palpate::simulation
