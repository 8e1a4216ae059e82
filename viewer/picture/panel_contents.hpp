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

/// What the person chose to see.
struct ViewChoices {
  bool ghost = true, lattice = false, help = false;
  SurfaceColour colour = SurfaceColour::displacement;
  bool errors = false;  ///< the lattice by the error bound; else by tag
  bool beside = false;  ///< another dataset beside the one that is touched
  bool cut = false;     ///< only a plane of the lattice
  LatticeCut plane;
};

/// The number at an arrow. Metres, scene frame.
struct ViewLabel {
  Eigen::Vector3d from = Eigen::Vector3d::Zero(), at = Eigen::Vector3d::Zero();  ///< the arrow
  /// What it must not cover beside the arrow: the tip of the tool, and its handle from there.
  std::array<Eigen::Vector3d, 2> tool = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  double tip_radius = 0, handle_radius = 0;
  std::string text;        ///< empty: none
  bool uncertain = false;  ///< the arrow is amber, and says why
};

/// What of a hand without a device lies over the view.
struct HandMarks {
  /// Around the place that is pointed at, a circle of `ring_radius` metres; none: none.
  std::optional<PointedPlace> ring = {};
  double ring_radius = 0;
  std::string hint = {};  ///< a sentence; empty: none
};

/// Beside the touched body another dataset in the same touch.
struct BesideContents {
  std::string dataset, tissue;  ///< its name and material
  ViewLabel label = {};         ///< of its arrow
  double force = 0;             ///< N, of its tissue
  std::string sentence = {};    ///< why there is no such touch; empty: there is
  /// Why it has not the colours that are shown; empty: it has.
  std::string colourless = {};
};

/// What is to be said where the colours show pressures.
struct PressureContents {
  double full = 0;            ///< Pa, end of the colours; 0: there are none, beside it neither
  bool everywhere = true;     ///< every part of the body has one
  std::string sentence = {};  ///< why there are none; empty: there are
};

/// A dataset or method that can be switched to.
struct Choice {
  std::string name;
  double prepared = 1;  ///< share of the preparation that is done; it can be chosen at 1
};

/// What the panels show in one picture. Everything is borrowed for the call.
struct PanelContents {
  const HapticState& state;
  const PictureStatus& status;
  const ForceHistory& history;
  const GuardLamps& lamps;
  const OrbitCamera& camera;
  const std::vector<int>& keys;          ///< Window::keys()
  std::vector<Choice> models = {};       ///< the datasets
  std::vector<Choice> methods = {};      ///< of the model in use
  std::vector<std::string> spaces = {};  ///< names of the active nodes of the model in use
  std::string dataset, tissue;           ///< name and material of the model in use
  Eigen::Vector3d middle = {0, 0, 0};    ///< m, of the body: where the scale bar measures
  double full_colour = 0.01;             ///< m, end of the colours of the surface
  PressureContents pressure = {};
  bool untouchable = false;     ///< there are parts with nothing to feel
  double lattice_radius = 0.1;  ///< m
  std::string lattice_name;     ///< of the space that is shown
  ViewLabel label = {};         ///< of the arrow
  HandMarks hand = {};
  std::optional<BesideContents> beside = {};
};

}  // namespace palpate
