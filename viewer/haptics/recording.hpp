#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/base/content_id.hpp"
#include "viewer/haptics/haptic_state.hpp"
#include "viewer/haptics/haptic_tick.hpp"

namespace palpate {

/// One dataset of a run.
struct RecordedModel {
  std::string name;   ///< of the scene
  std::string file;   ///< as it was given
  ContentId dataset;  ///< content id: the file may have been replaced since
  bool operator==(const RecordedModel&) const = default;
};

/// What a run was made with: enough to make it again.
struct RecordedRun {
  std::vector<RecordedModel> models;  ///< HapticState::model counts in these
  std::vector<std::string> methods;   ///< HapticState::method counts in these
  std::string device;                 ///< HapticDevice::name()
  std::string profile;                ///< word of the device profile, may be empty
  double max_force = 0;               ///< N, of the profile
  double max_stiffness = 0;           ///< N/m, of the profile
  double workspace_radius = 0;        ///< m, of the profile
  bool scene_frame = false;           ///< HapticDevice::livesInScene()
  TickOptions options;
};
/// That of these models and this device.
RecordedRun describeRun(const std::vector<const HapticModel*>& models, const HapticDevice& device,
                        const TickOptions& options);

/// A run as it lies in a file: one entry per tick in each list. All the same length.
///
/// To give the same readings again: positions, buttons and status, one per tick at `rate`. With the
/// same datasets, methods and options the same forces follow, to the last bit, as long as nothing
/// was lost (complete()) and the loop never hung (Guarded::late).
struct Recording {
  double rate = 0;            ///< Hz
  bool scene_frame = false;   ///< positions are in the frame of the scene, not of the device
  std::vector<double> times;  ///< s, tick * period; increasing
  std::vector<Eigen::Vector3d> positions;      ///< m, DeviceReading::position: anything, also NaN
  std::vector<std::uint32_t> buttons;          ///< DeviceReading::buttons
  std::vector<DeviceStatus> status;            ///< DeviceReading::status
  std::vector<Eigen::Vector3d> tools;          ///< m, scene frame
  std::vector<Eigen::Vector3d> forces;         ///< N, scene frame, rendered
  std::vector<Eigen::Vector3d> raw_forces;     ///< N, scene frame, before the guard
  std::vector<std::uint8_t> touching;          ///< 0 or 1
  std::vector<Eigen::Vector3d> anchors;        ///< m, of the body at rest; 0 when not touching
  std::vector<Eigen::Vector3d> displacements;  ///< m, of the anchor; 0 when not touching
  std::vector<double> energies;       ///< J, stored in the tissue; NaN where the method has none
  std::vector<double> error_bounds;   ///< N; NaN where the method gives none
  std::vector<std::uint32_t> guards;  ///< Guarded bits
  std::vector<std::int32_t> models, methods;  ///< in use, by number
  RecordedRun run;

  std::size_t size() const { return times.size(); }
  /// No tick is missing from the first one of the run to the last.
  bool complete() const;
};

/// Collects the states of a run, 200 bytes each, in memory: 10 minutes at 1 kHz are 120 MB. Any one
/// thread; not the haptic one, since it allocates (HapticLoop::takeRecorded).
class Recorder {
 public:
  explicit Recorder(RecordedRun run);
  /// In the order of the ticks; Error when not.
  void add(const HapticState& state);
  std::size_t size() const { return recording_.size(); }
  const Recording& recording() const { return recording_; }
  /// Writes an HDF5 file aside and renames it, so that `file` is the old one or a whole new one.
  /// Error that names the file when it cannot be written (a full disk); nothing is left of the
  /// attempt then, and save() may be called again. The same recording gives the same bytes.
  ///
  ///   /time                  float64  n      s
  ///   /device/position       float64  n x 3  m, as Recording::positions
  ///   /device/buttons        int32    n      bits
  ///   /device/status         uint8    n      0 fresh, 1 repeated, 2 lost: part of the format
  ///   /tool/position         float64  n x 3  m, scene frame
  ///   /force/rendered, raw   float64  n x 3  N, scene frame
  ///   /contact/touching      uint8    n      0 or 1
  ///   /contact/anchor        float64  n x 3  m, at rest
  ///   /contact/displacement  float64  n x 3  m
  ///   /contact/energy        float64  n      J
  ///   /contact/error_bound   float64  n      N
  ///   /guards                int32    n      bits of Guarded: part of the format, only append
  ///   /model, /method        int32    n      in use: counted in the attributes models, methods
  ///   /workspace/rotation    float64  3 x 3  scene = origin + scale * rotation * device
  ///   /workspace/origin      float64  3      m
  ///
  /// Attributes of the root: format "palpate-recording", format_version 1; datasets, content_ids,
  /// models, methods (JSON lists of text), device, profile, contact_mode (text), all other options
  /// (numbers).
  void save(const std::filesystem::path& file) const;

 private:
  Recording recording_;
};

/// Error (bad input) when `file` is missing or no recording; Error when it is damaged: every array
/// is compared with its hash, and shapes and values are checked.
Recording readRecording(const std::filesystem::path& file);

}  // namespace palpate
