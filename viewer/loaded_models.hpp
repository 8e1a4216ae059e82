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

/// The datasets of a run as the haptic loop needs them. Belongs to one thread; the models are for
/// all (HapticModel).
class LoadedModels {
 public:
  /// Called in the thread that waits, before and then some times a second, with the share that is
  /// prepared, 0 to 1. Whether to go on.
  using Meanwhile = std::function<bool(const HapticModel& model, double share)>;

  /// Reads the files; no method is prepared yet. Error as of Dataset and HapticModel.
  LoadedModels(std::vector<std::filesystem::path> files, const HapticModelOptions& options);

  /// Prepares the first method of each on all cores, with a line of the log per second that it
  /// takes. Whether `meanwhile` let it come to its end.
  bool prepareFirst(const Meanwhile& meanwhile = {});
  /// Prepares pressures, if they were asked for, and the other methods in a thread of its own,
  /// which gives way to every other.
  void prepareTheRest();

  const HapticModel& first() const { return *models_.front(); }
  /// As HapticTick and Picture take them; valid as long as this object.
  std::vector<const HapticModel*> pointers() const;
  /// Of the first scene that names a device.
  const std::optional<DeviceProfile>& device() const { return device_; }
  /// The first file that is another now than the one that was read: replaced, rewritten or gone.
  std::optional<std::filesystem::path> replaced() const;

 private:
  /// Which bytes a path names: inode, size, time of the last change. All zero: there is none.
  using FileIdentity = std::array<std::int64_t, 4>;
  static FileIdentity identityOf(const std::filesystem::path& file);

  std::vector<std::filesystem::path> files_;
  std::vector<FileIdentity> identities_;
  std::vector<std::unique_ptr<HapticModel>> models_;
  std::optional<DeviceProfile> device_;
  std::jthread preparation_;  ///< the last member: it ends before the models go
};

/// Datasets that are read, and whose first methods are prepared, in a thread of its own, which
/// gives way to every other: a hand is on the device meanwhile. Belongs to one thread.
class ModelsReload {
 public:
  ModelsReload(std::vector<std::filesystem::path> files, HapticModelOptions options);
  /// Stops it, and waits for that: some tens of milliseconds, a file that is being opened aside.
  ~ModelsReload();
  bool ended() const {
    return whole_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
  }
  /// Of all forces, 0 to 1.
  double share() const { return share_; }
  /// Once, when it has ended. Error as of LoadedModels.
  std::unique_ptr<LoadedModels> take() {
    PALPATE_ASSERT(whole_.valid(), "what was read again is taken once");
    return whole_.get();
  }

 private:
  std::stop_source stop_;
  std::atomic<double> share_ = 0;
  std::future<std::unique_ptr<LoadedModels>> whole_;  ///< the last member: of a running thread
};

}  // namespace palpate
