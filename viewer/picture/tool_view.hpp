#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "viewer/picture/soft_light.hpp"
#include "viewer/picture/tool_shape.hpp"
#include "viewer/picture/turned_solid.hpp"

namespace palpate {

/// How a tool is held: where it touches, and from where.
struct ToolPose {
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();       ///< m, where it touches or would
  Eigen::Vector3d outward = Eigen::Vector3d::UnitZ();  ///< unit, away from the body
  Eigen::Vector3d handle = Eigen::Vector3d::UnitZ();   ///< unit, from the tip to the hand
};

/// The nearest skin below a free tool.
struct SkinBelow {
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< m
  double gap = 0;                                   ///< m
};

/// What is seen of a hand. Metres, scene frame.
struct ShownTool {
  double extent = 0.1;  ///< radius of what is shown: of what has no size of its own
  ToolShape shape;
  ToolPose pose;  ///< nothing is drawn where its tip is not finite
  /// From the tip of the tool to its own; one that is very short is not drawn.
  Eigen::Vector3d arrow = Eigen::Vector3d::Zero();
  bool uncertain = false;                 ///< the force of the arrow is
  std::optional<Eigen::Vector3d> anchor;  ///< where the material point in contact lies at rest
  std::optional<Eigen::Vector3d> skin;    ///< below a free tool
  bool see_through = false;               ///< so that what is shown around it is seen

  /// The middle of the tip, and the end of the handle.
  std::array<Eigen::Vector3d, 2> axis() const;
  // As they are drawn.
  double radius() const;  ///< of the tip
  double handleRadius() const;
};

/// Draws the tool in its true size, the force on it as an arrow, a line to the skin while it is
/// free, and where the point that it touches lies at rest, with a line to it. What of the tool lies
/// behind the surface is seen through it. The arrow is in front of everything, dashed and amber
/// where its force is uncertain. Changes OpenGL's state, and begins with its default (Stage).
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
