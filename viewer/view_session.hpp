#pragma once

#include <iosfwd>
#include <memory>

#include "common/base/error.hpp"
#include "common/base/program.hpp"
#include "viewer/view_options.hpp"

namespace palpate {

/// One run of the haptic client: datasets, a device, the haptic loop, a picture, a recording. The
/// thread that makes it is the one that draws.
class ViewSession {
 public:
  /// Loads the datasets, opens the window and then the device. Errors of each name what could not
  /// be had.
  explicit ViewSession(const ViewOptions& options);
  ~ViewSession();

  /// Until the window is closed, the duration is over, a replay has ended, or a signal came. The
  /// device is given zero, recording and picture are written, and what the loop measured goes to
  /// `output`.
  ExitCode run(std::ostream& output);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace palpate
