#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "viewer/haptics/haptic_tick.hpp"
#include "viewer/picture/force_history.hpp"
#include "viewer/picture/guard_lamps.hpp"
#include "viewer/picture/lattice_dots.hpp"
#include "viewer/picture/orbit_camera.hpp"
#include "viewer/picture/picture_status.hpp"
#include "viewer/picture/pointed_place.hpp"
#include "viewer/picture/tissue_colours.hpp"

namespace palpate {

/// Display options chosen by the user.
struct ViewChoices {
  bool ghost = true, lattice = false, help = false;
  SurfaceColour colour = SurfaceColour::displacement;
  bool errors = false;  ///< lattice by error bound; otherwise by tag
  bool beside = false;  ///< show another dataset beside the touched one
  bool cut = false;     ///< show only a plane of the lattice
  LatticeCut plane;
};

/// The number at a force arrow. Metres, scene frame.
struct ViewLabel {
  Eigen::Vector3d from = Eigen::Vector3d::Zero(), at = Eigen::Vector3d::Zero();  ///< the arrow
  /// Must also stay uncovered: the tip of the tool, and its handle.
  std::array<Eigen::Vector3d, 2> tool = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  double tip_radius = 0, handle_radius = 0;
  std::string text;        ///< empty: no label
  bool uncertain = false;  ///< the arrow is amber; the text gives the reason
};

/// Marks over the view for a hand without a device.
struct HandMarks {
  /// A circle of `ring_radius` metres around the place under the pointer; empty: none.
  std::optional<PointedPlace> ring = {};
  double ring_radius = 0;
  std::string hint = {};  ///< a sentence; empty: none
};

/// Another dataset in the same touch, shown beside the touched body.
struct BesideContents {
  std::string dataset, tissue;  ///< its name and material
  ViewLabel label = {};         ///< of its arrow
  double force = 0;             ///< of its tissue, N
  std::string sentence = {};    ///< why there is no such touch; empty if there is
  /// Why it lacks the colours that are shown; empty if it has them.
  std::string colourless = {};
};

/// Contents of the pressure legend.
struct PressureContents {
  double full = 0;            ///< end of the scale, Pa; 0: no pressures in either body
  bool everywhere = true;     ///< every part of the body has a pressure
  std::string sentence = {};  ///< why there are none; empty if there are
};

/// A dataset or method to switch to.
struct Choice {
  std::string name;
  double prepared = 1;  ///< share of its preparation; selectable at 1
};

/// Contents of the panels in one picture. References are borrowed for the call.
struct PanelContents {
  const HapticState& state;
  const PictureStatus& status;
  const ForceHistory& history;
  const GuardLamps& lamps;
  const OrbitCamera& camera;
  const std::vector<int>& keys;          ///< Window::keys()
  std::vector<Choice> models = {};       ///< the datasets
  std::vector<Choice> methods = {};      ///< of the model in use
  std::vector<std::string> spaces = {};  ///< active nodes of the model in use
  std::string dataset, tissue;           ///< name and material of the model in use
  Eigen::Vector3d middle = {0, 0, 0};    ///< of the body, m: depth of the scale bar
  double full_colour = 0.01;             ///< end of the displacement scale, m
  PressureContents pressure = {};
  bool untouchable = false;     ///< some parts are not touchable
  double lattice_radius = 0.1;  ///< m
  std::string lattice_name;     ///< of the space that is shown
  ViewLabel label = {};         ///< of the arrow
  HandMarks hand = {};
  std::optional<BesideContents> beside = {};
};

}  // namespace palpate
