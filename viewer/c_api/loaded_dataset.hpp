#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "viewer/answers/area_places.hpp"
#include "viewer/c_api/arguments.hpp"
#include "viewer/haptics/haptic_model.hpp"

namespace palpate {

/// The dataset of a handle: the prepared model, and the filled palpate_..._info structures.
/// Immutable.
struct LoadedDataset {
  /// Throws the errors of Dataset and HapticModel.
  LoadedDataset(const Dataset& dataset, const HapticModelOptions& options);

  const HapticModel model;
  const std::string content_id;
  palpate_dataset_info info{};  ///< the texts belong to this object
  std::vector<palpate_space_info> spaces;
  std::vector<palpate_area_info> areas;  ///< same order as HapticModel::surface().areas()
  std::vector<AreaPlaces> places;        ///< same order as areas
};

/// Hold this mutex while a function reads or writes a dataset file: HDF5 is not thread-safe.
std::mutex& hdf5Mutex();

}  // namespace palpate

/// Contacts share the loaded dataset, so handles may be closed in any order.
struct palpate_dataset {
  std::shared_ptr<const palpate::LoadedDataset> loaded;
};

namespace palpate {

inline const LoadedDataset& loadedOf(const palpate_dataset* dataset) {
  return *need("dataset", dataset).loaded;
}

}  // namespace palpate
