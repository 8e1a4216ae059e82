#pragma once

#include <memory>
#include <vector>

#include "viewer/haptics/haptic_model.hpp"
#include "viewer/haptics/haptic_tick.hpp"
#include "viewer/picture/image.hpp"
#include "viewer/picture/picture_requests.hpp"
#include "viewer/picture/picture_status.hpp"

namespace palpate {

struct PictureOptions {
  int width = 1280, height = 800;  ///< of the window, at a scale of 1 (screenScale)
  bool visible = true;             ///< false: drawn all the same, for grab()
  bool vsync = true;               ///< draw() waits for the screen; without one it returns at once
  bool ghost = true;               ///< begin with the shape at rest drawn
  bool lattice = false;            ///< begin with the lattice drawn
};

/// A window that shows a hand on a soft body: the deformed surface, tool and force; what is known
/// of the configuration space; numbers, plots and controls beside it (H lists keys and mouse).
///
/// Threads: made, used and destroyed in the main thread of the process, one at a time (GLFW,
/// OpenGL). It only reads the models and the states it is given; nothing else waits for it.
class Picture {
 public:
  /// models: at least one, as HapticTick has them; must outlive this object. Error when there is no
  /// display, or no OpenGL, with what to do.
  explicit Picture(const std::vector<const HapticModel*>& models,
                   const PictureOptions& options = {});
  ~Picture();
  Picture(const Picture&) = delete;
  Picture& operator=(const Picture&) = delete;

  /// The window was closed by the person or the system. It stays until this object goes.
  bool wantsClose() const;
  /// One picture: takes in events, draws, shows it.
  PictureRequests draw(const HapticState& state, const PictureStatus& status);
  /// The pixels of the last picture, drawn once more for it; there must be one.
  Image grab();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate
