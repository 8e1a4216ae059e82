#pragma once

#include <memory>
#include <optional>

#include "common/base/displacement_input.hpp"
#include "common/dataset/dataset.hpp"
#include "common/scene/active_choice.hpp"
#include "viewer/answers/area_places.hpp"

namespace palpate {

/// Forces of one active node, or of the area of a finger, as every verb answers with them: by the
/// interpolation that was asked for, or by the one energy of the area where places are given. An
/// area is prepared where it is asked, and nowhere else.
///
/// One thread at a time.
class ForceAnswers {
 public:
  /// active: a name, empty where there is only one; with_places: touches have a place (--at).
  /// The dataset must outlive this object. Error (bad input) for an
  /// unknown name or method, a place of what is no finger, an area without places, and for a place
  /// together with another method than that of areas.
  ForceAnswers(const Dataset& dataset, const std::string& active, bool with_places,
               const std::string& method);

  /// Without signs of zeros. Around a place of an area that was not asked before this takes as long
  /// as its sites do, some 50 ms of processor time each. Error (bad input) when the place is
  /// farther from the surface than the body is wide. A touch without a place where one is needed is
  /// a mistake of the caller.
  ForceAnswer answer(const TouchInput& touch) const;

  /// How many sites of the area are prepared; 0 of a node.
  std::size_t preparedSites() const { return area_ ? area_->madeSites() : 0; }

  const ActiveChoice& choice() const { return choice_; }
  /// The space of the active node; of an area its first site.
  const SpaceTable& firstSpace() const { return first_; }
  double workspaceRadius() const { return first_.lattice.radius(); }  ///< m
  const std::string& method() const { return method_; }               ///< its word

 private:
  const Dataset& dataset_;
  const ActiveChoice choice_;
  const SpaceTable& first_;
  const std::string method_;
  std::unique_ptr<ForceField> field_;  ///< without a place
  std::unique_ptr<AreaField> area_;    ///< with one
  std::optional<AreaPlaces> places_;
};

}  // namespace palpate
