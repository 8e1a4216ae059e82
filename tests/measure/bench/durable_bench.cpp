// How many results per second a scheduler makes durable, at which cost, and how many the disk alone
// could take. Runs a real `palpate-scheduler serve` on a port of this machine, and workers in this
// process that speak the real protocol and answer at once (or after --solve-ms) with the results of
// a linear body. In between, records of the same size are appended and synced without a scheduler,
// in groups as large as its largest.
// Prints one JSON object. Checks nothing, because times depend on the machine and its disk.
//
//   palpate_durable_bench [--seconds 10] [--workers 4] [--solve-ms 0] [--cells 3] [--points 11500]
//                         [--directory DIR] [--insecure]

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <sstream>
#include <zmq.hpp>

#include "common/base/error.hpp"
#include "scheduler/service/coordinator.hpp"
#include "tests/support/table_worker.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/system/process.hpp"

namespace palpate {
namespace {

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// What a process has used and written so far.
struct Usage {
  double processor_seconds = 0;
  double written = 0;  ///< bytes passed to the system
  double to_disk = 0;  ///< bytes in whole pages

  Usage& operator+=(const Usage& other) {
    processor_seconds += other.processor_seconds;
    written += other.written;
    to_disk += other.to_disk;
    return *this;
  }
  Usage operator-(const Usage& other) const {
    return {processor_seconds - other.processor_seconds, written - other.written,
            to_disk - other.to_disk};
  }
};

Usage usageOf(pid_t pid) {
  const std::string proc = "/proc/" + std::to_string(pid);
  // The name in parentheses may contain any characters.
  const std::string stat = test::contentOf(proc + "/stat");
  std::istringstream fields(stat.substr(stat.rfind(')') + 2));
  std::string skipped;
  for (int n = 3; n < 14; ++n) fields >> skipped;
  double user = 0, system = 0;
  fields >> user >> system;
  Usage usage{(user + system) / static_cast<double>(sysconf(_SC_CLK_TCK))};
  std::ifstream io(proc + "/io");
  std::string name;
  for (double bytes = 0; io >> name >> bytes;) {
    if (name == "wchar:") usage.written = bytes;
    if (name == "write_bytes:") usage.to_disk = bytes;
  }
  return usage;
}

/// A file beside the journal to which groups of this many bytes are appended and synced.
class BareDisk {
 public:
  BareDisk(const std::filesystem::path& directory, std::size_t group_bytes)
      : path_(directory / "raw"), group_(group_bytes, 'x') {
    file_ = open(path_.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
    if (file_ < 0) throw failure("{}: {}", path_.string(), errnoText());
  }
  ~BareDisk() { close(file_); }
  BareDisk(const BareDisk&) = delete;
  BareDisk& operator=(const BareDisk&) = delete;

  void writeFor(double seconds) {
    const auto began = Clock::now();
    for (; secondsSince(began) < seconds; ++syncs_)
      if (write(file_, group_.data(), group_.size()) != std::ssize(group_) || fdatasync(file_) != 0)
        throw failure("{}: {}", path_.string(), errnoText());
    seconds_ += secondsSince(began);
  }
  double syncsPerSecond() const { return syncs_ / seconds_; }

 private:
  std::filesystem::path path_;
  std::string group_;
  int file_ = -1, syncs_ = 0;
  double seconds_ = 0;
};

struct Options {
  double seconds = 10;
  int workers = 4, solve_ms = 0;
  int cells = 3;
  double points = 11500;
  std::string directory;
  bool insecure = false;
};

void measure(const Options& options, const std::filesystem::path& directory) {
  constexpr double slice = 1;  // s
  test::writeEndlessScene(directory, options.cells, 20, options.points);
  std::vector<std::string> arguments = {"serve",   "cube.toml", "--listen", "tcp://127.0.0.1:*",
                                        "--state", "state",     "-o",       "cube.h5",
                                        "--quiet"};
  if (options.insecure) arguments.emplace_back("--insecure");
  test::Process scheduler("palpate-scheduler", arguments, directory);
  std::string endpoint;
  if (!test::eventually([&] {
        endpoint = test::endpointAnnouncedIn(directory / "state");
        return !endpoint.empty() || !scheduler.running();
      }) ||
      endpoint.empty())
    throw failure("the scheduler does not listen: {}", scheduler.output());

  zmq::context_t context;
  std::vector<test::TableWorker> workers;
  for (int n = 0; n < options.workers; ++n)
    workers.emplace_back(
        context, endpoint,
        options.insecure ? std::nullopt : std::optional(KeyFolder(directory / "keys")), n,
        std::chrono::milliseconds(options.solve_ms));
  std::vector<zmq::pollitem_t> sockets;
  for (test::TableWorker& worker : workers)
    sockets.push_back({worker.socket().handle(), 0, ZMQ_POLLIN, 0});
  const auto acknowledged = [&] {
    std::size_t sum = 0;
    for (const test::TableWorker& worker : workers) sum += worker.acknowledged();
    return sum;
  };
  const auto workFor = [&](double seconds) {
    for (const auto began = Clock::now(); secondsSince(began) < seconds;) {
      zmq::poll(sockets, std::chrono::milliseconds(10));
      for (test::TableWorker& worker : workers) worker.turn();
      if (!scheduler.running()) throw failure("the scheduler ended: {}", scheduler.output());
    }
  };
  const auto journal = [&] {
    double sum = 0;
    for (const auto& entry : std::filesystem::directory_iterator(directory / "state"))
      if (entry.path().extension() == ".dat") sum += static_cast<double>(entry.file_size());
    return sum;
  };
  // At first only a few steps from rest are ready. After these, all workers always have work.
  const auto began = Clock::now();
  while (acknowledged() < 500 && secondsSince(began) < 60) workFor(0.05);
  const std::size_t first = acknowledged();
  if (first < 500) throw failure("nothing is acknowledged: {}", scheduler.output());
  const double record = journal() / static_cast<double>(first);
  const CoordinatorSettings settings;
  const double group = std::min(static_cast<double>(settings.group_results),
                                static_cast<double>(settings.group_bytes) / record);
  const auto group_bytes = static_cast<std::size_t>(group * record);

  // The scheduler and the bare disk take turns of one second, because a disk becomes slower after
  // many writes.
  BareDisk disk(directory, group_bytes);
  Usage used, own_used;
  double seconds = 0, results = 0, journaled = 0;
  while (seconds < options.seconds) {
    disk.writeFor(slice / 2);
    const Usage before = usageOf(scheduler.pid()), own_before = usageOf(getpid());
    const double journal_before = journal();
    const std::size_t done_before = acknowledged();
    const auto measured = Clock::now();
    workFor(std::min(slice, options.seconds));
    seconds += secondsSince(measured);
    results += static_cast<double>(acknowledged() - done_before);
    journaled += journal() - journal_before;
    used += usageOf(scheduler.pid()) - before;
    own_used += usageOf(getpid()) - own_before;
  }
  const double rate = results / seconds, bare_rate = group * disk.syncsPerSecond();
  fmt::print(
      "{{\"workers\":{},\"seconds\":{:.2f},\"results\":{},\"results_per_second\":{:.0f},"
      "\"scheduler_cpu_us_per_result\":{:.1f},\"scheduler_cpu_share\":{:.2f},"
      "\"workers_cpu_us_per_result\":{:.1f},\"payload_bytes\":{},\"journal_bytes_per_result\":{:.0f},"
      "\"written_bytes_per_result\":{:.0f},\"to_disk_bytes_per_result\":{:.0f},"
      "\"disk_syncs_per_second\":{:.0f},\"disk_results_per_second\":{:.0f},"
      "\"share_of_the_disk\":{:.2f}}}\n",
      options.workers, seconds, results, rate, 1e6 * used.processor_seconds / results,
      used.processor_seconds / seconds, 1e6 * own_used.processor_seconds / results,
      workers[0].payloadBytes(), journaled / results, used.written / results,
      used.to_disk / results, disk.syncsPerSecond(), bare_rate, rate / bare_rate);
}

int run(int argc, char** argv) {
  Options options;
  CLI::App app{"Results a second that a scheduler makes durable"};
  app.add_option("--seconds", options.seconds, "How long it is measured")->capture_default_str();
  app.add_option("--workers", options.workers, "Workers, all in this process")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--solve-ms", options.solve_ms, "Time that a worker takes for each result")
      ->capture_default_str();
  app.add_option("--cells", options.cells, "Edges of the cube: its results hold 12 (n + 1)^3 bytes")
      ->check(CLI::Range(2, 100))
      ->capture_default_str();
  app.add_option("--points", options.points, "Points of each of 20 spaces, about")
      ->capture_default_str();
  app.add_option("--directory", options.directory, "A folder on the disk that is measured [/tmp]")
      ->check(CLI::ExistingDirectory);
  app.add_flag("--insecure", options.insecure, "Without keys");
  app.footer(
      "..._cpu_us_per_result: user and system time. Scheduler and workers compete for the\n"
      "  cores of a small machine.\n"
      "written_bytes_per_result: into journal and tables. to_disk_bytes_per_result: whole\n"
      "  pages that reach the disk.\n"
      "disk_results_per_second: records of this size that the bare disk stores, synced in\n"
      "  groups like the scheduler's.\n"
      "share_of_the_disk: results_per_second divided by disk_results_per_second, which can\n"
      "  be compared between machines.");
  CLI11_PARSE(app, argc, argv);
  if (!options.directory.empty()) setenv("TMPDIR", options.directory.c_str(), 1);
  const test::TemporaryDirectory directory;
  measure(options, directory.path());
  return 0;
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  try {
    return palpate::run(argc, argv);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
