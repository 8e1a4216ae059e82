#include "viewer/haptics/haptic_model.hpp"

#include "common/error.hpp"

namespace palpate {

HapticModel::HapticModel(const Dataset& dataset, const HapticModelOptions& options)
    : name_(dataset.scene().name),
      file_(dataset.file().string()),
      content_(dataset.contentId()),
      contact_(dataset.scene().contact),
      max_force_(dataset.scene().workspace.max_force),
      surface_(dataset, options.reach),
      spaces_(dataset.spaces()),
      methods_(options.methods) {
  if (methods_.empty()) throw badInput("{}: no method to interpolate forces by was given", file_);
  for (const std::string& method : methods_) {
    fields_.emplace_back();
    for (const SpaceTable& space : spaces_) fields_.back().push_back(makeForceField(method, space));
  }
  for (std::size_t s = 0; s < spaces_.size(); ++s)
    shapes_.push_back(std::make_unique<DisplacementField>(spaces_[s], dataset.surfaceDisplacements(s)));
}

}  // namespace palpate
