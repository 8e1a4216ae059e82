#pragma once

#include <cstdint>

#include "viewer/haptics/haptic_model.hpp"

namespace palpate {

/// Form of the tool: the point of a probe, which moves a single node; a disc, which moves a patch
/// of nodes; or a soft finger.
enum class ToolForm : std::uint8_t { point, disc, finger };

struct ToolShape {
  ToolForm form = ToolForm::point;
  /// Radius of a disc or finger as the dataset was computed, m; 0 for a point.
  double radius = 0;
  bool operator==(const ToolShape&) const = default;
};

/// Returns the tool that a configuration space of the model was computed with.
ToolShape toolOf(const HapticModel& model, std::size_t space);

}  // namespace palpate
