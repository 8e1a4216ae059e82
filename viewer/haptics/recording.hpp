#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "common/base/bytes32.hpp"
#include "viewer/haptics/haptic_tick.hpp"

namespace palpate {

/// One dataset of a run.
struct RecordedModel {
  std::string name;   ///< of the scene
  std::string file;   ///< as it was given
  ContentId dataset;  ///< content id: the file may have been replaced since
};

/// What a run was made with: enough to make it again.
struct RecordedRun {
  std::vector<RecordedModel> models;  ///< HapticState::model counts in these
  std::vector<std::string> methods;   ///< HapticState::method counts in these
  std::string device;                 ///< HapticDevice::name()
  DeviceProfile profile;              ///< of the device
  bool scene_frame = false;           ///< HapticDevice::livesInScene()
  TickOptions options;
};
/// That of these models and this device.
RecordedRun describeRun(const std::vector<const HapticModel*>& models, const HapticDevice& device,
                        const TickOptions& options);

/// Collects the states of a run, 200 bytes each, in memory: 10 minutes at 1 kHz are 120 MB. Any one
/// thread; not the haptic one, since it allocates (HapticLoop::takeRecorded).
class Recorder {
 public:
  /// Error when the period is not positive.
  explicit Recorder(RecordedRun run);
  Recorder(Recorder&&) noexcept;
  ~Recorder();
  /// In the order of the ticks; Error when not.
  void add(const HapticState& state);
  std::size_t size() const { return size_; }
  /// No tick is missing from the first one of the run to the last.
  bool complete() const { return complete_; }
  /// Writes an HDF5 file aside and renames it, so that `file` is the old one or a whole new one.
  /// Error that names the file when it cannot be written (a full disk); nothing is left of the
  /// attempt then, and save() may be called again. The same recording gives the same bytes.
  ///
  ///   /time                 float64  n     s, tick * period: increasing
  ///   /device/position      float64  n x 3 m, of device or scene (scene_frame); also NaN
  ///   /device/buttons       int32    n     bits
  ///   /device/status        uint8    n     DeviceStatus: 0 fresh, 1 repeated, 2 lost, 3 away:
  ///                                      part of the format
  ///   /device/held_times    float64  n x 3 s, HeldForces: delay, interval, hold
  ///   /device/held_forces   int32    n     HeldForces: newest + 65536 oldest
  ///   /tool/position        float64  n x 3 m, scene frame
  ///   /force/rendered, raw  float64  n x 3 N, scene frame, after and before the guard
  ///   /contact/touching     uint8    n     0 or 1
  ///   /contact/anchor       float64  n x 3 m, at rest; 0 when not touching
  ///   /contact/displacement float64  n x 3 m, of the anchor; 0 when not touching
  ///   /contact/inside       uint8    n     0 or 1; 1 when not touching
  ///   /contact/coverage     float64  n     0 to 1; 1 when not touching
  ///   /contact/energy       float64  n     J, in the tissue; NaN where the method has none
  ///   /contact/error_bound  float64  n     N; NaN where the method gives none
  ///   /guards               int32    n     bits of Guarded: part of the format, only append
  ///   /model, /method       int32    n     in use: counted in attributes models, methods
  ///   /workspace/rotation   float64  3 x 3 scene = origin + scale * rotation * device
  ///   /workspace/origin     float64  3     m
  ///
  /// Attributes of the root: format "palpate-recording", format_version 1; datasets, content_ids,
  /// models, methods (JSON lists of text), device, profile, contact_mode (text), all other options
  /// (numbers).
  void save(const std::filesystem::path& file) const;

 private:
  struct Lists;  ///< the lists above

  RecordedRun run_;
  std::unique_ptr<Lists> lists_;
  std::size_t size_ = 0;
  double last_time_ = 0;  ///< s
  bool complete_ = true;
};

/// What a recorded device said, to be said again: one reading per tick. With the datasets, methods
/// and options of the run the same forces follow, to the last bit, as long as no tick is missing
/// (Recorder::complete()) and the loop never hung (Guarded::late).
struct Recording {
  double rate = 0;           ///< Hz
  bool scene_frame = false;  ///< positions are in the frame of the scene, not of the device
  DeviceProfile profile;     ///< of the device; its name is "replay" where it is no usual one
  std::vector<DeviceReading> readings;  ///< positions may be anything, also NaN
};

/// Error (bad input) when `file` is missing or no recording; Error when it is damaged: every array
/// is compared with its hash, also those that a replay does not need, and what it does is checked.
Recording readRecording(const std::filesystem::path& file);

}  // namespace palpate
