#pragma once

#include <memory>
#include <optional>

#include "common/base/displacement_input.hpp"
#include "common/dataset/dataset.hpp"
#include "common/scene/active_choice.hpp"
#include "viewer/answers/area_places.hpp"

namespace palpate {

/// Forces of an active node, or of the area of a finger, as all commands give them. Without places
/// the chosen method interpolates the space of the active node; with places, the energy of the area
/// does. An area is prepared only around the requested places.
///
/// One thread at a time.
class ForceAnswers {
 public:
  /// active: a name; may be empty if there is only one. with_places: touches have a place (--at).
  /// The dataset must outlive this object.
  ///
  /// Error (bad input) for an unknown name or method, for places without a finger, for an area
  /// without places, and for a method other than the areas' together with places.
  ForceAnswers(const Dataset& dataset, const std::string& active, bool with_places,
               const std::string& method);

  /// Returns the answer to a touch, with -0 replaced by 0. Around a new place of an area this
  /// prepares its sites, some 50 ms of processor time each. Error (bad input) if the place is
  /// farther from the surface than the body is wide. The touch must have a place if and only if the
  /// object was made for places.
  ForceAnswer answer(const TouchInput& touch) const;

  /// Number of prepared sites of the area; 0 for a node.
  std::size_t preparedSites() const { return area_ ? area_->madeSites() : 0; }

  const ActiveChoice& choice() const { return choice_; }
  /// Space of the active node, or of the area's first site.
  const SpaceTable& firstSpace() const { return first_; }
  double workspaceRadius() const { return first_.lattice.radius(); }  ///< m
  const std::string& method() const { return method_; }               ///< name of the method

 private:
  const Dataset& dataset_;
  const ActiveChoice choice_;
  const SpaceTable& first_;
  const std::string method_;
  std::unique_ptr<ForceField> field_;  ///< set without places
  std::unique_ptr<AreaField> area_;    ///< set with places
  std::optional<AreaPlaces> places_;
};

}  // namespace palpate
