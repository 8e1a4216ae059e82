#pragma once

#include <cstdint>

#include "viewer/haptics/haptic_model.hpp"

namespace palpate {

/// Form of the tool. A point, like that of a probe, moves a single node; a disc moves a patch of
/// nodes; a finger is soft.
enum class ToolForm : std::uint8_t { point, disc, finger };

struct ToolShape {
  ToolForm form = ToolForm::point;
  /// Radius with which the dataset was computed, m, for a disc or a finger; 0 for a point.
  double radius = 0;
  bool operator==(const ToolShape&) const = default;
};

/// Returns the tool with which a configuration space of the model was computed.
ToolShape toolOf(const HapticModel& model, std::size_t space);

}  // namespace palpate
