#pragma once

#include <memory>
#include <vector>

#include "viewer/haptics/haptic_model.hpp"
#include "viewer/haptics/haptic_tick.hpp"
#include "viewer/picture/image.hpp"
#include "viewer/picture/picture_status.hpp"

namespace palpate {

struct PictureOptions {
  int width = 1280, height = 800;  ///< of the window, at scale 1 (screenScale)
  bool visible = true;             ///< false: hidden, but drawn for grab()
  bool vsync = true;               ///< draw() waits for the screen, if there is a screen
  bool ghost = true;               ///< show the ghost at the start
  bool lattice = false;            ///< show the lattice at the start
};

/// A window that shows a hand on a soft body: the deformed surface, the tool, the force and the
/// configuration space. Panels beside it show numbers, plots and controls (H lists keys and mouse).
///
/// Threads: create, use and destroy it in the main thread of the process, and only one at a time
/// (GLFW, OpenGL). It only reads the models and states that it is given, and no other thread waits
/// for it.
class Picture {
 public:
  /// models: at least one, in the same order as for HapticTick; they must outlive this object. If
  /// there is no display or no OpenGL, throws an Error that says what to do.
  explicit Picture(const std::vector<const HapticModel*>& models,
                   const PictureOptions& options = {});
  ~Picture();

  /// Replaces the models by as many others, in the same order. Keeps the view of a single dataset.
  void replace(const std::vector<const HapticModel*>& models);

  /// Returns whether the user or the system closed the window. The window stays visible until this
  /// object is destroyed.
  bool wantsClose() const;
  /// Processes events, draws one frame and shows it. Returns what the user requested.
  PictureRequests draw(const HapticState& state, const PictureStatus& status);
  /// Draws the last frame again and returns its pixels. Call it only after draw().
  Image grab();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate
