#pragma once

#include <cstdint>

#include "viewer/haptics/haptic_model.hpp"

namespace palpate {

/// What touches the body: the point of a probe, which moves a single node; a disc, which moves a
/// patch of nodes; a soft finger.
enum class ToolForm : std::uint8_t { point, disc, finger };

struct ToolShape {
  ToolForm form = ToolForm::point;
  /// m: of a disc and of a finger the true size, as the dataset was computed; 0 of a point.
  double radius = 0;
  bool operator==(const ToolShape&) const = default;
};

/// The tool that a configuration space of the model was computed with.
ToolShape toolOf(const HapticModel& model, std::size_t space);

}  // namespace palpate
