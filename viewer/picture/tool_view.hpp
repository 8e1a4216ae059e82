#pragma once

#include "viewer/picture/coin.hpp"

class SoTransform;

namespace palpate {

/// Draws the tool as a small sphere, the force on it as an arrow from its centre, and the anchor,
/// at rest, with a line to the tool. A Coin node. Metres, scene frame.
class ToolView {
 public:
  /// radius: of the sphere, m.
  explicit ToolView(double radius);
  ~ToolView();
  ToolView(const ToolView&) = delete;
  ToolView& operator=(const ToolView&) = delete;

  SoSeparator* node() const { return node_; }
  /// Nothing is drawn of a tool that is not finite.
  void setTool(const Eigen::Vector3d& tool);
  /// arrow: from the tool to the tip, m; one shorter than the sphere is not drawn.
  void setArrow(const Eigen::Vector3d& arrow);
  /// Where the material point in contact lies at rest; only while something is touched.
  void setAnchor(const Eigen::Vector3d& anchor, bool touching);

 private:
  void drawThread() const;

  double radius_;
  Eigen::Vector3d tool_ = Eigen::Vector3d::Zero(), anchor_ = Eigen::Vector3d::Zero();
  SoSeparator* node_;
  SoTransform *tool_place_, *arrow_place_, *shaft_place_, *head_place_, *anchor_place_;
  Drawing thread_;
  SoSwitch *tool_switch_, *arrow_switch_, *anchor_switch_;
};

}  // namespace palpate
