#include "viewer/loaded_models.hpp"

#include <spdlog/spdlog.h>
#include <sys/stat.h>

#include <algorithm>

#include "common/base/machine.hpp"
#include "common/base/number_text.hpp"
#include "common/dataset/dataset.hpp"

namespace palpate {
namespace {

using namespace std::chrono_literals;

constexpr auto tell_every = 1s;
constexpr auto call_every = 50ms;

bool prepareFirstMethod(HapticModel& model, const LoadedModels::Meanwhile& meanwhile, bool log) {
  std::stop_source stop;
  const auto look = [&] {
    if (meanwhile && !meanwhile(model, model.preparedShare(0))) stop.request_stop();
  };
  look();
  // Prepare on another thread, so that this thread can show the progress, which matters for a large
  // dataset.
  auto prepared = std::async(std::launch::async, [&] { model.prepare(0, stop.get_token()); });
  auto tell = std::chrono::steady_clock::now() + tell_every;
  while (prepared.wait_for(call_every) != std::future_status::ready) {
    look();
    if (!log || std::chrono::steady_clock::now() < tell) continue;
    tell += tell_every;
    spdlog::info("{}: preparing {}, {:.0f} % of {}", model.file(), model.methods()[0],
                 100 * model.preparedShare(0), counted(model.spaces().size(), "space"));
  }
  prepared.get();
  return !stop.stop_requested();
}

}  // namespace

LoadedModels::LoadedModels(std::vector<std::filesystem::path> files,
                           const HapticModelOptions& options)
    : files_(std::move(files)) {
  PALPATE_ASSERT(!files_.empty(), "at least one dataset must be given");
  HapticModelOptions unprepared = options;
  unprepared.prepare = false;
  for (const std::filesystem::path& file : files_) {
    // Take the identity before reading the file, so that a replacement during the read is noticed.
    identities_.push_back(identityOf(file));
    const Dataset dataset(file);
    if (!options.guess) warnIfPartial(dataset);
    models_.push_back(std::make_unique<HapticModel>(dataset, unprepared));
    if (!device_ && dataset.scene().device) device_ = dataset.scene().device->profile;
  }
}

bool LoadedModels::prepareFirst(const Meanwhile& meanwhile, bool log) {
  return std::ranges::all_of(
      models_, [&](const auto& model) { return prepareFirstMethod(*model, meanwhile, log); });
}

void LoadedModels::prepareTheRest() {
  preparation_ = std::jthread([this](const std::stop_token& stop) {
    giveWay();
    // If preparing one model fails, for example for lack of memory, still prepare the others.
    for (const auto& model : models_) try {
        model->preparePressures(stop);
      } catch (const std::exception& error) {
        spdlog::warn("{}: cannot prepare pressures: {}", model->file(), error.what());
      }
    for (const auto& model : models_)
      for (std::size_t method = 1; method < model->methods().size(); ++method) try {
          model->prepare(method, stop, /*alone=*/true);
        } catch (const std::exception& error) {
          spdlog::warn("{}: cannot prepare method {}: {}", model->file(), model->methods()[method],
                       error.what());
        }
  });
}

ModelsReload::ModelsReload(std::vector<std::filesystem::path> files, HapticModelOptions options) {
  options.stop = stop_.get_token();
  whole_ = std::async(std::launch::async, [this, files = std::move(files), options] {
    giveWay();
    auto models = std::make_unique<LoadedModels>(files, options);
    const std::vector<const HapticModel*> all = models->pointers();
    const auto meanwhile = [&](const HapticModel& model, double share) {
      const auto done = std::ranges::find(all, &model) - all.begin();
      share_ = (static_cast<double>(done) + share) / static_cast<double>(all.size());
      return !options.stop.stop_requested();
    };
    models->prepareFirst(meanwhile, /*log=*/false);
    return models;
  });
}

ModelsReload::~ModelsReload() {
  stop_.request_stop();
  if (whole_.valid()) whole_.wait();
}

std::vector<const HapticModel*> LoadedModels::pointers() const {
  return mapped(models_, [](const auto& model) -> const HapticModel* { return model.get(); });
}

std::optional<std::filesystem::path> LoadedModels::replaced() const {
  for (std::size_t n = 0; n < files_.size(); ++n)
    if (identityOf(files_[n]) != identities_[n]) return files_[n];
  return std::nullopt;
}

LoadedModels::FileIdentity LoadedModels::identityOf(const std::filesystem::path& file) {
  struct stat found {};
  if (stat(file.c_str(), &found) != 0) return {};
  return {static_cast<std::int64_t>(found.st_ino), found.st_size, found.st_mtim.tv_sec,
          found.st_mtim.tv_nsec};
}

}  // namespace palpate
