#include <dlfcn.h>

#include <filesystem>
#include <stdexcept>

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
  return answered(__func__, [&] {
    need("live", live) = nullptr;
    need("scene", scene);
    palpate_live_options defaults{};
    defaults.period = 1e-3;
    const palpate_live_options chosen = takenOptions(options, defaults);
    finite("options->period", chosen.period, Least::above_zero);
    *live = new palpate_live{startedFor(scene, dataset, chosen)};
  });
}

void palpate_live_stop(palpate_live* live) { delete live; }

palpate_status palpate_live_hold(palpate_live* live, const double place[3],
                                 const double displacement[3]) {
  return answered(__func__, [&] {
    LiveTouch& touch = need("live", live).scene->touch;
    if (place == nullptr) return touch.setHold(std::nullopt);
    const Hold hold = {vectorOf(place), vectorOf("displacement", displacement)};
    if (!hold.place.allFinite() || !hold.displacement.allFinite())
      refuse("place and displacement must be finite");
    touch.setHold(hold);
  });
}

palpate_status palpate_live_hold_force(palpate_live* live, double force[3]) {
  return answered(__func__, [&] {
    LiveTouch& touch = need("live", live).scene->touch;
    give(&need("force", force), touch.holdForce().force);
  });
}

palpate_status palpate_live_dataset(const palpate_live* live, palpate_dataset** dataset) {
  return answered(__func__, [&] {
    need("dataset", dataset) = nullptr;
    *dataset = new palpate_dataset{need("live", live).scene->loaded};
  });
}

palpate_status palpate_live_describe(const palpate_live* live, palpate_live_info* info) {
  return answered(__func__, [&] {
    const LiveService& service = *need("live", live).scene->service;
    const LiveStatistics statistics = service.statistics();
    palpate_live_info now{};
    now.ready = service.trouble().empty() ? 1 : 0;
    now.answers = statistics.answers;
    now.failures = statistics.failures;
    now.restarts = statistics.restarts;
    now.mean_seconds = statistics.meanSeconds();
    now.largest_seconds = statistics.largest_seconds;
    give("info", info, now);
  });
}

palpate_status palpate_live_trouble(const palpate_live* live, char* text, std::size_t capacity) {
  return answered(__func__, [&] {
    const std::string trouble = need("live", live).scene->service->trouble();
    const auto room = roomIn("text", text, capacity, 1);
    text[trouble.copy(room.data(), capacity - 1)] = '\0';
  });
}
