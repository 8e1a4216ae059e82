#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "viewer/haptics/haptic_tick.hpp"
#include "viewer/picture/body_view.hpp"
#include "viewer/picture/force_history.hpp"
#include "viewer/picture/guard_lamps.hpp"
#include "viewer/picture/lattice_dots.hpp"
#include "viewer/picture/orbit_camera.hpp"
#include "viewer/picture/picture_status.hpp"
#include "viewer/picture/pointed_place.hpp"
#include "viewer/picture/tool_view.hpp"

namespace palpate {

/// Display options chosen by the user.
struct ViewChoices {
  bool ghost = true, lattice = false, help = false;
  SurfaceColour colour = SurfaceColour::displacement;
  bool errors = false;  ///< colour the lattice by error bounds, otherwise by tags
  bool beside = false;  ///< show another dataset beside the touched one
  bool cut = false;     ///< show only one plane of the lattice
  LatticeCut plane;
};

/// The number next to a force arrow. Metres, scene frame.
struct ViewLabel {
  Eigen::Vector3d from = Eigen::Vector3d::Zero(), at = Eigen::Vector3d::Zero();  ///< tail and tip
                                                                                 ///< of the arrow
  std::string text;        ///< empty: no label
  bool uncertain = false;  ///< the arrow is amber; the text says why
};

/// Marks drawn over the view: a ring at the pointed place (mouse and keys only), and a hint to the
/// user.
struct HandMarks {
  /// Middle of the ring, whose radius is `ring_radius` metres; empty if there is no ring.
  std::optional<PointedPlace> ring = {};
  double ring_radius = 0;
  std::string hint = {};  ///< a sentence; empty if there is no hint
};

/// Contents for another dataset that is shown beside the touched body, in the same touch.
struct BesideContents {
  const BodyView& body;
  ViewLabel label = {};  ///< at the arrow of the other dataset
  /// Force of its tissue, N; NaN if that dataset cannot repeat the touch.
  double force = std::numeric_limits<double>::quiet_NaN();
  /// Reason why that dataset cannot repeat the touch, or why its body does not show the chosen
  /// colours; empty if it does both.
  std::string sentence = {};
};

/// The second finger, which holds the body.
struct HeldContents {
  Touch touch;
  ViewLabel label;  ///< at its force arrow
  const ShownTool& tool;
};

/// A dataset or method that the user can choose.
struct Choice {
  std::string name;
  double prepared = 1;  ///< progress of its preparation; it can be chosen at 1
};

/// Contents of the panels in one frame. The references must be valid only during the call that
/// receives this object.
struct PanelContents {
  const HapticState& state;
  const PictureStatus& status;
  const ForceHistory& history;
  const GuardLamps& lamps;
  const OrbitCamera& camera;
  const std::vector<int>& keys;      ///< Window::keys()
  const BodyView& body;              ///< of the model in use
  const SpaceTable& space;           ///< the space that the lattice shows
  const ShownTool& tool;             ///< the labels must not cover it
  std::vector<Choice> models = {};   ///< the datasets
  std::vector<Choice> methods = {};  ///< methods of the model in use
  ViewLabel label = {};              ///< at the force arrow
  HandMarks hand = {};
  std::optional<BesideContents> beside = {};
  std::optional<HeldContents> held = {};
};

}  // namespace palpate
