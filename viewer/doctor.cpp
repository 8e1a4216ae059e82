#include "viewer/doctor.hpp"

#include <sys/resource.h>
#include <sys/utsname.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <boost/asio/ip/tcp.hpp>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "common/base/foreign_program.hpp"
#include "viewer/haptics/real_time.hpp"

namespace palpate {
namespace {

using Verdict = Finding::Verdict;

std::string realTimeAdvice() {
  return fmt::format(
      "add \"@realtime - rtprio {}\" and \"@realtime - memlock unlimited\" to "
      "/etc/security/limits.d, join the group realtime and log in again; without this the loop "
      "still runs, but wakes late more often",
      highest_priority);
}

std::string firstLine(const std::filesystem::path& file) {
  std::string line;
  std::ifstream stream(file);
  std::getline(stream, line);
  return line;
}

Finding realTimePriority() {
  const int refusal = refusalOfPriority(highest_priority);
  const std::string asked = fmt::format("SCHED_FIFO {} is", highest_priority);
  if (refusal == 0) return {Verdict::good, "real-time priority", asked + " granted (--real-time)"};
  return {Verdict::note, "real-time priority",
          fmt::format("{} refused: {}", asked, std::strerror(refusal)), realTimeAdvice()};
}

Finding lockedMemory() {
  rlimit limit{};
  getrlimit(RLIMIT_MEMLOCK, &limit);
  constexpr rlim_t enough = 1U << 30;
  const std::string found = limit.rlim_cur == RLIM_INFINITY
                                ? "no limit"
                                : fmt::format("at most {} MiB", limit.rlim_cur >> 20);
  if (limit.rlim_cur >= enough) return {Verdict::good, "locked memory", found};
  return {Verdict::note, "locked memory", found, realTimeAdvice()};
}

/// Returns the wake-up latencies of sleeps that begin 1 ms apart, sorted, s.
std::vector<double> wakingLatencies() {
  using Clock = std::chrono::steady_clock;
  constexpr int sleeps = 1000;
  std::vector<double> late;
  Clock::time_point target = Clock::now();
  for (int n = 0; n < sleeps; ++n) {
    target += std::chrono::milliseconds(1);
    std::this_thread::sleep_until(target);
    late.push_back(std::chrono::duration<double>(Clock::now() - target).count());
  }
  std::ranges::sort(late);
  return late;
}

Finding timer() {
  const std::vector<double> late = wakingLatencies();
  const std::string found = fmt::format(
      "wakes {:.0f} us late in the median, {:.0f} us at 99 %, at most {:.0f} us in {} sleeps",
      1e6 * late[late.size() / 2], 1e6 * late[late.size() * 99 / 100], 1e6 * late.back(),
      late.size());
  constexpr double period = 1e-3;
  if (late.back() < period / 2) return {Verdict::good, "timer", found};
  return {Verdict::note, "timer", found,
          "other programs use the processor: end them, or use --real-time"};
}

Finding kernel() {
  utsname name{};
  uname(&name);
  const bool preemptible = firstLine("/sys/kernel/realtime") == "1";
  return {Verdict::good, "kernel",
          fmt::format("{} {}{}", name.sysname, name.release, preemptible ? ", PREEMPT_RT" : "")};
}

Finding processorClock() {
  const std::string governor = firstLine("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor");
  if (governor.empty()) return {Verdict::good, "processor clock", "not managed by this system"};
  if (governor == "performance") return {Verdict::good, "processor clock", governor};
  return {Verdict::note, "processor clock", governor,
          "cpupower frequency-set -g performance keeps the clock high between ticks"};
}

Finding display() {
  for (const char* variable : {"DISPLAY", "WAYLAND_DISPLAY"})
    if (const char* value = std::getenv(variable); value != nullptr && *value != '\0')
      return {Verdict::good, "display", fmt::format("{}={}", variable, value)};
  return {Verdict::note, "display", "none",
          "palpate view --headless needs none; xvfb-run provides one"};
}

Finding haplyService() {
  constexpr std::uint16_t port = 10001;
  const bool answers =
      boost::asio::ip::tcp::iostream(
          boost::asio::ip::tcp::endpoint(boost::asio::ip::address_v4::loopback(), port))
          .good();
  return {Verdict::good, "Haply service",
          answers
              ? fmt::format("answers on port {} (--device haply)", port)
              : fmt::format("nothing listens on port {}: start Haply's service to use an Inverse3",
                            port)};
}

/// Asks the worker for its kernels, because the viewer does not link OpenBLAS.
Finding solverKernels() {
  constexpr const char* topic = "solver kernels";
  std::string worker;
  try {
    worker = programBeside("palpate-worker").string();
  } catch (const Error& error) {
    return {Verdict::note, topic, error.what(), "only machines that run workers need it"};
  }
  Ran ran;
  try {
    ran = runToItsEnd({.words = {worker, "kernels"}, .package = "palpate-worker"});
  } catch (const Error&) {
    // The worker may have been ended by a signal, for example: exit_code then has a value that no
    // program returns.
  }
  if (ran.exit_code != 0)
    return {Verdict::bad, topic, fmt::format("{} kernels failed", worker), "run it to see why"};
  std::string kernels, advice;
  std::istringstream lines(ran.out);
  std::getline(lines, kernels);
  std::getline(lines, advice);
  return {advice.empty() ? Verdict::good : Verdict::note, topic, kernels, advice};
}

const char* word(Verdict verdict) {
  constexpr std::array<const char*, 3> words = {"ok", "note", "BAD"};
  return words[static_cast<std::size_t>(verdict)];
}

std::function<ExitCode()> prepareDoctor(CLI::App& app) {
  auto json = std::make_shared<bool>(false);
  app.add_flag("--json", *json, "One JSON object per finding and line");
  app.footer("Changes nothing and opens no device. Exit codes: 0 done, 1 something will not work.");
  return [json] {
    const std::vector<Finding> findings = examineMachine();
    std::cout << (*json ? describeJson(findings) : describe(findings));
    const bool bad = std::ranges::count(findings, Verdict::bad, &Finding::verdict) > 0;
    return bad ? ExitCode::failed : ExitCode::done;
  };
}

}  // namespace

std::vector<Finding> examineMachine() {
  return {kernel(),         timer(),   realTimePriority(), lockedMemory(),
          processorClock(), display(), haplyService(),     solverKernels()};
}

std::string describe(const std::vector<Finding>& findings) {
  std::string text;
  for (const Finding& finding : findings) {
    text += fmt::format("{:<5}{:<20}{}\n", word(finding.verdict), finding.topic, finding.found);
    if (!finding.advice.empty()) text += fmt::format("{:<25}-> {}\n", "", finding.advice);
  }
  return text;
}

std::string describeJson(const std::vector<Finding>& findings) {
  std::string text;
  for (const Finding& finding : findings) {
    const nlohmann::ordered_json line = {{"topic", finding.topic},
                                         {"verdict", word(finding.verdict)},
                                         {"found", finding.found},
                                         {"advice", finding.advice}};
    text += line.dump() + '\n';
  }
  return text;
}

const Verb doctor_verb = {"doctor", "Check whether this machine can run the haptic client",
                          prepareDoctor};

}  // namespace palpate
