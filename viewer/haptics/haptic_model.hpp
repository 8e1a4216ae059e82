#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/dataset/dataset.hpp"
#include "viewer/fields/displacement_field.hpp"
#include "viewer/fields/force_field.hpp"
#include "viewer/haptics/touch_surface.hpp"

namespace palpate {

struct HapticModelOptions {
  /// Prepared for switching between them while touching; the first is the one to start with.
  std::vector<std::string> methods = {"potential", "trilinear"};
  double reach = 0;  ///< m, TouchSurface
};

/// All of one dataset that a hand needs, prepared and in memory: the file may be replaced or go.
/// Immutable: any thread may read.
class HapticModel {
 public:
  /// Error when the dataset has nothing to touch, or a method is unknown. Seconds for ten spaces of
  /// 515 points: spaces and methods are prepared side by side, on as many threads as there are
  /// cores.
  explicit HapticModel(const Dataset& dataset, const HapticModelOptions& options = {});

  const std::string& name() const { return name_; }  ///< of the scene
  const std::string& file() const { return file_; }
  ContentId contentId() const { return content_; }
  ContactMode contactMode() const { return contact_; }  ///< what the scene asks for
  double maxForce() const { return max_force_; }  ///< N, of the scene: nothing beyond it was solved
  const TouchSurface& surface() const { return surface_; }
  const std::vector<SpaceTable>& spaces() const { return spaces_; }
  const std::vector<std::string>& methods() const { return methods_; }
  const ForceField& field(std::size_t method, std::size_t space) const {
    return *fields_[method][space];
  }
  /// Displacements of the surface's vertices.
  const DisplacementField& shape(std::size_t space) const { return *shapes_[space]; }

 private:
  std::string name_, file_;
  ContentId content_;
  ContactMode contact_;
  double max_force_;
  TouchSurface surface_;
  std::vector<SpaceTable> spaces_;
  std::vector<std::string> methods_;
  std::vector<std::vector<std::unique_ptr<ForceField>>> fields_;  ///< [method][space]
  std::vector<std::unique_ptr<DisplacementField>> shapes_;        ///< [space]
};

}  // namespace palpate
