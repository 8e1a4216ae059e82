#include "viewer/picture/tool_shape.hpp"

namespace palpate {

ToolShape toolOf(const HapticModel& model, std::size_t space) {
  const double radius = model.toolRadius(space);
  if (model.spaces()[space].patch.finger) return {ToolForm::finger, radius};
  return radius > 0 ? ToolShape{ToolForm::disc, radius} : ToolShape{};
}

}  // namespace palpate
