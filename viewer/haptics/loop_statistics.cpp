#include "viewer/haptics/loop_statistics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/base/index.hpp"
#include "viewer/haptics/haptic_tick.hpp"

namespace palpate {
namespace {

constexpr double smallest_time = 16e-9;  // s, lower edge of the first bin

/// The histograms, with the names that text and JSON use for them.
constexpr std::array<std::pair<const char*, TimeHistogram LoopStatistics::*>, 4> histograms = {
    {{"period", &LoopStatistics::period},
     {"latency", &LoopStatistics::latency},
     {"compute", &LoopStatistics::compute},
     {"processor", &LoopStatistics::processor}}};

nlohmann::ordered_json toJson(const TimeHistogram& times) {
  nlohmann::ordered_json bins = nlohmann::ordered_json::array();
  for (const TimeHistogram::Bin& bin : times.bins())
    bins.push_back({1e6 * bin.upper_edge, bin.count});
  return {{"count", times.count()},
          {"mean", 1e6 * times.mean()},
          {"p50", 1e6 * times.quantile(0.5)},
          {"p99", 1e6 * times.quantile(0.99)},
          {"p99_9", 1e6 * times.quantile(0.999)},
          {"largest", 1e6 * times.largest()},
          {"bins", bins}};
}

}  // namespace

void TimeHistogram::add(double seconds) noexcept {
  const double time = seconds > 0 ? seconds : 0;  // 0 for NaN or a clock that went back
  const double bin =
      time > smallest_time ? std::floor(bins_per_octave * std::log2(time / smallest_time)) : 0;
  ++bins_[static_cast<std::size_t>(std::min(bin, static_cast<double>(bins_.size() - 1)))];
  ++count_;
  sum_ += time;
  largest_ = std::max(largest_, time);
}

void TimeHistogram::add(const TimeHistogram& other) noexcept {
  for (std::size_t bin = 0; bin < bins_.size(); ++bin) bins_[bin] += other.bins_[bin];
  count_ += other.count_;
  sum_ += other.sum_;
  largest_ = std::max(largest_, other.largest_);
}

double TimeHistogram::upperEdge(std::size_t bin) {
  return smallest_time * std::exp2(static_cast<double>(bin + 1) / bins_per_octave);
}

double TimeHistogram::quantile(double share) const {
  const double wanted = std::clamp(share, 0.0, 1.0) * static_cast<double>(count_);
  std::uint64_t below = 0;
  for (std::size_t bin = 0; bin + 1 < bins_.size(); ++bin) {
    below += bins_[bin];
    if (below > 0 && static_cast<double>(below) >= wanted)
      return std::min(upperEdge(bin), largest_);
  }
  return largest_;
}

double TimeHistogram::mean() const { return count_ == 0 ? 0 : sum_ / static_cast<double>(count_); }

std::vector<TimeHistogram::Bin> TimeHistogram::bins() const {
  std::vector<Bin> bins;
  for (std::size_t bin = 0; bin < bins_.size(); ++bin)
    if (bins_[bin] > 0) bins.push_back({upperEdge(bin), bins_[bin]});
  return bins;
}

void count(LoopStatistics& statistics, const HapticState& before,
           const HapticState& state) noexcept {
  ++statistics.ticks;
  for (std::size_t bit = 0; bit < statistics.guards.size(); ++bit)
    if ((state.guards >> bit & 1U) != 0) ++statistics.guards[bit];
  if (state.touch.touching && !before.touch.touching) ++statistics.contacts;
  statistics.largest_force = std::max(statistics.largest_force, state.force.norm());
  statistics.largest_step = std::max(statistics.largest_step, (state.force - before.force).norm());
}

void add(LoopStatistics& total, const LoopStatistics& part) noexcept {
  total.rate = part.rate;
  for (const auto& [name, times] : histograms) (total.*times).add(part.*times);
  for (std::uint64_t LoopStatistics::*number :
       {&LoopStatistics::ticks, &LoopStatistics::missed_program, &LoopStatistics::missed_system,
        &LoopStatistics::halts, &LoopStatistics::page_faults, &LoopStatistics::preemptions,
        &LoopStatistics::not_recorded, &LoopStatistics::contacts})
    total.*number += part.*number;
  for (std::size_t bit = 0; bit < total.guards.size(); ++bit) total.guards[bit] += part.guards[bit];
  total.largest_force = std::max(total.largest_force, part.largest_force);
  total.largest_step = std::max(total.largest_step, part.largest_step);
}

std::string describe(const LoopStatistics& statistics) {
  std::string text =
      fmt::format("{} ticks at {} Hz\n{:<10}{:>11}{:>11}{:>11}{:>11}{:>11}\n", statistics.ticks,
                  statistics.rate, "us", "mean", "p50", "p99", "p99.9", "largest");
  for (const auto& [name, member] : histograms) {
    const TimeHistogram& times = statistics.*member;
    text += fmt::format("{:<10}{:>11.1f}{:>11.1f}{:>11.1f}{:>11.1f}{:>11.1f}\n", name,
                        1e6 * times.mean(), 1e6 * times.quantile(0.5), 1e6 * times.quantile(0.99),
                        1e6 * times.quantile(0.999), 1e6 * times.largest());
  }
  text += fmt::format("missed deadlines: {} by the program, {} by the operating system\n",
                      statistics.missed_program, statistics.missed_system);
  text += fmt::format(
      "page faults {}, preemptions {}, halts by the watchdog {}, states not recorded {}\n",
      statistics.page_faults, statistics.preemptions, statistics.halts, statistics.not_recorded);
  text += fmt::format("contacts {}, largest force {:.4g} N, largest step between ticks {:.4g} N\n",
                      statistics.contacts, statistics.largest_force, statistics.largest_step);
  for (int bit = 0; bit < guard_count; ++bit)
    if (const std::uint64_t ticks = statistics.guards[at(bit)]; ticks > 0)
      text +=
          fmt::format("force {}: {} ticks, {:.2f} %\n", guardWord(bit), ticks,
                      100.0 * static_cast<double>(ticks) / static_cast<double>(statistics.ticks));
  return text;
}

std::string describeJson(const LoopStatistics& statistics) {
  nlohmann::ordered_json json = {{"rate", statistics.rate}, {"ticks", statistics.ticks}};
  for (const auto& [name, times] : histograms)
    json[fmt::format("{}_us", name)] = toJson(statistics.*times);
  nlohmann::ordered_json guards;
  for (int bit = 0; bit < guard_count; ++bit) guards[guardWord(bit)] = statistics.guards[at(bit)];
  json.update({{"missed_program", statistics.missed_program},
               {"missed_system", statistics.missed_system},
               {"halts", statistics.halts},
               {"page_faults", statistics.page_faults},
               {"preemptions", statistics.preemptions},
               {"guards", guards},
               {"not_recorded", statistics.not_recorded},
               {"contacts", statistics.contacts},
               {"largest_force", statistics.largest_force},
               {"largest_step", statistics.largest_step}});
  return json.dump();
}

}  // namespace palpate
