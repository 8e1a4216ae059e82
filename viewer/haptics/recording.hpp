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
  std::string name;      ///< name of the scene
  std::string file;      ///< path of the dataset, as the user gave it
  ContentId dataset;     ///< content id of the dataset; the file may have been replaced since
  ContentId build = {};  ///< problemId of its scene, or of the scene that a live solver follows
};

/// Setup of a run, sufficient to repeat it.
struct RecordedRun {
  std::vector<RecordedModel> models;  ///< HapticState::model is an index into these
  std::vector<std::string> methods;   ///< HapticState::method is an index into these
  std::string device;                 ///< HapticDevice::name()
  DeviceProfile profile;              ///< limits of the device
  bool scene_frame = false;           ///< HapticDevice::livesInScene()
  TickOptions options;
};
RecordedRun describeRun(const std::vector<const HapticModel*>& models, const HapticDevice& device,
                        const TickOptions& options);

/// Collects the states of a run in memory, 310 bytes each: 10 minutes at 1 kHz take 190 MB. Use it
/// from one thread at a time, and never from the haptic thread, because it allocates; another
/// thread gets the states by HapticLoop::takeRecorded().
class Recorder {
 public:
  /// Throws Error if the period is not positive.
  explicit Recorder(RecordedRun run);
  Recorder(Recorder&&) noexcept;
  ~Recorder();
  /// Adds a state. Throws Error if its time is not after that of the last state.
  void add(const HapticState& state);
  std::size_t size() const { return size_; }
  /// Returns whether the recording contains every tick from the first tick of the run to the last
  /// one added.
  bool complete() const { return complete_; }
  /// Writes an HDF5 file under a temporary name and renames it, so `file` is either the old file or
  /// a complete new one. Throws Error with the file's name if it cannot be written (a full disk);
  /// the attempt then leaves nothing behind, and save() may be called again. The same recording
  /// gives the same bytes. n is the number of states.
  ///
  ///   /time                 float64  n     s, tick * period: increasing
  ///   /device/position      float64  n x 3 m, frame of device or scene (scene_frame); may be NaN
  ///   /device/buttons       int32    n     bits
  ///   /device/status        uint8    n     DeviceStatus: 0 fresh, 1 repeated, 2 lost, 3 away:
  ///                                        part of the format
  ///   /device/held_times    float64  n x 3 s, HeldForces: delay, interval, hold
  ///   /device/held_forces   int32    n     HeldForces: newest + 65536 oldest
  ///   /tool/position        float64  n x 3 m, scene frame
  ///   /force/rendered, raw  float64  n x 3 N, scene frame, after and before the guard
  ///   /contact/touching     uint8    n     0 or 1
  ///   /contact/anchor       float64  n x 3 m, at rest; 0 when not touching
  ///   /contact/displacement float64  n x 3 m, of the anchor; 0 when not touching
  ///   /contact/inside       uint8    n     0 or 1; 1 when not touching
  ///   /contact/coverage     float64  n     0 to 1; 1 when not touching
  ///   /contact/followed     float64  n     share of the live solver's equilibria, 0 to 1
  ///   /contact/energy       float64  n     J, in the tissue; NaN if the method has none
  ///   /contact/error_bound  float64  n     N; NaN if the method gives none
  ///   /hold/anchor          float64  n x 3 m, at rest, of a second finger; NaN without one, and
  ///                                        missing, like the next three, in runs that had none
  ///   /hold/displacement    float64  n x 3 m, of this anchor
  ///   /hold/force           float64  n x 3 N, of the tissue on it; NaN if it is not known
  ///   /hold/error_bound     float64  n     N, of this force
  ///   /guards               int32    n     bits of Guarded: part of the format, only append
  ///   /model, /method       int32    n     in use: indices into attributes models, methods
  ///   /workspace/rotation   float64  3 x 3 scene = origin + scale * rotation * device
  ///   /workspace/origin     float64  3     m
  ///
  /// Attributes of the root: format "palpate-recording", format_version 1; datasets, content_ids,
  /// build_ids, models, methods (JSON lists of text), device, profile, contact_mode (text), all
  /// other options (numbers).
  void save(const std::filesystem::path& file) const;

 private:
  struct Lists;  ///< the lists that save() writes

  RecordedRun run_;
  std::unique_ptr<Lists> lists_;
  std::size_t size_ = 0;
  double last_time_ = 0;  ///< s
  bool complete_ = true;
};

/// The touch in a tick of a recording, in the frame of the scene. Numbers may be NaN.
struct RecordedTouch {
  double time = 0;                                   ///< s
  Eigen::Vector3d tool = Eigen::Vector3d::Zero();    ///< m, position
  bool touching = false;                             ///< if not, the rest means nothing
  bool held = false;                                 ///< whether a second finger holds the body
  Eigen::Vector3d anchor = Eigen::Vector3d::Zero();  ///< m, at rest
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  ///< m, of the anchor
  Eigen::Vector3d force = Eigen::Vector3d::Zero();         ///< N, before the guard
  double error_bound = 0;                                  ///< N; NaN if the method gives none
};

/// Readings of a recorded device, one per tick, for replay. With the datasets, methods and options
/// of the run they give bitwise identical forces, if no tick is missing (Recorder::complete()) and
/// the loop never hung (Guarded::late).
struct Recording {
  double rate = 0;                      ///< Hz
  bool scene_frame = false;             ///< positions are in the scene's frame, not the device's
  DeviceProfile profile;                ///< limits of the device; named "replay" if unknown
  std::vector<ContentId> builds;        ///< RecordedModel::build; empty in old recordings
  std::vector<DeviceReading> readings;  ///< positions may be any number, also NaN
  std::vector<RecordedTouch> touches;   ///< one per tick
};

/// Reads a recording. Throws Error (bad input) if `file` is missing or not a recording, and Error
/// if it is damaged. Every array is compared with its hash, even if a replay does not need the
/// array. The values that are used are also checked.
Recording readRecording(const std::filesystem::path& file);

/// Throws Error (bad input) if the recording has no tick, or if its rate is not 1 / `period`, s:
/// otherwise the hand would move at another speed than in the recording. `source`: its name.
void checkReplay(const Recording& recording, double period, const std::string& source);

/// Returns the holds of a second finger that holds, moves and slides as the recorded tool touched;
/// one per tick. Error (bad input) if a touch is not on `surface`.
std::vector<std::optional<Hold>> holdsOf(const Recording& recording, const TouchSurface& surface,
                                         const std::string& source);

}  // namespace palpate
