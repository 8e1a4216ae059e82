#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "common/base/machine.hpp"
#include "tests/simulation/planted.hpp"
#include "tests/simulation/world.hpp"
#include "tests/support/temporary_directory.hpp"

namespace palpate::simulation {
namespace {

struct Options {
  std::uint64_t seeds = 1000, first = 1;
  unsigned jobs = coreCount();
  std::vector<std::size_t> only;  ///< accidents of the history, by number
  bool json = false, list_planted = false, story = false;
  std::string planted;
};

/// In memory if possible, where a sync costs nothing.
std::filesystem::path whereToWork() {
  const char* memory = "/dev/shm";
  return access(memory, W_OK | X_OK) == 0 ? memory : std::filesystem::temp_directory_path();
}

/// Summary of many seeds.
struct Summary {
  std::uint64_t seeds = 0;
  double simulated = 0;
  std::vector<std::uint64_t> failed;
  std::map<std::string, std::uint64_t> active;  ///< seeds in which an accident took effect
  std::uint64_t lied = 0;                       ///< seeds in which the scheduler received lies
  std::uint64_t found_out = 0;                  ///< seeds in which a liar was excluded
  std::vector<std::uint64_t> spoiled;           ///< seeds with an undetected lie in the dataset
  /// Seeds in `lied` and in `spoiled` in which the tables, which hold the checks, were damaged or
  /// lost.
  std::uint64_t lied_without_tables = 0, spoiled_without_tables = 0;

  void add(std::uint64_t seed, const Outcome& outcome) {
    ++seeds;
    simulated += outcome.simulated;
    if (outcome.broken) failed.push_back(seed);
    for (const auto& [accident, count] : outcome.felt)
      if (count > 0) ++active[std::string(nameOf(accident))];
    lied += outcome.lies > 0;
    found_out += outcome.verdicts > 0;
    if (outcome.spoiled) spoiled.push_back(seed);
    lied_without_tables += outcome.lies > 0 && outcome.tables_hurt;
    spoiled_without_tables += outcome.spoiled && outcome.tables_hurt;
  }
  void add(const Summary& other) {
    seeds += other.seeds;
    simulated += other.simulated;
    failed.insert(failed.end(), other.failed.begin(), other.failed.end());
    for (const auto& [name, count] : other.active) active[name] += count;
    lied += other.lied;
    found_out += other.found_out;
    spoiled.insert(spoiled.end(), other.spoiled.begin(), other.spoiled.end());
    lied_without_tables += other.lied_without_tables;
    spoiled_without_tables += other.spoiled_without_tables;
  }
  /// Whether more than one in a hundred seeds with lies are spoiled, or more than one in a hundred
  /// of those with undamaged tables. The first needs more seeds, because its expected share is half
  /// of that.
  bool tooManySpoiled() const {
    const auto tooMany = [](std::uint64_t bad, std::uint64_t of, std::uint64_t enough) {
      return of >= enough && 100 * bad > of;
    };
    return tooMany(spoiled.size(), lied, 500) ||
           tooMany(spoiled.size() - spoiled_without_tables, lied - lied_without_tables, 100);
  }
  bool isBad() const { return !failed.empty() || tooManySpoiled(); }
};

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Summary, seeds, simulated, failed, active, lied, found_out,
                                   spoiled, lied_without_tables, spoiled_without_tables)

std::vector<Event> historyFor(std::uint64_t seed, const std::vector<std::size_t>& only) {
  const std::vector<Event> all = historyOf(seed);
  if (only.empty()) return all;
  std::vector<Event> some;
  for (const std::size_t n : only)
    if (n < all.size()) some.push_back(all[n]);
  return some;
}

/// The share of one process: every `of`-th seed.
Summary runShare(const Options& options, unsigned share, unsigned of) {
  const test::TemporaryDirectory folder(whereToWork());
  const Scenarios scenarios(folder.path());
  Summary summary;
  for (std::uint64_t n = share; n < options.seeds; n += of) {
    const std::uint64_t seed = options.first + n;
    summary.add(seed,
                simulate(scenarios, seed, historyFor(seed, options.only), folder.path() / "world"));
  }
  return summary;
}

/// Distributes the seeds among processes, because a simulation needs its own process.
Summary runAll(const Options& options) {
  std::vector<std::pair<pid_t, int>> children;
  for (unsigned share = 0; share < options.jobs; ++share) {
    std::array<int, 2> ends{};
    if (pipe(ends.data()) != 0)
      throw std::runtime_error("pipe: " + std::string(std::strerror(errno)));
    const pid_t child = fork();
    if (child < 0) throw std::runtime_error("fork: " + std::string(std::strerror(errno)));
    if (child == 0) {
      close(ends[0]);
      int code = 1;
      try {
        const std::string text = nlohmann::json(runShare(options, share, options.jobs)).dump();
        if (write(ends[1], text.data(), text.size()) == static_cast<ssize_t>(text.size())) code = 0;
      } catch (const std::exception& error) {
        fmt::print(stderr, "simulation: {}\n", error.what());
      }
      _exit(code);
    }
    close(ends[1]);
    children.emplace_back(child, ends[0]);
  }
  Summary all;
  bool whole = true;
  for (const auto& [child, end] : children) {
    std::string text;
    std::array<char, 1 << 16> chunk{};
    for (ssize_t n = 0; (n = read(end, chunk.data(), chunk.size())) > 0;)
      text.append(chunk.data(), static_cast<std::size_t>(n));
    close(end);
    int status = 0;
    waitpid(child, &status, 0);
    whole = whole && status == 0;
    if (status == 0) all.add(nlohmann::json::parse(text).get<Summary>());
  }
  if (!whole) throw std::runtime_error("a process of the simulation did not end well");
  std::ranges::sort(all.failed);
  std::ranges::sort(all.spoiled);
  return all;
}

/// Removes accidents that are not needed for the failure, one after the other.
std::vector<std::size_t> minimised(const Scenarios& scenarios, std::uint64_t seed,
                                   std::vector<std::size_t> needed,
                                   const std::filesystem::path& folder) {
  for (bool smaller = true; smaller;) {
    smaller = false;
    for (std::size_t n = needed.size(); n-- > 0;) {
      std::vector<std::size_t> fewer = needed;
      fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(n));
      std::vector<Event> events;
      for (const std::size_t event : fewer) events.push_back(historyOf(seed)[event]);
      if (!simulate(scenarios, seed, events, folder).broken) continue;
      needed = std::move(fewer);
      smaller = true;
    }
  }
  return needed;
}

/// Prints how a seed fails, with as few accidents as possible.
void explain(const Options& options, std::uint64_t seed) {
  const test::TemporaryDirectory folder(whereToWork());
  const Scenarios scenarios(folder.path());
  const std::vector<Event> all = historyOf(seed);
  std::vector<std::size_t> numbers = options.only;
  if (numbers.empty())
    for (std::size_t n = 0; n < all.size(); ++n) numbers.push_back(n);
  const std::vector<std::size_t> needed =
      minimised(scenarios, seed, numbers, folder.path() / "world");
  std::vector<Event> events;
  for (const std::size_t n : needed) events.push_back(all[n]);
  const Outcome outcome = simulate(scenarios, seed, events, folder.path() / "world");
  fmt::print("seed {} fails {}\n", seed, outcome.broken.value_or("(not alone)"));
  for (const std::string& line : outcome.story) fmt::print("  {}\n", line);
  fmt::print("{} of its {} accidents do it; again: --seeds 1 --first {}{}{} --story\n",
             needed.size(), all.size(), seed, needed.empty() ? "" : " --only ",
             fmt::join(needed, ","));
}

void tellSpoiled(const Summary& summary) {
  fmt::print(
      "lies under {} seeds, found out under {}, spoiled datasets: {}{}{} ({} where tables "
      "were damaged){}\n",
      summary.lied, summary.found_out, summary.spoiled.size(),
      summary.spoiled.empty() ? "" : ", seeds ", fmt::join(summary.spoiled, ","),
      summary.spoiled_without_tables,
      summary.tooManySpoiled() ? ": more than one in a hundred" : "");
}

int run(const Options& options) {
  const auto began = std::chrono::steady_clock::now();
  const Summary summary = runAll(options);
  const double took =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  constexpr std::size_t explained = 3;
  for (std::size_t n = 0; n < std::min(explained, summary.failed.size()); ++n)
    explain(options, summary.failed[n]);
  nlohmann::json json = summary;
  json["seconds"] = took;
  if (options.json) {
    fmt::print("{}\n", json.dump());
  } else {
    fmt::print(
        "{} seeds from {}, {:.0f} s simulated in {:.1f} s ({:.0f} times real time, {:.1f} "
        "seeds/s)\n",
        summary.seeds, options.first, summary.simulated, took, summary.simulated / took,
        static_cast<double>(summary.seeds) / took);
    for (const auto& [name, seeds] : summary.active)
      fmt::print("  {:22} in {:5.1f} % of the seeds\n", name,
                 100.0 * static_cast<double>(seeds) / static_cast<double>(summary.seeds));
    tellSpoiled(summary);
    fmt::print("{} failed\n", summary.failed.size());
  }
  return summary.isBad() ? 1 : 0;
}

/// Runs seeds until they find a defect or are used up.
Summary untilFound(const Options& options, const Scenarios& scenarios,
                   const std::filesystem::path& folder) {
  Summary summary;
  while (summary.seeds < options.seeds && !summary.isBad()) {
    const std::uint64_t seed = options.first + summary.seeds;
    summary.add(seed, simulate(scenarios, seed, historyOf(seed), folder));
  }
  return summary;
}

int findPlanted(const Options& options) {
  const test::TemporaryDirectory folder(whereToWork());
  const Scenarios scenarios(folder.path());
  std::size_t planted_count = 0, found_count = 0;
  for (const Defect& defect : plantedDefects()) {
    if (options.planted != "all" && options.planted != defect.name) continue;
    ++planted_count;
    plant(std::string(defect.name));
    const Summary summary = untilFound(options, scenarios, folder.path() / "world");
    if (!summary.isBad()) {
      fmt::print("{:30} NOT FOUND within {} seeds ({})\n", defect.name, options.seeds, defect.what);
      continue;
    }
    ++found_count;
    fmt::print("{:30} found after {} seeds ({})\n", defect.name, summary.seeds, defect.what);
    std::fflush(stdout);
    if (options.planted == "all") continue;
    if (summary.failed.empty()) tellSpoiled(summary);
    for (const std::uint64_t seed : summary.failed) explain(options, seed);
  }
  if (planted_count == 0) throw std::runtime_error("no such defect: --list-planted names them");
  fmt::print("{} of {} planted defects found\n", found_count, planted_count);
  if (options.json)
    fmt::print("{}\n", nlohmann::json{{"planted", planted_count}, {"found", found_count}}.dump());
  return found_count == planted_count ? 0 : 1;
}

int showStory(const Options& options) {
  const test::TemporaryDirectory folder(whereToWork());
  const Scenarios scenarios(folder.path());
  const Outcome outcome = simulate(
      scenarios, options.first, historyFor(options.first, options.only), folder.path() / "world");
  for (const std::string& line : outcome.story) fmt::print("{}\n", line);
  fmt::print("{}\n", outcome.broken    ? "broken " + *outcome.broken
                     : outcome.spoiled ? "spoiled by lies that nobody found out"
                                       : "whole");
  return outcome.broken ? 1 : 0;
}

/// The program with planted defects lies beside this one.
[[noreturn]] void runPlanted(char** words) {
  std::string beside = std::filesystem::read_symlink("/proc/self/exe").string() + "_planted";
  execv(beside.c_str(), words);
  throw std::runtime_error(beside + ": " + std::strerror(errno) +
                           ": build the target palpate_simulation_planted first");
}

int main(int count, char** words) {
  Options options;
  CLI::App app(
      "Simulates scheduler, workers, network, disk and clocks under many seeds, with accidents, in "
      "one thread each (tests/simulation/README.md)");
  app.add_option("--seeds", options.seeds, "Number of seeds, one after another")
      ->capture_default_str();
  app.add_option("--first", options.first, "The first seed")->capture_default_str();
  app.add_option("-j,--jobs", options.jobs, "Processes")->check(CLI::Range(1, 1024));
  app.add_option("--only", options.only, "Only the accidents with these numbers in each history")
      ->delimiter(',');
  app.add_flag("--story", options.story, "Tell what happens under the first seed");
  app.add_flag("--json", options.json, "The last line of the output is JSON");
  app.add_option("--planted", options.planted,
                 "Simulate with this defect planted, or with each (all): the seeds must find it");
  app.add_flag("--list-planted", options.list_planted, "Name the defects that can be planted");
  CLI11_PARSE(app, count, words);
  spdlog::set_level(options.story ? spdlog::level::debug : spdlog::level::off);
  if (options.list_planted || !options.planted.empty()) {
    if (plantedDefects().empty()) runPlanted(words);
    if (!options.list_planted) return findPlanted(options);
    for (const Defect& defect : plantedDefects())
      fmt::print("{:30} {}\n", defect.name, defect.what);
    return 0;
  }
  if (options.story) return showStory(options);
  return run(options);
}

}  // namespace
}  // namespace palpate::simulation

int main(int count, char** words) {
  try {
    return palpate::simulation::main(count, words);
  } catch (const std::exception& error) {
    fmt::print(stderr, "simulation: {}\n", error.what());
    return 1;
  }
}
