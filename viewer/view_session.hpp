#pragma once

#include <chrono>

#include "common/base/program.hpp"
#include "viewer/haptics/haptic_loop.hpp"
#include "viewer/haptics/recording.hpp"
#include "viewer/loaded_models.hpp"
#include "viewer/picture/picture.hpp"

namespace palpate {

/// What `palpate view` was asked for.
struct ViewOptions {
  std::vector<std::filesystem::path> datasets;  ///< at least one; the first is felt first
  std::string device = "virtual";               ///< a word of device_choice.hpp
  std::string profile;                          ///< of device_profiles; empty: the device's own
  std::string method = "potential";
  std::optional<ContactMode> contact;  ///< none: what the scene says
  double friction = 0.2;
  double reach = 0;    ///< m, TouchSurface
  double rate = 1000;  ///< Hz
  /// s of haptic time; 0: until the window is closed, the device ends or a signal comes
  double duration = 0;
  bool headless = false;
  bool fast = false;  ///< no clock: tick after tick
  bool real_time = false;
  std::filesystem::path record;      ///< empty: nothing is recorded
  std::filesystem::path screenshot;  ///< empty: none
  std::filesystem::path video;       ///< directory; empty: none
  bool json = false;
};

/// One run of the haptic client: datasets, a device, the haptic loop, a picture, a recording. The
/// thread that makes it is the one that draws.
class ViewSession {
 public:
  /// Loads the datasets, opens the window and then the device. Errors of each name what could not
  /// be had.
  explicit ViewSession(const ViewOptions& options);

  /// Until the window is closed, the duration is over, a replay has ended, or a signal came. The
  /// device is given zero, recording and picture are written, and what the loop measured goes to
  /// `output`.
  ExitCode run(std::ostream& output);

 private:
  /// Ticks and pictures take turns, without a clock: nobody can steer such a run.
  bool stepped() const { return options_.fast && !options_.headless; }
  bool over() const { return interrupted() || (picture_ && picture_->wantsClose()) || quit_; }
  std::unique_ptr<LoadedModels> load() const;
  void openPicture();
  DeviceProfile wantedProfile() const;
  DeviceProfile limits() const;
  void makeTick();
  void announce() const;

  void runStepped();
  void runLoop();
  void startLoop();
  void endLoop();
  void drainRecording();
  void look();
  PictureRequests drawFrame(const HapticState& state);
  void obey(const PictureRequests& requests);
  void reload();
  void saveRecording() const;
  void finish(std::ostream& output);

  const ViewOptions options_;
  std::unique_ptr<LoadedModels> loaded_;
  std::optional<VideoFrames> video_;
  std::unique_ptr<Picture> picture_;  ///< none when headless
  std::unique_ptr<HapticDevice> device_;
  std::unique_ptr<HapticTick> tick_;
  std::optional<Recorder> recorder_;
  std::unique_ptr<HapticLoop> loop_;  ///< none while paused, and when stepped
  LoopStatistics statistics_;         ///< of the loops that ended; of the ticks when stepped
  std::uint64_t ticks_ = 0;           ///< to make; 0: no end
  PictureStatus status_;
  std::string said_;  ///< the trouble that was logged last
  std::chrono::steady_clock::time_point looked_;
  bool quit_ = false;
};

}  // namespace palpate
