#pragma once

#include <memory>
#include <optional>

#include "common/base/displacement_input.hpp"
#include "common/dataset/dataset.hpp"
#include "common/scene/active_choice.hpp"
#include "viewer/answers/area_places.hpp"

namespace palpate {

/// Computes the forces at an active node or on the area of a finger; all commands use this class.
/// Touches without a place are answered by interpolating the space of the active node with the
/// chosen method. Touches with a place are answered by the energy of the area, which is prepared
/// only around the requested places.
///
/// One thread at a time.
class ForceAnswers {
 public:
  /// active: name of an active node or an area; may be empty if the dataset has only one.
  /// with_places: whether touches have a place (--at). The dataset must outlive this object.
  ///
  /// Error (bad input) for an unknown name or method, for touches with places if `active` is not a
  /// finger, and for touches without places on an area. With places, the method must be the first
  /// of forceFieldMethods().
  ForceAnswers(const Dataset& dataset, const std::string& active, bool with_places,
               const std::string& method);

  /// Returns the answer for a touch, with -0 replaced by 0. At a new place of an area it first
  /// prepares the sites around the place, about 50 ms of processor time each. Error (bad input) if
  /// the place is farther from the surface than the body is wide. The touch must have a place if
  /// and only if with_places was true.
  ForceAnswer answer(const TouchInput& touch) const;

  /// Returns the number of prepared sites of the area; 0 for a node.
  std::size_t preparedSites() const { return area_ ? area_->madeSites() : 0; }

  const ActiveChoice& choice() const { return choice_; }
  /// Returns the space of the active node, or of the area's first site.
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
