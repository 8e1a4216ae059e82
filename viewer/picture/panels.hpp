#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "viewer/haptics/haptic_state.hpp"
#include "viewer/picture/force_history.hpp"
#include "viewer/picture/guard_lamps.hpp"
#include "viewer/picture/lattice_dots.hpp"
#include "viewer/picture/picture_requests.hpp"
#include "viewer/picture/picture_status.hpp"
#include "viewer/picture/stage.hpp"

struct GLFWwindow;

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
  std::string text;
};

/// What the panels show in one picture. Everything is borrowed for the call.
struct PanelContents {
  const HapticState& state;
  const PictureStatus& status;
  const ForceHistory& history;
  const GuardLamps& lamps;
  const OrbitCamera& camera;
  const std::vector<int>& keys;      ///< Window::keys()
  std::vector<std::string> models;   ///< names, the datasets to choose from
  std::vector<std::string> methods;  ///< of the model in use
  std::vector<std::string> spaces;   ///< names of the active nodes of the model in use
  double full_colour = 0.01;         ///< m, end of the colours of the surface
  double lattice_radius = 0.1;       ///< m
  std::optional<ErrorScale> errors;  ///< of the lattice, when it is shown by error
  std::string lattice_name;          ///< of the space that is shown
  std::vector<ViewLabel> labels;
};

/// The panels beside and over the view (Dear ImGui), keys and buttons. Belongs to the thread of the
/// Window, must go before it.
class Panels {
 public:
  explicit Panels(GLFWwindow* window);
  ~Panels();
  Panels(const Panels&) = delete;
  Panels& operator=(const Panels&) = delete;

  /// Begins a picture: input is up to date afterwards.
  void begin();
  /// The part of the window that panels leave free, pixels. After begin().
  Viewport view() const;
  /// Lays the panels out. Changes `choices` and adds to `requests` as the person asks.
  void build(const PanelContents& contents, ViewChoices& choices, PictureRequests& requests);
  /// Draws what build() laid out; again after that, the same.
  void render();
};

}  // namespace palpate
