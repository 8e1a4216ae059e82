#pragma once

#include <memory>
#include <string>
#include <vector>

#include "viewer/answers/area_places.hpp"
#include "viewer/c_api/palpate.h"
#include "viewer/haptics/haptic_model.hpp"

namespace palpate {

/// A dataset as the C API gives it out: the prepared model, and what palpate_..._info say of it.
/// Immutable.
struct LoadedDataset {
  /// Error as of Dataset and HapticModel.
  LoadedDataset(const Dataset& dataset, const HapticModelOptions& options);

  const HapticModel model;
  const std::string content_id;
  palpate_dataset_info info{};  ///< its texts belong to this object
  std::vector<palpate_space_info> spaces;
  std::vector<palpate_area_info> areas;  ///< as HapticModel::surface().areas()
  std::vector<AreaPlaces> places;        ///< the same
};

}  // namespace palpate

/// Contacts share what they were made from, so that handles may be given back in any order.
struct palpate_dataset {
  std::shared_ptr<const palpate::LoadedDataset> loaded;
};
