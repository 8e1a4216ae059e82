#include "viewer/devices/plugin_device.hpp"

#include <dlfcn.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <future>

#include "common/base/error.hpp"
#include "viewer/devices/palpate_device.h"

namespace palpate {
namespace {

using namespace std::chrono_literals;
using Clock = DeviceExchange::Clock;

constexpr auto end_limit = 2s;
constexpr const char* entry_point = "palpate_device_plugin_v1";
/// Largest number of devices that are listed, in case a plug-in never ends the enumeration.
constexpr std::uint32_t most_devices = 64;

std::string sentenceOf(const char* text) {
  return text == nullptr || *text == '\0' ? "no reason was given" : text;
}

/// A plug-in that has been loaded and checked.
class Plugin {
 public:
  explicit Plugin(const std::filesystem::path& file) {
    // Use an absolute path, because dlopen() would search the system's directories for a name
    // without a slash.
    const std::string path = std::filesystem::absolute(file).string();
    library_.reset(dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL));
    if (!library_)
      throw badInput("device plug-in {} cannot be loaded: {}", file.string(),
                     sentenceOf(dlerror()));
    void* const symbol = dlsym(library_.get(), entry_point);
    if (symbol == nullptr)
      throw badInput("{} is not a device plug-in of this version: {}", file.string(),
                     sentenceOf(dlerror()));
    table_ = reinterpret_cast<palpate_device_plugin_function>(symbol)();
    check(file.string());
  }
  const palpate_device_plugin* operator->() const { return table_; }

 private:
  struct Unload {
    void operator()(void* library) const { dlclose(library); }
  };

  void check(const std::string& file) const {
    if (table_ == nullptr)
      throw badInput("device plug-in {}: {}() returned NULL", file, entry_point);
    if (table_->abi != PALPATE_DEVICE_ABI)
      throw badInput(
          "device plug-in {} is built for version {} of palpate_device.h, but this program uses "
          "version {}; rebuild the plug-in with its header",
          file, table_->abi, PALPATE_DEVICE_ABI);
    if (table_->size < sizeof(palpate_device_plugin))
      throw badInput(
          "device plug-in {}: its table has {} bytes, but version {} needs {}; rebuild the plug-in",
          file, table_->size, PALPATE_DEVICE_ABI, sizeof(palpate_device_plugin));
    if (table_->name == nullptr || table_->enumerate == nullptr || table_->open == nullptr ||
        table_->limits == nullptr || table_->read == nullptr || table_->write == nullptr ||
        table_->halt == nullptr || table_->last_error == nullptr || table_->close == nullptr)
      throw badInput("device plug-in {}: its table has a null entry; version {} needs all entries",
                     file, PALPATE_DEVICE_ABI);
  }

  std::unique_ptr<void, Unload> library_;
  const palpate_device_plugin* table_ = nullptr;
};

/// Returns the ids of the devices that a plug-in finds, as text.
std::string idsOf(const Plugin& plugin) {
  std::string ids;
  std::array<char, 256> id{};
  for (std::uint32_t i = 0;
       i < most_devices && plugin->enumerate(i, id.data(), id.size()) == PALPATE_DEVICE_OK; ++i) {
    id.back() = '\0';
    ids += fmt::format("{}{}", i > 0 ? ", " : "", id.data());
  }
  return ids.empty() ? "none" : ids;
}

}  // namespace

/// An open device and its thread.
class PluginDevice::Session {
 public:
  Session(const PluginDeviceOptions& options, std::shared_ptr<DeviceExchange> exchange)
      : file(options.library.string()), exchange_(std::move(exchange)), plugin_(options.library) {
    std::array<char, 512> reason{};
    device_.reset(
        plugin_->open(options.id.c_str(), options.options.c_str(), reason.data(), reason.size()));
    if (!device_)
      throw failure("device plug-in {} cannot open {}: {}; devices found: {}", file,
                    options.id.empty() ? "its first device" : "device \"" + options.id + "\"",
                    sentenceOf(reason.data()), idsOf(plugin_));
    takeLimits();
    name = options.id.empty() ? plugin_->name : std::string(plugin_->name) + " " + options.id;
  }

  /// Runs the device until stop(); body of the device's thread.
  void run(Clock::duration period) {
    for (auto next = Clock::now(); !stopping_;) {
      turn();
      next = std::max(next + period, Clock::now());
      std::this_thread::sleep_until(next);
    }
    constexpr std::array<double, 3> zero{};
    plugin_->write(device_.get(), zero.data());
    ended_.set_value();
  }
  /// Ends the thread. Returns false if the plug-in hangs. Call once.
  bool stop() {
    stopping_ = true;
    return ended_.get_future().wait_for(end_limit) == std::future_status::ready;
  }
  void halt() noexcept {
    // Halt the exchange first. If the thread still runs, it then writes only zero.
    exchange_->halt();
    plugin_halted_ = true;
    plugin_->halt(device_.get(), 1);
  }

  std::string file, name;
  DeviceTraits traits;

 private:
  void takeLimits() {
    palpate_device_limits limits{};
    limits.size = sizeof limits;
    if (plugin_->limits(device_.get(), &limits) != PALPATE_DEVICE_OK)
      throw failure("device plug-in {} cannot report the limits of the device: {}", file,
                    sentenceOf(plugin_->last_error(device_.get())));
    for (const double limit : {limits.max_force, limits.max_stiffness, limits.workspace_radius})
      if (!std::isfinite(limit) || limit <= 0)
        throw failure("device plug-in {}: limits must be positive; they are {} N, {} N/m and {} m",
                      file, limits.max_force, limits.max_stiffness, limits.workspace_radius);
    traits = {{"plugin", limits.max_force, limits.max_stiffness, limits.workspace_radius},
              limits.lives_in_scene != 0,
              limits.has_buttons != 0};
  }

  void turn() {
    palpate_device_state state{};
    state.size = sizeof state;
    const std::int32_t read = plugin_->read(device_.get(), &state);
    if (read == PALPATE_DEVICE_OK)
      exchange_->deliver(
          {Eigen::Map<const Eigen::Vector3d>(state.position), state.buttons, DeviceStatus::fresh});
    else if (read == PALPATE_DEVICE_LOST)
      exchange_->deliver({Eigen::Vector3d::Zero(), 0, DeviceStatus::lost});
    const Eigen::Vector3d force = exchange_->force();
    const std::int32_t written = plugin_->write(device_.get(), force.data());
    if (written == PALPATE_DEVICE_OK) resume();
    tell(read != PALPATE_DEVICE_OK || written != PALPATE_DEVICE_OK);
  }

  /// Call only after a write: until then, the plug-in has the force from before the halt.
  void resume() noexcept {
    if (!plugin_halted_ || exchange_->halted()) return;
    plugin_halted_ = false;
    plugin_->halt(device_.get(), 0);
    if (exchange_->halted()) halt();  // halted again in the meantime
  }

  void tell(bool failed) {
    if (!failed && !failed_) return;
    failed_ = failed;
    exchange_->setTrouble(
        failed ? fmt::format("{}: {}", name, sentenceOf(plugin_->last_error(device_.get()))) : "");
  }

  const std::shared_ptr<DeviceExchange> exchange_;
  Plugin plugin_;
  std::unique_ptr<palpate_device, void (*)(palpate_device*)> device_{nullptr, plugin_->close};
  bool failed_ = false;
  std::atomic<bool> plugin_halted_ = false;
  std::atomic<bool> stopping_ = false;
  std::promise<void> ended_;  ///< set at the end of the thread
};

PluginDevice::PluginDevice(const PluginDeviceOptions& options)
    : session_(std::make_shared<Session>(options, exchange_)) {
  if (!(options.period > 0) || !(options.period <= 1))
    throw badInput("a plug-in cannot be read every {} s; give a period of at most 1 s",
                   options.period);
  traits_ = session_->traits;
  const auto period =
      std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(options.period));
  thread_ = std::thread([session = session_, period] { session->run(period); });
}

PluginDevice::~PluginDevice() {
  // A plug-in that hangs must not block the end of the program.
  if (session_->stop()) {
    thread_.join();
    return;
  }
  // The thread hangs in the plug-in. It shares ownership of the session, so the library stays
  // loaded.
  session_->halt();
  thread_.detach();
}

void PluginDevice::halt() noexcept { session_->halt(); }
std::string PluginDevice::name() const { return session_->name; }

}  // namespace palpate
