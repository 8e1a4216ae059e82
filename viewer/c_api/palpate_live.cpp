#include <dlfcn.h>

#include <filesystem>
#include <stdexcept>

#include "viewer/c_api/arguments.hpp"
#include "viewer/c_api/live_scene.hpp"
#include "viewer/haptics/haptic_device.hpp"

using namespace palpate;

namespace {

/// Loads the module, which lies in the folder palpate beside this library.
OpenLiveService* liveModule() {
  Dl_info here;
  if (dladdr(reinterpret_cast<const void*>(&palpate_live_start), &here) == 0)
    throw std::runtime_error("cannot find the file of libpalpate");
  const std::filesystem::path module =
      std::filesystem::path(here.dli_fname).parent_path() / "palpate/live-" PALPATE_VERSION ".so";
  void* const loaded = dlopen(module.c_str(), RTLD_NOW | RTLD_LOCAL);
  void* const entry = loaded != nullptr ? dlsym(loaded, live_service_entry) : nullptr;
  if (entry == nullptr)
    throw std::runtime_error(fmt::format("{}; install the package palpate", dlerror()));
  return reinterpret_cast<OpenLiveService*>(entry);
}

std::shared_ptr<LiveScene> startedFor(const char* file, const palpate_dataset* dataset,
                                      const palpate_live_options& given) {
  static OpenLiveService* const open = liveModule();
  const bool unsolved = dataset == nullptr;
  std::unique_ptr<LiveService> service;
  std::shared_ptr<const LoadedDataset> loaded;
  {
    const std::lock_guard lock(hdf5Mutex());
    service.reset(open({file, unsolved, given.worker, given.follower, given.keys}));
    loaded = unsolved ? std::make_shared<const LoadedDataset>(
                            Dataset(service->unsolved()),
                            HapticModelOptions{.methods = {"potential"}, .guess = true})
                      : dataset->loaded;
  }
  return std::make_shared<LiveScene>(loaded, std::move(service), unsolved, given.period);
}

}  // namespace

palpate_status palpate_live_start(const char* scene, const palpate_dataset* dataset,
                                  const palpate_live_options* options, palpate_live** live) {
  if (!isThere(__func__, "live", live)) return PALPATE_INVALID_ARGUMENT;
  *live = nullptr;
  palpate_live_options chosen{};
  chosen.period = 1e-3;
  if (!isThere(__func__, "scene", scene) || !takeOptions(__func__, options, chosen) ||
      !isFinite(__func__, "options->period", chosen.period, Least::above_zero))
    return PALPATE_INVALID_ARGUMENT;
  return withoutExceptions(__func__,
                           [&] { *live = new palpate_live{startedFor(scene, dataset, chosen)}; });
}

void palpate_live_stop(palpate_live* live) { delete live; }

palpate_status palpate_live_hold(palpate_live* live, const double place[3],
                                 const double displacement[3]) {
  if (!isThere(__func__, "live", live)) return PALPATE_INVALID_ARGUMENT;
  if (place == nullptr) {
    live->scene->touch.setHold(std::nullopt);
    return PALPATE_OK;
  }
  if (!isThere(__func__, "displacement", displacement)) return PALPATE_INVALID_ARGUMENT;
  const Hold hold = {Eigen::Vector3d::Map(place), Eigen::Vector3d::Map(displacement)};
  if (!hold.place.allFinite() || !hold.displacement.allFinite())
    return fail(PALPATE_INVALID_ARGUMENT, "{}: place and displacement must be finite", __func__);
  live->scene->touch.setHold(hold);
  return PALPATE_OK;
}

palpate_status palpate_live_hold_force(palpate_live* live, double force[3]) {
  if (!isThere(__func__, "live", live) || !isThere(__func__, "force", force))
    return PALPATE_INVALID_ARGUMENT;
  Eigen::Vector3d::Map(force) = live->scene->touch.holdForce().value_or(nowhere());
  return PALPATE_OK;
}

palpate_status palpate_live_dataset(const palpate_live* live, palpate_dataset** dataset) {
  if (!isThere(__func__, "live", live) || !isThere(__func__, "dataset", dataset))
    return PALPATE_INVALID_ARGUMENT;
  *dataset = nullptr;
  return withoutExceptions(__func__, [&] { *dataset = new palpate_dataset{live->scene->loaded}; });
}

palpate_status palpate_live_describe(const palpate_live* live, palpate_live_info* info) {
  if (!isThere(__func__, "live", live) || !sizeIsKnown(__func__, "info", info))
    return PALPATE_INVALID_ARGUMENT;
  return withoutExceptions(__func__, [&] {
    const LiveStatistics statistics = live->scene->service->statistics();
    palpate_live_info now{};
    now.ready = live->scene->service->trouble().empty() ? 1 : 0;
    now.answers = statistics.answers;
    now.failures = statistics.failures;
    now.restarts = statistics.restarts;
    now.mean_seconds = statistics.meanSeconds();
    now.largest_seconds = statistics.largest_seconds;
    give(info, now);
  });
}

palpate_status palpate_live_trouble(const palpate_live* live, char* text, std::size_t capacity) {
  if (!isThere(__func__, "live", live) || !isThere(__func__, "text", text) ||
      !isEnough(__func__, capacity, 1))
    return PALPATE_INVALID_ARGUMENT;
  return withoutExceptions(__func__, [&] {
    const std::string trouble = live->scene->service->trouble();
    text[trouble.copy(text, capacity - 1)] = '\0';
  });
}
