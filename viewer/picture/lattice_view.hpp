#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "viewer/haptics/haptic_tick.hpp"
#include "viewer/picture/body_view.hpp"
#include "viewer/picture/panel_contents.hpp"

namespace palpate {

/// The lattice of one configuration space in the view. The space is the one with the largest weight
/// in the current touch or, without a touch, in the last one. Its dots are drawn in front of the
/// body, and sorted by depth among themselves. Used by the thread of the Window only.
class LatticeView {
 public:
  /// Shows the dots that the user chose, or none. body: view of the model in `state`. When the
  /// errors of a method are first shown, all cells are evaluated, which takes a few milliseconds.
  void show(const BodyView& body, const HapticState& state, const ViewChoices& choices);
  /// Returns the space that was shown last; 0 if the model has changed since.
  std::int32_t space() const { return space_; }
  /// origin: m, scene frame; added to the displacements. size: diameter of a dot without its white
  /// rim, in pixels of a picture that is 800 pixels high; larger in a larger picture.
  void setDots(std::span<const LatticeDot> dots, const Eigen::Vector3d& origin, double size);
  void show(bool shown) { shown_ = shown; }
  /// Changes OpenGL's state, and requires its default state when it is called (Stage).
  void draw() const;

 private:
  /// Everything that the dots depend on.
  struct Key {
    std::int32_t model = -1, method = -1;  ///< method is -1 for dots coloured by tag
    std::int32_t space = 0;
    std::optional<LatticeCut> cut;
    bool operator==(const Key&) const = default;
  };
  std::vector<LatticeDot> dotsOf(const HapticModel& model);

  bool shown_ = false;
  std::vector<float> places_;          ///< [dot][axis], m
  std::vector<std::uint8_t> colours_;  ///< [dot][red, green, blue]
  float size_ = 4;                     ///< px, as in setDots()

  std::int32_t model_ = -1;
  std::int32_t space_ = 0;
  Key filled_;
  /// by model, method and space
  std::map<std::array<std::int32_t, 3>, std::vector<CellError>> errors_;
};

}  // namespace palpate
