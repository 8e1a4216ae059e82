#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>

#include "viewer/haptics/haptic_model.hpp"
#include "viewer/picture/soft_light.hpp"
#include "viewer/picture/turned_solid.hpp"

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

struct ToolPose {
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();       ///< m, the point that touches
  Eigen::Vector3d outward = Eigen::Vector3d::UnitZ();  ///< unit, away from the body
  Eigen::Vector3d handle = Eigen::Vector3d::UnitZ();   ///< unit, from the tip toward the hand
};

/// The place of the skin that is nearest to a free tool.
struct SkinBelow {
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< m
  double gap = 0;                                   ///< distance of the tool from this place, m
};

/// A tool to draw, with its force and its contact. Metres, scene frame.
struct ShownTool {
  double extent = 0.1;  ///< radius of the scene, for parts that have no true size
  ToolShape shape;
  bool holds = false;  ///< the second finger, which has another shade
  ToolPose pose;       ///< not drawn if its tip is not finite
  /// Vector from the tip of the tool to the tip of the arrow. A very short arrow is not drawn.
  Eigen::Vector3d arrow = Eigen::Vector3d::Zero();
  bool uncertain = false;                 ///< whether the force that the arrow shows is uncertain
  std::optional<Eigen::Vector3d> anchor;  ///< rest position of the material point in contact
  std::optional<Eigen::Vector3d> skin;    ///< the place of the skin below a free tool
  bool see_through = false;               ///< draw the tool translucent, so that objects behind it
                                          ///< are visible

  /// Returns the middle of the tip, and the end of the handle.
  std::array<Eigen::Vector3d, 2> axis() const;
  // Sizes as they are drawn, m.
  double radius() const;  ///< of the tip
  double handleRadius() const;
};

/// Draws the tool in its true size, and the force on it as an arrow. For a free tool also draws a
/// line to the skin. In contact also draws the rest position of the touched point, with a line to
/// it.
///
/// Parts of the tool behind the surface show through it. The arrow is in front of everything. It is
/// dashed and amber if its force is uncertain. Changes OpenGL's state, and requires its default
/// state when it is called (Stage).
class ToolView {
 public:
  void draw(const ShownTool& tool, const SoftLight& light) const;

 private:
  void drawTool(const ShownTool& tool, const SoftLight& light, double opacity) const;
  void drawTranslucent(const ShownTool& tool, const SoftLight& light, double opacity) const;
  void drawArrow(const ShownTool& tool, const SoftLight& light) const;
  void drawAnchor(const ShownTool& tool, const SoftLight& light) const;
  static void drawSkinLine(const ShownTool& tool);

  TurnedSolid ball_ = TurnedSolid::ball(), cylinder_ = TurnedSolid::cylinder(16),
              cone_ = TurnedSolid::cone(), handle_ = TurnedSolid::handle(),
              finger_ = TurnedSolid::finger(), disc_ = TurnedSolid::cylinder(28);
};

}  // namespace palpate
