#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <thread>

#include "common/base/assertion.hpp"
#include "common/scene/device_profile.hpp"
#include "viewer/haptics/haptic_model.hpp"

namespace palpate {

/// The datasets of a run, prepared for the haptic loop. This object belongs to one thread, but any
/// thread may use its models (HapticModel).
class LoadedModels {
 public:
  /// Called on the thread that waits in prepareFirst(), at the start of the preparation and then
  /// several times a second. share: progress of the preparation, 0 to 1. Returns false to stop the
  /// preparation.
  using Meanwhile = std::function<bool(const HapticModel& model, double share)>;

  /// Reads the files without preparing any method. Throws the errors of Dataset and HapticModel.
  LoadedModels(std::vector<std::filesystem::path> files, const HapticModelOptions& options);

  /// Prepares the first method of each dataset on all cores. Returns false if `meanwhile` stopped
  /// the preparation. log: whether to log the progress once a second.
  bool prepareFirst(const Meanwhile& meanwhile = {}, bool log = true);
  /// Prepares the pressures (if requested) and then the other methods, on a thread of lowest
  /// priority.
  void prepareTheRest();

  const HapticModel& first() const { return *models_.front(); }
  /// Returns the models for HapticTick and Picture; valid during the lifetime of this object.
  std::vector<const HapticModel*> pointers() const;
  /// Returns the limits of the device named by the first scene that names one.
  const std::optional<DeviceProfile>& device() const { return device_; }
  /// Returns the first file that has been replaced, rewritten or removed since it was read; nullopt
  /// if there is none.
  std::optional<std::filesystem::path> replaced() const;

 private:
  /// Identifies the content of a file: inode, size and modification time. All zero if there is no
  /// file.
  using FileIdentity = std::array<std::int64_t, 4>;
  static FileIdentity identityOf(const std::filesystem::path& file);

  std::vector<std::filesystem::path> files_;
  std::vector<FileIdentity> identities_;
  std::vector<std::unique_ptr<HapticModel>> models_;
  std::optional<DeviceProfile> device_;
  std::jthread preparation_;  ///< last member: ends before the models are destroyed
};

/// Reads datasets and prepares their first methods in the background, on a thread of lowest
/// priority, while the haptic loop continues to run. Belongs to one thread.
class ModelsReload {
 public:
  ModelsReload(std::vector<std::filesystem::path> files, HapticModelOptions options);
  /// Stops the thread and waits until it has ended: tens of milliseconds, or longer while a file is
  /// being opened.
  ~ModelsReload();
  bool ended() const {
    return whole_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
  }
  /// Returns the progress of the preparation of all forces, 0 to 1.
  double share() const { return share_; }
  /// Returns the models. Call once, and only when ended(). Throws the errors of LoadedModels.
  std::unique_ptr<LoadedModels> take() {
    PALPATE_ASSERT(whole_.valid(), "the result of a reload must be taken only once");
    return whole_.get();
  }

 private:
  std::stop_source stop_;
  std::atomic<double> share_ = 0;
  std::future<std::unique_ptr<LoadedModels>> whole_;  ///< last member: its thread uses the other
                                                      ///< members
};

}  // namespace palpate
