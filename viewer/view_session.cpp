#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <ostream>
#include <thread>
#include <utility>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "common/base/index.hpp"
#include "common/base/number_text.hpp"
#include "common/base/whole_file.hpp"
#include "common/problem/problem.hpp"
#include "viewer/devices/device_choice.hpp"
#include "viewer/growing_dataset.hpp"
#include "viewer/haptics/haptic_loop.hpp"
#include "viewer/haptics/recording.hpp"
#include "viewer/live/live_link.hpp"
#include "viewer/live/unsolved_dataset.hpp"
#include "viewer/picture/picture.hpp"
#include "viewer/view_command.hpp"

namespace palpate {
namespace {

constexpr double frames_per_second = 60, video_frames_per_second = 30;
constexpr std::chrono::seconds live_patience{10};
constexpr auto headless_pause = std::chrono::milliseconds(20);
constexpr std::chrono::seconds notice_time{5};               // of a notice about a key
constexpr auto look_every = std::chrono::milliseconds(500);  // interval for checking files,
                                                             // problems and statistics

DeviceProfile profileNamed(std::string_view word) {
  const DeviceProfile* const known = deviceNamed(word);
  PALPATE_ASSERT(known != nullptr, "the device profile must be a known one");
  return *known;
}

/// One run of the haptic client with its datasets, device, haptic loop, window and recording. The
/// thread that constructs the session also draws.
class ViewSession {
 public:
  /// Loads the datasets, then opens the window and the device. Throws their errors.
  explicit ViewSession(const ViewOptions& options) : options_(resolved(options)) {
    if (!options_.record.empty()) refuseUnwritable(options_.record, "--record");
    refuseInput(options_.record, "--record", options_.datasets);
    refuseInput(options_.record, "--record", {&options_.hold, 1});
    if (!options_.screenshot.empty()) refuseUnwritable(options_.screenshot, "--screenshot");
    if (!options_.build.empty()) refuseUnwritable(options_.build, "--build");
    if (!options_.video.empty()) video_.emplace(options_.video);
    // Open the device last, so that no earlier error can leave it with a force.
    loaded_ = std::make_unique<LoadedModels>(options_.datasets, modelOptions());
    if (!options_.hold.empty()) readHolds();
    if (!options_.headless) openPicture();
    // The live solver finds the state at rest while the forces are prepared.
    if (!options_.live.empty()) startLive();
    prepareFirst();
    if (quit_) return;
    if (link_ && !link_->waitUntilReady(live_patience))
      spdlog::warn("live solving has not started yet{}{}", link_->trouble().empty() ? "" : ": ",
                   link_->trouble());
    if (!options_.build.empty())
      growing_.emplace(scene_, options_.build, options_.datasets, modelOptions());
    device_ = openDevice(options_.device, {&loaded_->first(), 1 / options_.rate, wantedProfile(),
                                           options_.keys, options_.hand_speed, options_.real_time});
    makeTick();
    if (!options_.record.empty()) {
      RecordedRun run = describeRun(loaded_->pointers(), *device_, tick_->options());
      if (live_) run.models.front().build = build_id_;
      recorder_.emplace(std::move(run));
    }
    ticks_ = std::llround(options_.duration * options_.rate);
    // A replay ends together with its recording.
    if (ticks_ == 0) ticks_ = device_->readings();
  }

  /// Runs until the window is closed, the duration is over, a replay has ended, or a signal
  /// arrives. Then sets zero force, saves the recording and the picture, and prints the statistics
  /// of the loop to `output`.
  ExitCode run(std::ostream& output) {
    if (quit_) {
      spdlog::info("stopped during preparation; nothing was recorded");
      return ExitCode::done;
    }
    PALPATE_ASSERT(device_ && tick_, "a running session must have a device");
    catchInterrupts();
    // Ignore the signal of a broken output pipe, which must not end the program while a force is
    // applied.
    std::signal(SIGPIPE, SIG_IGN);
    announce();
    try {
      stepped() ? runStepped() : runLoop();
    } catch (...) {
      endLoop();
      saveRecording();
      throw;
    }
    finish(output);
    return interrupted() ? ExitCode::interrupted : ExitCode::done;
  }

 private:
  /// If a scene is given instead of a dataset, replaces it by a dataset without solutions. The
  /// scene is then solved near the hand.
  ViewOptions resolved(ViewOptions options) {
    std::filesystem::path& first = options.datasets.front();
    if (first.extension() != ".toml") return options;
    if (!options.live.empty())
      throw badInput("--live {}: omit it, because {} is a scene, which is solved live anyway",
                     options.live.string(), first.string());
    followed_ = loadProblem(first);
    scene_ = first;
    unsolved_.emplace(*followed_);
    options.live = std::exchange(first, unsolved_->file());
    return options;
  }

  /// Returns true if ticks and frames alternate without a clock. The user cannot interact then.
  bool stepped() const { return options_.fast && !options_.headless; }
  bool over() const { return interrupted() || (picture_ && picture_->wantsClose()) || quit_; }

  HapticModelOptions modelOptions() const {
    HapticModelOptions model_options;
    model_options.reach = options_.reach;
    std::erase(model_options.methods, options_.method);
    // Skip methods between which the user cannot choose, because they take seconds and memory.
    const bool steered = !options_.headless && !stepped();
    if (!steered) model_options.methods.clear();
    model_options.methods.insert(model_options.methods.begin(), options_.method);
    model_options.pressures = steered;
    model_options.guess = unsolved_.has_value();
    return model_options;
  }

  void openPicture() {
    const PictureOptions picture_options = {.visible = options_.video.empty() || !options_.fast};
    picture_ = std::make_unique<Picture>(loaded_->pointers(), picture_options);
  }

  /// Prepares the forces while the window shows the body at rest.
  void prepareFirst() {
    HapticState nobody;
    nobody.reading.status = DeviceStatus::away;
    const auto seen = [&](const HapticModel& model, double share) {
      // In a run without a clock, draw nothing here, because the frames must be the same in every
      // run.
      if (!picture_ || options_.fast) return true;
      const PictureStatus waiting = {
          .notice = fmt::format("preparing the forces of {}: {:.0f} %", model.name(), 100 * share)};
      return !picture_->draw(nobody, waiting).quit && !picture_->wantsClose();
    };
    quit_ = !loaded_->prepareFirst(seen);
  }

  /// Returns the limits that the options or the scene ask for, and otherwise those of the profile
  /// "touch".
  DeviceProfile wantedProfile() const {
    if (!options_.profile.empty()) return profileNamed(options_.profile);
    return loaded_->device().value_or(profileNamed("touch"));
  }

  /// Returns the limits of the device. If the options or the scene name a profile, no limit is
  /// larger than that of the profile.
  DeviceProfile limits() const {
    const bool asked = !options_.profile.empty() || loaded_->device();
    return asked ? smallerOf(device_->profile(), wantedProfile()) : device_->profile();
  }

  /// Starts live solving near the hand. Throws the errors of followedRadius().
  void startLive() {
    const HapticModel& model = loaded_->first();
    if (!unsolved_) followed_ = loadProblem(options_.live);
    build_id_ = problemId(*followed_);
    live_build_ = unsolved_ ? model.buildId() : build_id_;
    live_.emplace(followedRadius(model, live_build_), hasFibers(model));
    LiveLinkOptions link_options = {encodeProblem(*followed_), options_.follower};
    if (!options_.follower.empty()) link_options.keys = options_.keys.keys();
    followed_.reset();
    link_.emplace(*live_, std::move(link_options));
  }

  void readHolds() {
    const Recording recording = readRecording(options_.hold);
    checkReplay(recording, 1 / options_.rate, options_.hold.string());
    holds_ = holdsOf(recording, loaded_->first().surface(), options_.hold.string());
  }

  void makeTick() {
    const HapticModel& model = loaded_->first();
    TickOptions tick_options;
    tick_options.period = 1 / options_.rate;
    tick_options.holds = holds_;
    tick_options.contact.mode = options_.contact.value_or(model.contactMode());
    tick_options.contact.friction = options_.friction;
    if (live_ && model.buildId() == live_build_) {
      tick_options.contact.live = &*live_;
      tick_options.contact.live_model = &model;
    }
    tick_options.guard = guardFor(limits(), tick_options.period);
    tick_options.map = workspaceFor(model, *device_, limits());
    tick_options.guard.max_stiffness /= tick_options.map.scale;  // per metre of the scene
    tick_ = std::make_unique<HapticTick>(loaded_->pointers(), *device_, tick_options);
  }

  void announce() const {
    const HapticModel& model = loaded_->first();
    const TickOptions& used = tick_->options();
    int touchable = 0;
    const std::size_t triangles = model.surface().triangles().size();
    for (std::size_t t = 0; t < triangles; ++t) touchable += model.surface().touchable(t);
    spdlog::info("{}: {}, {} of {} surface triangles are touchable, method {}, contact {}",
                 model.file(), counted(model.spaces().size(), "active node"), touchable, triangles,
                 options_.method, word(used.contact.mode));
    spdlog::info("{} at {:g} Hz: at most {:g} N and {:g} N/s, workspace scale {:.3g}",
                 device_->name(), options_.rate, used.guard.max_force, used.guard.max_slew,
                 used.map.scale);
    if (const std::string doubts = doubtsOf(device_->profile()); !doubts.empty())
      spdlog::warn("{}: {}", device_->name(), doubts);
  }

  /// Alternates ticks and frames in haptic time, so that the frames are the same on every machine.
  void runStepped() {
    const auto ticks_per_frame =
        std::max<std::uint64_t>(1, options_.rate / video_frames_per_second);
    statistics_.rate = options_.rate;
    for (std::uint64_t done = 0; done < ticks_ && !over();) {
      const std::uint64_t goal = std::min(ticks_, done + ticks_per_frame);
      for (; done < goal; ++done) {
        const HapticState before = tick_->state();
        count(statistics_, before, tick_->run());
        if (recorder_) recorder_->add(tick_->state());
      }
      obey(drawFrame(tick_->state()));
    }
    device_->write(Eigen::Vector3d::Zero());
  }

  void startLoop() {
    PALPATE_ASSERT(!loop_, "the haptic loop must not run already");
    const LoopOptions loop_options = {
        .rate = options_.rate,
        .real_time = options_.real_time,
        .free_running = options_.fast,
        .ticks = ticks_ == 0 ? 0 : std::max<std::uint64_t>(1, ticks_ - statistics_.ticks),
        .record = recorder_.has_value()};
    loop_ = std::make_unique<HapticLoop>(*tick_, *device_, loop_options);
    loop_->start();
  }

  const HapticState& latest() { return loop_ ? loop_->latest() : tick_->state(); }

  void drainRecording() {
    if (!recorder_ || !loop_) return;
    while (const std::optional<HapticState> state = loop_->takeRecorded()) recorder_->add(*state);
  }

  void runLoop() {
    loaded_->prepareTheRest();
    startLoop();
    auto next = std::chrono::steady_clock::now();
    while (!over() && (!loop_ || loop_->running())) {
      drainRecording();
      look();
      followReload();
      if (!picture_) {
        std::this_thread::sleep_for(headless_pause);
        continue;
      }
      obey(drawFrame(latest()));
      // After a slow frame, do not hurry to catch up.
      next = std::max(next + std::chrono::microseconds(static_cast<int>(1e6 / frames_per_second)),
                      std::chrono::steady_clock::now());
      std::this_thread::sleep_until(next);
    }
    endLoop();
  }

  void endLoop() {
    if (!loop_) return;
    loop_->stop();
    drainRecording();
    add(statistics_, loop_->statistics());
    loop_.reset();
    // The loop may have ended before it carried out the commands.
    if (retired_) replaceInTick();
  }

  /// Checks the files on disk, the problems and the statistics, all of which change slowly.
  void look() {
    const auto now = std::chrono::steady_clock::now();
    if (now - looked_ < look_every) return;
    looked_ = now;
    if (now > notice_ends_) {
      status_.notice.clear();
      notice_ends_ = std::chrono::steady_clock::time_point::max();
    }
    status_.trouble = device_->trouble();
    for (const std::string& more : {loop_ ? loop_->trouble() : "", link_ ? link_->trouble() : ""})
      if (!more.empty()) status_.trouble += (status_.trouble.empty() ? "" : "\n") + more;
    if (status_.trouble != said_ && !status_.trouble.empty()) spdlog::warn("{}", status_.trouble);
    said_ = status_.trouble;
    // A new live solver answers sooner than this function looks again.
    const std::uint64_t restarts = link_ ? link_->statistics().restarts : 0;
    if (restarts > std::exchange(restarts_, restarts) && said_.empty())
      spdlog::warn("the live solver ended or was lost; it is back");
    if (loop_) status_.loop = loop_->statistics();
    doubtPosition();
    if (retired_ && isRetiredUnused()) retired_.reset();
    if (const Touch& touch = latest().touch; growing_ && touch.touching)
      growing_->prefer(loaded_->first(), touch.anchor_position);
    // Until the complete dataset is loaded, the build itself overwrites or removes the loaded file.
    const bool grows = unsolved_ && loaded_->first().file() != options_.build;
    const std::optional<std::filesystem::path> replaced = loaded_->replaced();
    if (grows || !replaced || !status_.notice.empty()) return;
    status_.notice = fmt::format("{} was replaced; the old dataset is used until you reload",
                                 replaced->string());
    spdlog::warn("{}", status_.notice);
  }

  /// Warns if the positions of the device seem to be in millimetres. The tool would then never come
  /// near the body.
  void doubtPosition() {
    constexpr double most_radii = 10;
    if (!loop_ || doubted_ || device_->livesInScene()) return;
    const double radius = device_->profile().workspace_radius;
    const DeviceReading reading = loop_->latest().reading;
    if (reading.status != DeviceStatus::fresh || !(reading.position.norm() > most_radii * radius))
      return;
    spdlog::warn(
        "{}: the hand is {:.3g} m from the centre of a workspace of {:.3g} m: check that "
        "positions are in metres",
        device_->name(), reading.position.norm(), radius);
    doubted_ = true;
  }

  PictureRequests drawFrame(const HapticState& state) {
    PALPATE_ASSERT(picture_, "only a run with a picture can draw");
    status_.device = device_->name();
    status_.mouse = device_->isMouse();
    status_.contact = tick_->options().contact.mode;
    status_.max_force = tick_->options().guard.max_force;
    status_.paused = !loop_ && !stepped();
    status_.recording = recorder_.has_value();
    PictureRequests requests = picture_->draw(state, status_);
    if (video_) video_->add(picture_->grab());
    return requests;
  }

  void obey(const PictureRequests& requests) {
    if (requests.use)
      command({HapticCommand::Kind::use, requests.use->model, requests.use->method});
    if (requests.hold) hold();
    if (requests.release) command({HapticCommand::Kind::release});
    if (requests.tool) device_->moveTo(*requests.tool);
    if (requests.pause && !stepped()) loop_ ? endLoop() : startLoop();
    if (requests.reload) reload();
    if (stepped()) followReload();
    quit_ = quit_ || requests.quit;
  }

  /// Leaves a second finger at the touch, or lets it go. A notice says why it cannot.
  void hold() {
    const HapticState& state = latest();
    const TickOptions& used = tick_->options();
    status_.notice.clear();
    if (used.contact.live == nullptr || state.model != 0)
      status_.notice =
          "a second finger needs live solving: view SCENE.toml, or OUT.h5 --live SCENE";
    else if (!used.holds.empty())
      status_.notice = fmt::format("{} moves the second finger", options_.hold.string());
    else if (!state.touch.touching && !state.hold)
      status_.notice = "touch the body first: a second finger stays where the tool touches";
    else
      command({HapticCommand::Kind::hold});
    notice_ends_ = std::chrono::steady_clock::now() + notice_time;
  }

  /// Starts to read the files again. The old datasets stay in use until the new ones are ready.
  void reload() {
    if (recorder_)
      status_.notice = "cannot reload while recording";
    else if (!reload_)
      reload_ = std::make_unique<ModelsReload>(options_.datasets, modelOptions());
  }

  /// Switches to reloaded datasets as soon as they are ready. If the reload failed, the old ones
  /// stay in use.
  void followReload() {
    if (growing_ && !retired_)
      if (auto newer = growing_->takeNewer()) replaceModels(std::move(newer));
    if (!reload_) return;
    status_.notice =
        fmt::format("reloading: {:.0f} % of the forces are prepared", 100 * reload_->share());
    if (!reload_->ended()) return;
    const auto ended = std::move(reload_);
    std::unique_ptr<LoadedModels> fresh;
    try {
      fresh = ended->take();
    } catch (const std::exception& error) {
      status_.notice = fmt::format("reload failed: {}", error.what());
      spdlog::warn("{}", status_.notice);
      return;
    }
    change(std::move(fresh));
    status_.notice.clear();
    spdlog::info("reloaded");
  }

  /// Replaces the models by newer results, while the loop runs and the window stays open.
  void replaceModels(std::unique_ptr<LoadedModels> fresh) {
    retired_ = std::exchange(loaded_, std::move(fresh));
    options_.datasets.front() = loaded_->first().file();
    if (loaded_->first().buildId() == build_id_) live_build_ = build_id_;
    const bool sent = replaceInTick();
    retired_tick_ = loop_ ? loop_->latest().tick : 0;
    if (!sent) {  // the queue of the loop is full, because the loop hangs
      endLoop();
      startLoop();
    }
    if (picture_) picture_->replace(loaded_->pointers());
    loaded_->prepareTheRest();
    const std::size_t sites = loaded_->first().spaces().size();
    spdlog::info("{} of {} have computed forces", sites - loaded_->first().guesses(),
                 counted(sites, "site"));
  }

  /// Gives the models to the tick. Returns false if the loop does not accept the commands.
  bool replaceInTick() {
    const std::vector<const HapticModel*> models = loaded_->pointers();
    bool sent = true;
    for (std::size_t n = 0; n < models.size(); ++n)
      sent = command({.kind = HapticCommand::Kind::replace,
                      .model = static_cast<std::int32_t>(n),
                      .replacement = models[n]}) &&
             sent;
    return sent;
  }

  /// Returns whether the loop has carried out the replacement. Tick retired_tick_ + 1 may have
  /// begun before the command was sent; tick retired_tick_ + 2 begins after it.
  bool isRetiredUnused() const { return !loop_ || loop_->latest().tick >= retired_tick_ + 2; }

  /// Sends a command to the haptic thread; without a loop, no other thread uses the tick. Returns
  /// whether it was sent.
  bool command(const HapticCommand& what) {
    if (loop_) return loop_->command(what);
    tick_->obey(what);
    return true;
  }

  void change(std::unique_ptr<LoadedModels> fresh) {
    PALPATE_ASSERT(fresh, "a reload must have a result");
    const bool ran = loop_ != nullptr;
    endLoop();
    tick_.reset();
    picture_.reset();
    // Destroy the old models last, because their preparation may still run.
    const auto old = std::exchange(loaded_, std::move(fresh));
    openPicture();
    makeTick();
    if (!stepped()) loaded_->prepareTheRest();
    if (ran) startLoop();
  }

  /// Saves the recording. If its file cannot be written, saves it in the directory for temporary
  /// files.
  void saveRecording() {
    // Stop the threads that read datasets, because HDF5 serves only one thread at a time.
    reload_.reset();
    if (growing_) growing_->stopLoading();
    if (!recorder_) return;
    PALPATE_ASSERT(!loop_, "the haptic loop must have ended");
    try {
      recorder_->save(options_.record);
    } catch (const Error& error) {
      const std::filesystem::path elsewhere =
          std::filesystem::temp_directory_path() / fmt::format("palpate-run-{}.h5", getpid());
      recorder_->save(elsewhere);
      throw failure("{}; the recording was written to {} instead", error.what(),
                    elsewhere.string());
    }
    spdlog::info("{}: {}{}", options_.record.string(), counted(recorder_->size(), "tick"),
                 recorder_->complete() ? "" : ", with gaps");
  }

  static void tellLive(const LiveStatistics& live) {
    spdlog::info(
        "the live solver found {}, on average {:.1f} ms and at most {:.1f} ms after the request; "
        "it found none for {} of the hand and was restarted {}",
        counted(live.answers, "equilibrium", "equilibria"), 1e3 * live.meanSeconds(),
        1e3 * live.largest_seconds, counted(live.failures, "position"),
        counted(live.restarts, "time"));
  }

  void finish(std::ostream& output) {
    saveRecording();
    if (!options_.screenshot.empty()) {
      drawFrame(tick_->state());
      writePng(picture_->grab(), options_.screenshot);
    }
    if (link_) tellLive(link_->statistics());
    growing_.reset();
    if (video_) spdlog::info("{}: {} frames", options_.video.string(), video_->count());
    output << (options_.json ? describeJson(statistics_) + "\n" : describe(statistics_));
  }

  std::optional<Problem> followed_;          ///< problem of the scene, until the live solver has it
  std::optional<UnsolvedDataset> unsolved_;  ///< if the user gave a scene
  std::filesystem::path scene_;              ///< file of that scene
  ViewOptions options_;
  std::unique_ptr<LoadedModels> loaded_;
  /// Old models that the loop may still use, and the last tick before their replacement.
  std::unique_ptr<LoadedModels> retired_;
  std::uint64_t retired_tick_ = 0;
  std::optional<VideoFrames> video_;
  std::unique_ptr<Picture> picture_;  ///< null if headless
  std::unique_ptr<HapticDevice> device_;
  std::optional<LiveTouch> live_;  ///< with --live
  ContentId build_id_;             ///< problemId of the scene that is followed
  ContentId live_build_;           ///< build id of the model that the live solver corrects
  std::optional<LiveLink> link_;
  std::optional<GrowingDataset> growing_;   ///< with --build
  std::vector<std::optional<Hold>> holds_;  ///< with --hold, one per tick
  std::unique_ptr<HapticTick> tick_;
  std::optional<Recorder> recorder_;
  std::unique_ptr<HapticLoop> loop_;  ///< null while paused, and if stepped()
  LoopStatistics statistics_;         ///< sum over ended loops; if stepped(), over ticks
  std::uint64_t ticks_ = 0;           ///< ticks to run; 0: no limit
  PictureStatus status_;
  std::string said_;            ///< the problem that was logged last
  std::uint64_t restarts_ = 0;  ///< restarts of the live solver that were logged
  std::chrono::steady_clock::time_point looked_;
  std::chrono::steady_clock::time_point notice_ends_ = std::chrono::steady_clock::time_point::max();
  bool doubted_ = false;                  ///< whether the warning about the position of the hand
                                          ///< was given
  std::unique_ptr<ModelsReload> reload_;  ///< not null while datasets are reloaded
  bool quit_ = false;
};

}  // namespace

ExitCode view(const ViewOptions& options, std::ostream& output) {
  return ViewSession(options).run(output);
}

}  // namespace palpate
