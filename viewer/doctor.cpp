#include "viewer/doctor.hpp"

#include <dlfcn.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/utsname.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>

#include "viewer/haptics/real_time.hpp"

namespace palpate {
namespace {

using Verdict = Finding::Verdict;
namespace fs = std::filesystem;

std::string realTimeAdvice() {
  return fmt::format(
      "put \"@realtime - rtprio {}\" and \"@realtime - memlock unlimited\" "
      "into /etc/security/limits.d, join the group realtime, log in again; "
      "without it the loop runs all the same, and is woken late more often",
      highest_priority);
}

std::string firstLine(const fs::path& file) {
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
  if (getrlimit(RLIMIT_MEMLOCK, &limit) != 0)
    return {Verdict::note, "locked memory", fmt::format("unknown: {}", errnoText())};
  if (limit.rlim_cur == RLIM_INFINITY) return {Verdict::good, "locked memory", "no limit"};
  constexpr rlim_t enough = 1U << 30;
  const std::string found = fmt::format("at most {} MiB", limit.rlim_cur >> 20);
  return limit.rlim_cur >= enough
             ? Finding{Verdict::good, "locked memory", found}
             : Finding{Verdict::note, "locked memory", found, realTimeAdvice()};
}

/// How late a thread wakes from sleeps to times 1 ms apart, sorted, seconds.
std::vector<double> wakingLatencies() {
  constexpr std::int64_t step = 1'000'000, second = 1'000'000'000;
  constexpr int sleeps = 1000;
  const auto now = [] {
    timespec time{};
    clock_gettime(CLOCK_MONOTONIC, &time);
    return time.tv_sec * second + time.tv_nsec;
  };
  std::vector<double> late;
  std::int64_t target = now();
  for (int n = 0; n < sleeps; ++n) {
    target += step;
    const timespec wake{target / second, target % second};
    if (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &wake, nullptr) == 0)
      late.push_back(1e-9 * (now() - target));
  }
  std::ranges::sort(late);
  return late;
}

Finding timer() {
  const std::vector<double> late = wakingLatencies();
  if (late.empty()) return {Verdict::bad, "timer", "clock_nanosleep does not work"};
  const std::string found = fmt::format(
      "woken {:.0f} us late in the median, {:.0f} us in 99 of 100, {:.0f} us at worst of {} sleeps",
      1e6 * late[late.size() / 2], 1e6 * late[late.size() * 99 / 100], 1e6 * late.back(),
      late.size());
  constexpr double period = 1e-3;
  if (late.back() < period / 2) return {Verdict::good, "timer", found};
  return {Verdict::note, "timer", found,
          "other programs take the processor: end them, or use --real-time"};
}

Finding kernel() {
  utsname name{};
  if (uname(&name) != 0) return {Verdict::note, "kernel", fmt::format("unknown: {}", errnoText())};
  const bool preemptible = firstLine("/sys/kernel/realtime") == "1";
  return {Verdict::good, "kernel",
          fmt::format("{} {}{}", name.sysname, name.release, preemptible ? ", PREEMPT_RT" : "")};
}

Finding processorClock() {
  const std::string governor = firstLine("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor");
  if (governor.empty()) return {Verdict::good, "processor clock", "not managed by this system"};
  if (governor == "performance") return {Verdict::good, "processor clock", governor};
  return {Verdict::note, "processor clock", governor,
          "cpupower frequency-set -g performance keeps the clock up between ticks"};
}

Finding display() {
  for (const char* variable : {"DISPLAY", "WAYLAND_DISPLAY"})
    if (const char* value = std::getenv(variable); value != nullptr && *value != '\0')
      return {Verdict::good, "display", fmt::format("{}={}", variable, value)};
  return {Verdict::note, "display", "none",
          "palpate view --headless runs without, xvfb-run gives it one"};
}

/// Vendors of haptic devices, by the ids that they are registered with at usb.org.
struct UsbVendor {
  std::string_view vendor, product;  ///< hexadecimal, as in sysfs; empty product: any
  std::string_view name;
};
constexpr std::array<UsbVendor, 2> vendors = {
    {{"1451", "", "Force Dimension"}, {"0403", "cb48", "Novint Falcon"}}};

/// The node in /dev that a USB device of sysfs is opened through.
fs::path nodeOf(const fs::path& device) {
  const auto number = [&](const char* file) { return std::atoi(firstLine(device / file).c_str()); };
  return fmt::format("/dev/bus/usb/{:03}/{:03}", number("busnum"), number("devnum"));
}

void findUsbDevices(std::vector<Finding>& findings) {
  std::error_code none;
  for (const fs::directory_entry& entry : fs::directory_iterator("/sys/bus/usb/devices", none)) {
    const std::string vendor = firstLine(entry.path() / "idVendor"),
                      product = firstLine(entry.path() / "idProduct");
    for (const UsbVendor& known : vendors) {
      if (vendor != known.vendor || (!known.product.empty() && product != known.product)) continue;
      const fs::path node = nodeOf(entry.path());
      const std::string found =
          fmt::format("{} ({}:{}) at {}", known.name, vendor, product, node.string());
      if (access(node.c_str(), R_OK | W_OK) == 0)
        findings.push_back({Verdict::good, "device", found});
      else
        findings.push_back(
            {Verdict::bad, "device", found + fmt::format(", {}", errnoText()),
             fmt::format("a udev rule: SUBSYSTEM==\"usb\", ATTR{{idVendor}}==\"{}\", "
                         "MODE=\"0660\", GROUP=\"plugdev\"; never run as root for it",
                         vendor)});
    }
  }
}

Finding haplyService() {
  constexpr std::uint16_t port = 10001;
  const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const sockaddr_in address{AF_INET, htons(port), {htonl(INADDR_LOOPBACK)}, {}};
  const bool answers = socket >= 0 && connect(socket, reinterpret_cast<const sockaddr*>(&address),
                                              sizeof address) == 0;
  if (socket >= 0) close(socket);
  return {Verdict::good, "Haply service",
          answers
              ? fmt::format("answers on port {} (--device haply)", port)
              : fmt::format("nothing listens on port {}: start Haply's Inverse service to use one",
                            port)};
}

/// Libraries that plug-ins for devices stand on. Loaded to see whether that works, and dropped
/// again.
void findLibraries(std::vector<Finding>& findings) {
  constexpr std::array<std::pair<const char*, const char*>, 3> libraries = {
      {{"libHD.so", "OpenHaptics"}, {"libdhd.so", "Force Dimension"}, {"libchai3d.so", "CHAI3D"}}};
  for (const auto& [file, vendor] : libraries) {
    void* const handle = dlopen(file, RTLD_LAZY | RTLD_LOCAL);
    findings.push_back({Verdict::good, vendor,
                        handle != nullptr
                            ? fmt::format("{} can be loaded", file)
                            : fmt::format("no {}; only a plug-in for it needs it", file)});
    if (handle != nullptr) dlclose(handle);
  }
}

/// What a program that is installed beside this one prints; nothing when it fails.
std::optional<std::string> outputOf(std::string program, std::string argument) {
  std::array<int, 2> pipe{};
  if (pipe2(pipe.data(), O_CLOEXEC) != 0) return std::nullopt;
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, pipe[1], STDOUT_FILENO);
  const std::array<char*, 3> arguments = {program.data(), argument.data(), nullptr};
  pid_t child = 0;
  const bool started =
      posix_spawn(&child, program.c_str(), &actions, nullptr, arguments.data(), environ) == 0;
  posix_spawn_file_actions_destroy(&actions);
  close(pipe[1]);
  std::string output;
  std::array<char, 256> part{};
  for (ssize_t size = 0; started && (size = read(pipe[0], part.data(), part.size())) > 0;)
    output.append(part.data(), static_cast<std::size_t>(size));
  close(pipe[0]);
  int status = 0;
  if (!started || waitpid(child, &status, 0) != child || status != 0) return std::nullopt;
  return output;
}

/// Asked of the worker: a client has no OpenBLAS.
Finding solverKernels() {
  constexpr const char* topic = "solver kernels";
  std::string worker;
  try {
    worker = programBeside("palpate-worker").string();
  } catch (const Error& error) {
    return {Verdict::note, topic, error.what(), "only a machine that solves needs it"};
  }
  const auto lines = outputOf(worker, "kernels");
  if (!lines)
    return {Verdict::bad, topic, fmt::format("{} kernels failed", worker), "run it to see why"};
  const std::size_t end = lines->find('\n');
  std::string advice = lines->substr(std::min(end + 1, lines->size()));
  if (!advice.empty()) advice.pop_back();
  return {advice.empty() ? Verdict::good : Verdict::note, topic, lines->substr(0, end), advice};
}

const char* word(Verdict verdict) {
  constexpr std::array<const char*, 3> words = {"ok", "note", "BAD"};
  return words[static_cast<std::size_t>(verdict)];
}

std::function<ExitCode()> prepareDoctor(CLI::App& app) {
  auto json = std::make_shared<bool>(false);
  app.add_flag("--json", *json, "One JSON object per finding and line");
  app.footer("Changes nothing and opens no device. Exit 0, or 1 when something will not work.");
  return [json] {
    const std::vector<Finding> findings = examineMachine();
    std::cout << (*json ? describeJson(findings) : describe(findings));
    const bool bad = std::ranges::count(findings, Verdict::bad, &Finding::verdict) > 0;
    return bad ? ExitCode::failed : ExitCode::done;
  };
}

}  // namespace

std::vector<Finding> examineMachine() {
  std::vector<Finding> findings = {kernel(),       timer(),          realTimePriority(),
                                   lockedMemory(), processorClock(), display(),
                                   haplyService(), solverKernels()};
  findUsbDevices(findings);
  findLibraries(findings);
  return findings;
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

Verb doctorVerb() {
  return {"doctor", "Whether this machine can run the haptic client, and what to change",
          prepareDoctor};
}

}  // namespace palpate
