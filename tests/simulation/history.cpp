#include "tests/simulation/history.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <sstream>

#include "common/base/assertion.hpp"
#include "tests/simulation/random.hpp"

namespace palpate::simulation {
namespace {

constexpr auto kinds = static_cast<std::size_t>(Accident::count);
/// Kinds of accidents that any history may have.
constexpr auto common_kinds = static_cast<std::size_t>(Accident::lying_worker);
constexpr double share_with_liars = 0.25;
/// In the order of the enumerators.
constexpr const char* names =
    "slow_network lost_messages doubled_messages reordered_messages cut_to_worker "
    "cut_to_scheduler cut_both_ways reset half_open narrow_link kill_scheduler power_cut "
    "stop_scheduler suspend_scheduler scheduler_clock_jump ask_to_stop second_scheduler "
    "lock_file_removed write_error short_write sync_error rename_error full_disk journal_rot "
    "table_rot tables_lost kill_worker stop_worker suspend_worker worker_clock_jump "
    "interrupt_worker hung_solver out_of_memory slow_solve deadly_transition lying_worker "
    "kill_at_verdict";

/// Most accidents are short, some exceed all timeouts.
double lengthOf(Random& random) {
  const double longest = random.chance(0.3) ? 100 : random.chance(0.5) ? 15 : 3;
  return random.between(0.01, longest);
}

Event randomEvent(Accident accident, Random& random, double span) {
  Event event;
  event.accident = accident;
  event.at = random.between(0, span);
  event.length = std::min(lengthOf(random), accidents_end_s - event.at);
  event.who = random.next() >> 1;
  event.how_much = random.between(0, 1);
  return event;
}

/// From some time on one machine lies. The scheduler that detects it may be killed.
void addLiar(std::vector<Event>& events, std::uint64_t seed) {
  Random random(seed ^ 0x6c696172);
  events.push_back(randomEvent(Accident::lying_worker, random, 60));
  if (random.chance(0.5)) events.push_back(randomEvent(Accident::kill_at_verdict, random, 60));
}

std::vector<Event> inOrder(std::vector<Event> events) {
  std::ranges::sort(events, {}, &Event::at);
  return events;
}

}  // namespace

bool mayHaveLiar(std::uint64_t seed) { return Random(seed ^ 0x6c696573).chance(share_with_liars); }

std::string_view nameOf(Accident accident) {
  static const std::vector<std::string> words = [] {
    std::istringstream in(names);
    return std::vector<std::string>(std::istream_iterator<std::string>(in), {});
  }();
  PALPATE_ASSERT(words.size() == kinds, "each accident has a name");
  return words.at(static_cast<std::size_t>(accident));
}

std::string describe(const Event& event) {
  return fmt::format("at {:.3f} s {} for {:.3f} s (who {}, how much {:.3f})", event.at,
                     nameOf(event.accident), event.length, event.who % 1000, event.how_much);
}

std::vector<Event> historyOf(std::uint64_t seed) {
  Random random(seed ^ 0x68697374);
  std::vector<Accident> possible;
  const double share = random.between(0.1, 0.9);
  for (std::size_t kind = 0; kind < common_kinds; ++kind)
    if (random.chance(share)) possible.push_back(static_cast<Accident>(kind));
  std::vector<Event> events;
  if (mayHaveLiar(seed)) addLiar(events, seed);
  if (possible.empty()) return inOrder(std::move(events));
  const std::size_t count = 1 + random.below(random.chance(0.2) ? 40 : 12);
  // A build without accidents takes a few minutes.
  const double span = random.chance(0.5) ? 50 : 200;
  for (std::size_t n = 0; n < count; ++n) {
    const Accident accident = possible[random.below(possible.size())];
    events.push_back(randomEvent(accident, random, span));
  }
  return inOrder(std::move(events));
}

}  // namespace palpate::simulation
