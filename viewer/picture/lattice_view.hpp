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

/// The lattice of one configuration space in the view: of the space with the largest weight in the
/// touch, or the last that had it. Its dots are drawn in front of everything drawn before (the
/// body), and in depth among themselves. Belongs to the thread of the Window.
class LatticeView {
 public:
  /// Shows the dots that the person chose to see of the model, which is that of the state, or none.
  /// Where a method's errors are seen for the first time all cells are evaluated: some
  /// milliseconds.
  void show(const BodyView& body, const HapticState& state, const ViewChoices& choices);
  /// The space that was shown last; 0 after another model came.
  std::int32_t space() const { return space_; }
  /// origin: added to the displacements, m, scene frame. size: of a dot without its white rim,
  /// pixels where the picture has 800 from top to bottom; more in a larger one.
  void setDots(std::span<const LatticeDot> dots, const Eigen::Vector3d& origin, double size);
  void show(bool shown) { shown_ = shown; }
  /// Changes OpenGL's state, and begins with its default (Stage).
  void draw() const;

 private:
  /// What decides which dots there are.
  struct Key {
    std::int32_t model = -1, method = -1;  ///< method: -1 for dots by tag
    std::int32_t space = 0;
    std::optional<LatticeCut> cut;
    bool operator==(const Key&) const = default;
  };
  std::vector<LatticeDot> dotsOf(const HapticModel& model);

  bool shown_ = false;
  std::vector<float> places_;          ///< [dot][axis], m
  std::vector<std::uint8_t> colours_;  ///< [dot][red, green, blue]
  float size_ = 4;                     ///< px, as for setDots()

  std::int32_t model_ = -1;
  std::int32_t space_ = 0;
  Key filled_;
  /// By model, method, space.
  std::map<std::array<std::int32_t, 3>, std::vector<CellError>> errors_;
};

}  // namespace palpate
