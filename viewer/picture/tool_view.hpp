#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "viewer/picture/soft_light.hpp"
#include "viewer/picture/tool_shape.hpp"
#include "viewer/picture/turned_solid.hpp"

namespace palpate {

/// Pose of a tool.
struct ToolPose {
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();       ///< m, the point that touches
  Eigen::Vector3d outward = Eigen::Vector3d::UnitZ();  ///< unit, away from the body
  Eigen::Vector3d handle = Eigen::Vector3d::UnitZ();   ///< unit, from the tip to the hand
};

/// The nearest skin below a free tool.
struct SkinBelow {
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< m
  double gap = 0;                                   ///< m
};

/// Visible parts of a hand. Metres, scene frame.
struct ShownTool {
  double extent = 0.1;  ///< radius of the scene; scales parts without a true size
  ToolShape shape;
  ToolPose pose;  ///< not drawn if its tip is not finite
  /// From the tip of the tool to the tip of the arrow; a very short one is not drawn.
  Eigen::Vector3d arrow = Eigen::Vector3d::Zero();
  bool uncertain = false;                 ///< the arrow's force is uncertain
  std::optional<Eigen::Vector3d> anchor;  ///< rest position of the material point in contact
  std::optional<Eigen::Vector3d> skin;    ///< below a free tool
  bool see_through = false;               ///< translucent, to show objects around it

  /// Returns the middle of the tip and the end of the handle.
  std::array<Eigen::Vector3d, 2> axis() const;
  // As drawn.
  double radius() const;  ///< of the tip
  double handleRadius() const;
};

/// Draws the tool in its true size and the force on it as an arrow. Also draws a line to the skin
/// while the tool is free, and the rest position of the touched point with a line to it.
///
/// Parts of the tool behind the surface show through it. The arrow is in front of everything, and
/// is dashed and amber if its force is uncertain. Changes OpenGL's state and requires its default
/// (Stage).
class ToolView {
 public:
  void draw(const ShownTool& tool, const SoftLight& light) const;

 private:
  void drawTool(const ShownTool& tool, const SoftLight& light, double opacity) const;
  void drawTranslucent(const ShownTool& tool, const SoftLight& light, double opacity) const;
  void drawArrow(const ShownTool& tool, const SoftLight& light) const;
  void drawAnchor(const ShownTool& tool, const SoftLight& light) const;
  static void drawSkinLine(const ShownTool& tool);

  TurnedSolid ball_ = TurnedSolid::ball(), cylinder_ = TurnedSolid::cylinder(),
              cone_ = TurnedSolid::cone(), handle_ = TurnedSolid::handle(),
              finger_ = TurnedSolid::finger(), disc_ = TurnedSolid::disc();
};

}  // namespace palpate
