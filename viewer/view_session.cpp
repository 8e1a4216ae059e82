#include "viewer/view_session.hpp"

#include <spdlog/spdlog.h>
#include <sys/stat.h>
#include <unistd.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <ostream>
#include <thread>

#include "common/base/replaced_file.hpp"
#include "common/dataset/dataset.hpp"
#include "viewer/devices/device_choice.hpp"
#include "viewer/devices/mouse_device.hpp"
#include "viewer/devices/replay_device.hpp"
#include "viewer/haptics/haptic_loop.hpp"
#include "viewer/haptics/recording.hpp"
#include "viewer/picture/picture.hpp"

namespace palpate {
namespace {

constexpr double frames_per_second = 60, video_frames_per_second = 30;
constexpr auto headless_pause = std::chrono::milliseconds(20);
constexpr auto look_every = std::chrono::milliseconds(500);  // at files, troubles and statistics

/// Which bytes a path names: another after the file was replaced or rewritten. All zero: there is
/// none.
struct FileIdentity {
  explicit FileIdentity(const std::filesystem::path& file) {
    struct stat found {};
    if (stat(file.c_str(), &found) != 0) return;
    values = {static_cast<std::int64_t>(found.st_ino), found.st_size, found.st_mtim.tv_sec,
              found.st_mtim.tv_nsec};
  }
  std::array<std::int64_t, 4> values = {};
  bool operator==(const FileIdentity&) const = default;
};

/// The datasets of a run as the loop needs them.
struct LoadedModels {
  explicit LoadedModels(const ViewOptions& options) {
    HapticModelOptions model_options;
    model_options.reach = options.reach;
    std::erase(model_options.methods, options.method);
    model_options.methods.insert(model_options.methods.begin(), options.method);
    for (const std::filesystem::path& file : options.datasets) {
      identities.emplace_back(file);
      const Dataset dataset(file);
      models.push_back(std::make_unique<HapticModel>(dataset, model_options));
      if (!device && dataset.scene().device) device = dataset.scene().device->profile;
    }
  }
  std::vector<const HapticModel*> pointers() const {
    std::vector<const HapticModel*> all;
    for (const auto& model : models) all.push_back(model.get());
    return all;
  }
  std::vector<std::unique_ptr<HapticModel>> models;
  std::vector<FileIdentity> identities;
  std::optional<DeviceProfile> device;  ///< of the first scene that names one
};

DeviceProfile profileNamed(std::string_view word) {
  const auto all = deviceProfiles();
  return *std::find_if(all.begin(), all.end(),
                       [&](const DeviceProfile& p) { return p.name == word; });
}

/// The limits that a virtual device has.
DeviceProfile wantedProfile(const ViewOptions& options, const LoadedModels& loaded) {
  if (!options.profile.empty()) return profileNamed(options.profile);
  return loaded.device.value_or(profileNamed("touch"));
}

/// Those of the device, and no more than what was asked for.
DeviceProfile limitsOf(const HapticDevice& device, const ViewOptions& options) {
  DeviceProfile limits = device.profile();
  if (options.profile.empty()) return limits;
  const DeviceProfile asked = profileNamed(options.profile);
  limits.max_force = std::min(limits.max_force, asked.max_force);
  limits.max_stiffness = std::min(limits.max_stiffness, asked.max_stiffness);
  return limits;
}

/// N/m, the largest of all spaces at rest.
double largestStiffness(const HapticModel& model) {
  double largest = 0;
  for (std::size_t space = 0; space < model.spaces().size(); ++space) {
    const Eigen::Matrix3d stiffness =
        model.field(0, space).evaluate(Eigen::Vector3d::Zero()).stiffness;
    const Eigen::Matrix3d symmetric = -0.5 * (stiffness + stiffness.transpose());
    largest = std::max(largest,
                       Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(symmetric).eigenvalues()[2]);
  }
  return largest;
}

}  // namespace

struct ViewSession::Parts {
  explicit Parts(const ViewOptions& wanted) : options(wanted) {
    if (!options.record.empty()) refuseUnwritable(options.record, "--record");
    if (!options.screenshot.empty()) refuseUnwritable(options.screenshot, "--screenshot");
    loaded = std::make_unique<LoadedModels>(options);
    if (!options.headless) openPicture();
    if (!options.video.empty()) video.emplace(options.video);
    device = openDevice(options.device, {loaded->models.front().get(), 1 / options.rate,
                                         wantedProfile(options, *loaded)});
    mouse = dynamic_cast<MouseDevice*>(device.get());
    replay = dynamic_cast<ReplayDevice*>(device.get());
    makeTick();
    if (!options.record.empty())
      recorder.emplace(describeRun(loaded->pointers(), *device, tick->options()));
    ticks = static_cast<std::uint64_t>(std::llround(options.duration * options.rate));
    if (replay != nullptr && ticks == 0) ticks = replay->recording().size();
  }

  void openPicture() {
    PictureOptions picture_options;
    picture_options.visible = options.video.empty() || !options.fast;
    picture = std::make_unique<Picture>(loaded->pointers(), picture_options);
  }
  void makeTick();
  void announce() const;
  bool stepped() const { return options.fast && picture; }
  bool over() const { return interrupted() || (picture && picture->wantsClose()) || quit; }

  void runStepped();
  void runLoop();
  void startLoop();
  void endLoop();
  void drainRecording();
  PictureRequests drawFrame(const HapticState& state);
  void obey(const PictureRequests& requests);
  void look();
  void reload();
  void saveRecording() const;
  void finish(std::ostream& output);

  ViewOptions options;
  std::unique_ptr<LoadedModels> loaded;
  std::unique_ptr<Picture> picture;
  std::optional<VideoFrames> video;
  std::unique_ptr<HapticDevice> device;
  MouseDevice* mouse = nullptr;    ///< the device, if it is one
  ReplayDevice* replay = nullptr;  ///< the device, if it is one
  std::unique_ptr<HapticTick> tick;
  std::optional<Recorder> recorder;
  std::unique_ptr<HapticLoop> loop;  ///< none while paused, and when stepped
  LoopStatistics statistics;         ///< of the loops that ended; of the ticks when stepped
  std::uint64_t ticks = 0;           ///< to make; 0: no end
  PictureStatus status;
  std::string said;  ///< the trouble that was logged last
  std::chrono::steady_clock::time_point looked;
  bool quit = false;
};

void ViewSession::Parts::makeTick() {
  const HapticModel& model = *loaded->models.front();
  TickOptions tick_options;
  tick_options.period = 1 / options.rate;
  tick_options.contact.mode = options.contact.value_or(model.contactMode());
  tick_options.contact.friction = options.friction;
  tick_options.guard = guardFor(limitsOf(*device, options), tick_options.period);
  tick_options.map = workspaceFor(model, *device);
  tick_options.guard.max_stiffness /= tick_options.map.scale;  // per metre of the scene
  tick = std::make_unique<HapticTick>(loaded->pointers(), *device, tick_options);
}

void ViewSession::Parts::announce() const {
  const HapticModel& model = *loaded->models.front();
  const TickOptions& used = tick->options();
  std::int32_t touchable = 0;
  const auto triangles = static_cast<std::int32_t>(model.surface().triangles().size());
  for (std::int32_t t = 0; t < triangles; ++t) touchable += model.surface().touchable(t) ? 1 : 0;
  spdlog::info(
      "{}: {} active node(s), {} of {} surface triangles can be touched, method {}, contact {}",
      model.file(), model.spaces().size(), touchable, triangles, options.method,
      word(used.contact.mode));
  spdlog::info("{} at {:g} Hz: at most {:g} N and {:g} N/s, workspace scale {:.3g}", device->name(),
               options.rate, used.guard.max_force, used.guard.max_slew, used.map.scale);
  const double felt = used.map.scale * largestStiffness(model);
  const double rendered = limitsOf(*device, options).max_stiffness;
  if (felt > rendered)
    spdlog::warn(
        "the tissue at rest is felt with {:.0f} N/m, of which the device renders {:.0f} stably: "
        "it may buzz; a smaller scale or a device profile of its own helps",
        felt, rendered);
}

/// Ticks and pictures in turn, by the time of the ticks alone: the same pictures on every machine.
void ViewSession::Parts::runStepped() {
  const auto ticks_per_frame = std::max<std::uint64_t>(
      1, static_cast<std::uint64_t>(options.rate / video_frames_per_second));
  statistics.rate = options.rate;
  for (std::uint64_t done = 0; done < ticks && !over();) {
    const std::uint64_t goal = std::min(ticks, done + ticks_per_frame);
    for (; done < goal; ++done) {
      const HapticState before = tick->state();
      count(statistics, before, tick->run());
      if (recorder) recorder->add(tick->state());
    }
    obey(drawFrame(tick->state()));
  }
  device->write(Eigen::Vector3d::Zero());
}

void ViewSession::Parts::startLoop() {
  LoopOptions loop_options;
  loop_options.rate = options.rate;
  loop_options.real_time = options.real_time;
  loop_options.free_running = options.fast;
  loop_options.ticks = ticks == 0 ? 0 : std::max<std::uint64_t>(1, ticks - statistics.ticks);
  loop_options.record = recorder.has_value();
  loop = std::make_unique<HapticLoop>(*tick, *device, loop_options);
  loop->start();
}

void ViewSession::Parts::drainRecording() {
  if (!recorder || !loop) return;
  while (const std::optional<HapticState> state = loop->takeRecorded()) recorder->add(*state);
}

void ViewSession::Parts::runLoop() {
  startLoop();
  auto next = std::chrono::steady_clock::now();
  while (!over() && (!loop || loop->running())) {
    drainRecording();
    look();
    if (!picture) {
      std::this_thread::sleep_for(headless_pause);
      continue;
    }
    obey(drawFrame(loop ? loop->latest() : tick->state()));
    next = std::max(next + std::chrono::microseconds(static_cast<int>(1e6 / frames_per_second)),
                    std::chrono::steady_clock::now());
    std::this_thread::sleep_until(next);
  }
  endLoop();
}

void ViewSession::Parts::endLoop() {
  if (!loop) return;
  loop->stop();
  drainRecording();
  add(statistics, loop->statistics());
  loop.reset();
}

/// What changes slowly: files on disk, troubles, statistics.
void ViewSession::Parts::look() {
  const auto now = std::chrono::steady_clock::now();
  if (now - looked < look_every) return;
  looked = now;
  status.trouble = device->trouble();
  if (loop && !loop->trouble().empty())
    status.trouble += (status.trouble.empty() ? "" : "\n") + loop->trouble();
  if (status.trouble != said && !status.trouble.empty()) spdlog::warn("{}", status.trouble);
  said = status.trouble;
  if (loop) status.loop = figuresOf(loop->statistics());
  for (std::size_t m = 0; m < loaded->models.size(); ++m)
    if (status.notice.empty() && FileIdentity(options.datasets[m]) != loaded->identities[m]) {
      status.notice =
          fmt::format("{} was replaced; what is felt is the old one until it is read again",
                      options.datasets[m].string());
      spdlog::warn("{}", status.notice);
    }
}

PictureRequests ViewSession::Parts::drawFrame(const HapticState& state) {
  status.device = device->name();
  status.max_force = tick->options().guard.max_force;
  status.paused = !loop && !stepped();
  status.recording = recorder.has_value();
  PictureRequests requests = picture->draw(state, status);
  if (video) video->add(picture->grab());
  return requests;
}

void ViewSession::Parts::obey(const PictureRequests& requests) {
  const auto command = [&](const HapticCommand& what) {
    if (loop)
      loop->command(what);
    else
      tick->obey(what);
  };
  if (requests.use) command({HapticCommand::Kind::use, requests.use->model, requests.use->method});
  if (requests.release) command({HapticCommand::Kind::release});
  if (mouse != nullptr && requests.mouse_target) mouse->moveTo(*requests.mouse_target, 0);
  if (requests.pause && !stepped()) {
    if (loop)
      endLoop();
    else
      startLoop();
  }
  if (requests.reload) reload();
  quit = quit || requests.quit;
}

/// Reads the files again. When that fails, everything stays as it is.
void ViewSession::Parts::reload() {
  if (recorder) {
    status.notice = "not while a recording runs: it belongs to the datasets that it began with";
    return;
  }
  std::unique_ptr<LoadedModels> fresh;
  try {
    fresh = std::make_unique<LoadedModels>(options);
  } catch (const std::exception& error) {
    status.notice = fmt::format("not read again: {}", error.what());
    spdlog::warn("{}", status.notice);
    return;
  }
  const bool ran = loop != nullptr;
  endLoop();
  tick.reset();
  picture.reset();
  loaded = std::move(fresh);
  openPicture();
  makeTick();
  status.notice.clear();
  if (ran) startLoop();
}

/// A recording that cannot be written where it should be is kept somewhere else, if there is any
/// room.
void ViewSession::Parts::saveRecording() const {
  if (!recorder) return;
  try {
    recorder->save(options.record);
  } catch (const Error& error) {
    const std::filesystem::path elsewhere =
        std::filesystem::temp_directory_path() / fmt::format("palpate-run-{}.h5", getpid());
    recorder->save(elsewhere);
    throw failure("{}; the recording was written to {} instead", error.what(), elsewhere.string());
  }
  spdlog::info("{}: {} ticks{}", options.record.string(), recorder->size(),
               recorder->recording().complete() ? "" : ", with gaps");
}

void ViewSession::Parts::finish(std::ostream& output) {
  saveRecording();
  if (!options.screenshot.empty()) {
    drawFrame(tick->state());
    writePng(picture->grab(), options.screenshot);
  }
  if (video) spdlog::info("{}: {} pictures", options.video.string(), video->count());
  output << (options.json ? describeJson(statistics) + "\n" : describe(statistics)) << std::flush;
  if (!output) throw failure("cannot write the measurements to standard output");
}

ViewSession::ViewSession(const ViewOptions& options) : parts_(std::make_unique<Parts>(options)) {}

ViewSession::~ViewSession() = default;

ExitCode ViewSession::run(std::ostream& output) {
  catchInterrupts();
  std::signal(SIGPIPE,
              SIG_IGN);  // a reader of our output that goes must not end us with a force on
  parts_->announce();
  try {
    parts_->stepped() ? parts_->runStepped() : parts_->runLoop();
  } catch (...) {
    parts_->endLoop();
    parts_->saveRecording();
    throw;
  }
  parts_->finish(output);
  return interrupted() ? ExitCode::interrupted : ExitCode::done;
}

}  // namespace palpate
