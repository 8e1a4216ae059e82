#include "viewer/haptics/haptic_model.hpp"

#include "common/base/error.hpp"
#include "common/base/parallel.hpp"
#include "viewer/fields/field_choice.hpp"

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
  fields_.resize(methods_.size());
  for (auto& of_method : fields_) of_method.resize(spaces_.size());
  inParallel(methods_.size() * spaces_.size(), [&](std::size_t n) {
    const std::size_t method = n / spaces_.size(), space = n % spaces_.size();
    fields_[method][space] = makeForceField(methods_[method], spaces_[space]);
  });
  for (std::size_t s = 0; s < spaces_.size(); ++s)
    shapes_.push_back(
        std::make_unique<DisplacementField>(spaces_[s], dataset.surfaceDisplacements(s)));
}

}  // namespace palpate
