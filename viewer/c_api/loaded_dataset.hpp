#pragma once

#include <memory>
#include <string>
#include <vector>

#include "viewer/c_api/palpate.h"
#include "viewer/haptics/haptic_model.hpp"

namespace palpate {

/// A dataset as the C API gives it out: the prepared model, and what palpate_..._info say of it.
/// Immutable.
class LoadedDataset {
 public:
  /// Error as of Dataset and HapticModel.
  LoadedDataset(const Dataset& dataset, const HapticModelOptions& options);

  const HapticModel& model() const { return model_; }
  const palpate_dataset_info& info() const { return info_; }  ///< its texts belong to this object
  const std::vector<palpate_space_info>& spaces() const { return spaces_; }

 private:
  HapticModel model_;
  std::string content_id_;
  palpate_dataset_info info_;
  std::vector<palpate_space_info> spaces_;
};

}  // namespace palpate

/// Contacts share what they were made from, so that handles may be given back in any order.
struct palpate_dataset {
  std::shared_ptr<const palpate::LoadedDataset> loaded;
};
