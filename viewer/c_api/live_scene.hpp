#pragma once

#include <atomic>
#include <memory>

#include "viewer/c_api/live_module.hpp"
#include "viewer/c_api/loaded_dataset.hpp"

namespace palpate {

/// A dataset with the live solver that corrects it.
struct LiveScene {
  /// Throws the errors of followedRadius() and LiveService::start(). guessed: `corrected` is an
  /// UnsolvedDataset.
  LiveScene(std::shared_ptr<const LoadedDataset> corrected, std::unique_ptr<LiveService> solver,
            bool guessed, double period_s)
      : loaded(std::move(corrected)),
        period(period_s),
        touch(followedRadius(loaded->model, guessed ? loaded->model.buildId() : solver->build()),
              hasFibers(loaded->model)),
        service(std::move(solver)) {
    service->start(touch);
  }

  const std::shared_ptr<const LoadedDataset> loaded;
  const double period;  ///< s
  LiveTouch touch;
  const std::unique_ptr<LiveService> service;  ///< ends before `touch`
  std::atomic<bool> in_use = false;            ///< whether a contact uses this object
};

}  // namespace palpate

/// A contact shares the live scene, so handles may be closed in any order.
struct palpate_live {
  std::shared_ptr<palpate::LiveScene> scene;
};
