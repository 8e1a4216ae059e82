#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

namespace palpate {

/// What the person at the picture asked for since the last one.
struct PictureRequests {
  struct Use {
    std::int32_t model = 0, method = 0;
  };
  std::optional<Use> use;  ///< another dataset or method
  bool release = false;    ///< let go
  bool pause = false;      ///< stop, or go on: pressed once
  bool reload = false;     ///< read the datasets again
  bool quit = false;       ///< pressed the key for it; closing the window shows in wantsClose()
  /// m, scene frame: where the mouse has the tool, while Ctrl is held.
  std::optional<Eigen::Vector3d> mouse_target;
};

}  // namespace palpate
