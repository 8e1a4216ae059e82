// Speed-up of a build with more workers. Repeats a recorded build with 1 to 10,000 simulated
// workers under the real scheduler, and compares it with the limit from the dependencies of its
// transitions (the ideal) and its two bounds: all work divided by the workers, and the longest
// chain. Prints one JSON object. docs/evaluation.md has figures with an explanation.
//
//   palpate_speed_up_bench STATE [--workers 1,10,100] [--solve-ms 150] [--cut-ms 250]
//                          [--latency-ms 0.2] [--scheduler-us 100 | --measured] [--no-checks]

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <nlohmann/json.hpp>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "tests/measure/speed_up/fleet.hpp"
#include "tests/measure/speed_up/ideal.hpp"
#include "tests/support/temporary_directory.hpp"

namespace palpate::speed_up {
namespace {

using nlohmann::json;

struct Options {
  std::filesystem::path state;
  std::vector<std::size_t> workers = {1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1000, 3000, 10000};
  double solve_ms = 0, cut_ms = 0, latency_ms = 0.2, scheduler_us = 0;
  bool measured = false, no_checks = false;
  std::filesystem::path directory = std::filesystem::temp_directory_path();
};

/// Drops meaningless digits.
double rounded(double value, int digits = 4) {
  return std::stod(fmt::format("{:.{}g}", value, digits));
}

json processorOf(const FleetRun& run) {
  const auto results = static_cast<double>(run.results);
  json by_work = json::object();
  for (std::size_t work = 0; work < work_names.size(); ++work)
    by_work[std::string(work_names[work])] = rounded(1e6 * run.processor[work] / results, 3);
  return by_work;
}

json rowOf(const Dependencies& dependencies, const Options& options, std::size_t workers,
           double longest_chain) {
  const Recording& recording = *dependencies.recording;
  const test::TemporaryDirectory folder(options.directory);
  const FleetRun run = runFleet(recording, {.workers = workers,
                                            .latency = 1e-3 * options.latency_ms,
                                            .cost_per_result = 1e-6 * options.scheduler_us,
                                            .charge_measured = options.measured,
                                            .spot_checks = !options.no_checks,
                                            .directory = folder / "state"});
  PALPATE_ASSERT(run.until_solved >= longest_chain * (1 - 1e-9),
                 "no fleet is faster than what waits for what");
  const double ideal = idealOf(dependencies, workers).seconds;
  const double bound = std::max(recording.seconds() / static_cast<double>(workers), longest_chain);
  return {{"workers", workers},
          {"seconds", rounded(run.seconds)},
          {"speed_up", rounded(recording.seconds() / run.seconds)},
          {"ideal_speed_up", rounded(recording.seconds() / ideal)},
          {"most_speed_up", rounded(recording.seconds() / bound)},
          {"share_of_ideal", rounded(ideal / run.seconds, 3)},
          {"share_of_ideal_until_solved", rounded(ideal / run.until_solved, 3)},
          {"checks", run.checks},
          {"workers_busy", rounded(run.worked / run.seconds / static_cast<double>(workers), 3)},
          {"scheduler_busy", rounded(run.busy, 3)},
          {"messages_per_result",
           rounded(static_cast<double>(run.messages) / static_cast<double>(run.results), 3)},
          {"processor_us_per_result",
           rounded(1e6 * run.processorSeconds() / static_cast<double>(run.results), 3)},
          {"processor_us_by_work", processorOf(run)}};
}

json measure(const Options& options) {
  Recording recording(options.state);
  if (options.cut_ms > 0) recording.cutAt(1e-3 * options.cut_ms);
  if (options.solve_ms > 0) recording.scaleTo(1e-3 * options.solve_ms);
  const Dependencies dependencies(recording);
  const Ideal longest_chain = idealOf(dependencies, any_number);
  json rows = json::array();
  for (const std::size_t workers : options.workers) {
    rows.push_back(rowOf(dependencies, options, workers, longest_chain.seconds));
    std::cerr << rows.back().dump() << "\n";  // shows progress
  }
  return {{"scene", recording.problem().scene.name},
          {"spaces", recording.problem().active.size()},
          {"transitions", recording.size()},
          {"work_s", rounded(recording.seconds())},
          {"solve_ms", rounded(1e3 * recording.seconds() / static_cast<double>(recording.size()))},
          {"longest_solve_ms", rounded(1e3 * recording.longest())},
          {"longest_chain_s", rounded(longest_chain.seconds)},
          {"longest_chain", longest_chain.chain},
          {"latency_ms", options.latency_ms},
          {"scheduler_us", options.measured ? json("measured") : json(options.scheduler_us)},
          {"rows", rows}};
}

int run(int argc, char** argv) {
  Options options;
  CLI::App app{"How much faster a recorded build gets by more workers"};
  app.add_option("state", options.state, "State directory of a build that is complete")
      ->required()
      ->check(CLI::ExistingDirectory);
  app.add_option("--workers", options.workers, "Numbers of workers; one simulation for each")
      ->delimiter(',')
      ->check(CLI::Range(1, 10000));
  app.add_option("--solve-ms", options.solve_ms, "Mean time of a solve [as recorded]");
  app.add_option("--cut-ms", options.cut_ms,
                 "Solves recorded as longer took that long: something else stopped them");
  app.add_option("--latency-ms", options.latency_ms, "Delay of a message, one way")
      ->capture_default_str();
  app.add_option("--scheduler-us", options.scheduler_us, "Time that a result costs the scheduler")
      ->capture_default_str();
  app.add_flag("--measured", options.measured,
               "Use the processor time that the scheduler takes here");
  app.add_flag("--no-checks", options.no_checks, "Nothing is solved twice");
  app.add_option("--directory", options.directory, "Where the simulated scheduler keeps its state")
      ->check(CLI::ExistingDirectory)
      ->capture_default_str();
  app.footer(
      "The recorded result of each transition is looked up instead of solved, so the plans\n"
      "  request the same transitions again, in simulated time. The simulation omits the\n"
      "  time in which a worker joins, and the factorisation of a start configuration,\n"
      "  which is done once for all its points.\n"
      "work_s: all solves. longest_chain_s: the build with unlimited workers.\n"
      "ideal_speed_up: by a scheduler that hands out work the moment it is ready and solves\n"
      "  nothing twice.\n"
      "most_speed_up: the smaller of workers and work_s / longest_chain_s.\n"
      "share_of_ideal: speed-up divided by the ideal one until the build is complete, with\n"
      "  spot checks; ..._until_solved: until no plan requests another transition.\n"
      "processor_us_per_result: the scheduler's thread, without ZeroMQ, encryption and\n"
      "  disk; ..._by_work: by kind of work.");
  CLI11_PARSE(app, argc, argv);
  spdlog::set_level(spdlog::level::err);
  std::cout << measure(options).dump(1) << "\n";
  return 0;
}

}  // namespace
}  // namespace palpate::speed_up

int main(int argc, char** argv) {
  try {
    return palpate::speed_up::run(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
}
