#pragma once

#include <array>
#include <map>
#include <vector>

#include "viewer/haptics/haptic_state.hpp"
#include "viewer/picture/lattice_view.hpp"
#include "viewer/picture/panel_contents.hpp"
#include "viewer/picture/shown_model.hpp"

namespace palpate {

/// The lattice of one configuration space in the view: of the space with the largest weight in the
/// touch, or the last that had it. One thread.
class ShownLattice {
 public:
  /// Fills the view with the dots that the person chose to see of the model, which is that of the
  /// state. Where a method's errors are seen for the first time all cells are evaluated: some
  /// milliseconds.
  void show(const ShownModel& shown, const HapticState& state, const ViewChoices& choices,
            LatticeView& view);
  /// The space that was shown last; 0 after another model came.
  std::size_t space() const { return space_; }

 private:
  /// What decides which dots there are.
  struct Key {
    std::int32_t model = -1, method = -1;  ///< method: -1 for dots by tag
    std::size_t space = 0;
    bool cut = false;
    int axis = 0;
    double offset = 0;
    bool operator==(const Key&) const = default;
  };
  std::vector<LatticeDot> dotsOf(const HapticModel& model, const HapticState& state,
                                 const ViewChoices& choices);

  std::int32_t model_ = -1;
  std::size_t space_ = 0;
  Key filled_;
  std::map<std::array<std::size_t, 3>, std::vector<CellError>>
      errors_;  ///< by model, method, space
};

}  // namespace palpate
