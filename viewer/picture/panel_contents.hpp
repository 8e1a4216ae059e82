#pragma once

#include <Eigen/Core>
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

namespace palpate {

/// What the person chose to see.
struct ViewChoices {
  bool ghost = true, lattice = false, help = false;
  bool errors = false;  ///< the lattice by the error bound; else by tag
  bool cut = false;     ///< only a plane of the lattice
  LatticeCut plane;
};

/// A word or number in the view, beside a point of the scene.
struct ViewLabel {
  Eigen::Vector3d at = Eigen::Vector3d::Zero();  ///< m
  std::string text;                              ///< empty: none
};

/// What of a hand without a device lies over the view.
struct HandMarks {
  /// Around the place that is pointed at, a circle of `ring_radius` metres; none: none.
  std::optional<PointedPlace> ring = {};
  double ring_radius = 0;
  std::string hint = {};                       ///< a sentence; empty: none
  std::optional<Eigen::Vector2d> cursor = {};  ///< of the tutorial's mouse, heights of the view
  bool button = false;                         ///< of it, is held
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
  double full_colour = 0.01;             ///< m, end of the colours of the surface
  double lattice_radius = 0.1;           ///< m
  std::string lattice_name;              ///< of the space that is shown
  ViewLabel label;                       ///< of the arrow
  HandMarks hand = {};
};

}  // namespace palpate
