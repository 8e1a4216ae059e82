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
  bool errors = false;  ///< colour the lattice by error bounds, otherwise by tags
  bool beside = false;  ///< show another dataset beside the touched one
  bool cut = false;     ///< show only one plane of the lattice
  LatticeCut plane;
};

/// The number next to a force arrow. Metres, scene frame.
struct ViewLabel {
  Eigen::Vector3d from = Eigen::Vector3d::Zero(), at = Eigen::Vector3d::Zero();  ///< tail and tip
                                                                                 ///< of the arrow
  /// Tip and handle of the tool, which the label must not cover either.
  std::array<Eigen::Vector3d, 2> tool = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  double tip_radius = 0, handle_radius = 0;
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
  std::string dataset, tissue;  ///< name and material of the other dataset
  ViewLabel label = {};         ///< at the arrow of the other dataset
  double force = 0;             ///< force of its tissue, N
  std::string sentence = {};  ///< reason why that dataset cannot repeat the touch; empty if it can
  /// Reason why the other body does not show the chosen colours; empty if it does.
  std::string colourless = {};
};

/// Contents of the legend for pressures.
struct PressureContents {
  double full = 0;            ///< end of the scale, Pa; 0 if neither body shows pressures
  bool everywhere = true;     ///< every part of the body has a pressure
  std::string sentence = {};  ///< reason why there are no pressures; empty if there are any
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
  const std::vector<int>& keys;          ///< Window::keys()
  std::vector<Choice> models = {};       ///< the datasets
  std::vector<Choice> methods = {};      ///< methods of the model in use
  std::vector<std::string> spaces = {};  ///< names of the active nodes of the model in use
  std::string dataset, tissue;           ///< name and material of the model in use
  Eigen::Vector3d middle = {0, 0, 0};    ///< middle of the body, m; the scale bar is valid at its
                                         ///< depth
  double full_colour = 0.01;             ///< end of the displacement scale, m
  PressureContents pressure = {};
  bool untouchable = false;     ///< some parts are not touchable
  double lattice_radius = 0.1;  ///< m
  std::string lattice_name;     ///< name of the space that the lattice shows
  ViewLabel label = {};         ///< at the force arrow
  HandMarks hand = {};
  std::optional<BesideContents> beside = {};
};

}  // namespace palpate
