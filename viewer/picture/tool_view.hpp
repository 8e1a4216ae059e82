#pragma once

#include <Eigen/Core>
#include <array>

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

/// Draws the tool in its true size, the force on it as an arrow, a line to the skin while it is
/// free, and where the point that it touches lies at rest, with a line to it. What of the tool lies
/// behind the surface is seen through it. The arrow is in front of everything, dashed and amber
/// where its force is uncertain. Metres, scene frame.
class ToolView {
 public:
  /// extent: radius of what is shown, m: of what has no size of its own. light: must outlive it.
  ToolView(double extent, const SoftLight& light);

  void setShape(const ToolShape& shape) { shape_ = shape; }
  /// So that what is shown around it is seen.
  void setSeeThrough(bool see_through) { see_through_ = see_through; }
  /// Nothing is drawn of a tool that is not finite.
  void setTool(const ToolPose& pose) { pose_ = pose; }
  /// arrow: from the tip of the tool to its own, m; one that is very short is not drawn.
  void setArrow(const Eigen::Vector3d& arrow, bool uncertain);
  /// Where the material point in contact lies at rest; only while something is touched.
  void setAnchor(const Eigen::Vector3d& anchor, bool touching);
  /// Only while nothing is touched.
  void setSkin(const SkinBelow& skin, bool free);

  /// The middle of the tip, and the end of the handle.
  std::array<Eigen::Vector3d, 2> axis() const;
  // m, as they are drawn.
  double radius() const;  ///< of the tip
  double handleRadius() const;

  /// Changes OpenGL's state, and begins with its default (Stage).
  void draw() const;

 private:
  void drawTool(double opacity) const;
  void drawTranslucent(double opacity) const;
  void drawArrow() const;
  void drawAnchor() const;
  void drawSkinLine() const;

  double extent_;
  const SoftLight& light_;
  TurnedSolid ball_ = TurnedSolid::ball(), cylinder_ = TurnedSolid::cylinder(),
              cone_ = TurnedSolid::cone(), handle_ = TurnedSolid::handle(),
              finger_ = TurnedSolid::finger(), disc_ = TurnedSolid::disc();
  ToolShape shape_;
  ToolPose pose_;
  Eigen::Vector3d arrow_ = Eigen::Vector3d::Zero(), anchor_ = Eigen::Vector3d::Zero();
  SkinBelow skin_;
  bool uncertain_ = false, touching_ = false, free_ = false, see_through_ = false;
};

}  // namespace palpate
