#pragma once

#include <string>

#include "viewer/haptics/live_touch.hpp"

namespace palpate {

/// The arguments of palpate_live_start. Pointers may be NULL as in palpate_live_options.
struct LiveRequest {
  const char* scene;
  bool unsolved;  ///< whether no dataset is given
  const char *worker, *follower, *keys;
};

/// A live solver for libpalpate. Its code is in a module that libpalpate loads when it is needed,
/// so that simulators without live solving load neither ZeroMQ nor Protobuf, which they may use in
/// other versions. Any thread.
class LiveService {
 public:
  virtual ~LiveService() = default;  ///< ends the live solver
  /// Returns the file of the UnsolvedDataset, which exists as long as this object; "" if a dataset
  /// was given.
  virtual std::string unsolved() const = 0;
  virtual ContentId build() const = 0;  ///< problemId of the scene
  /// Starts the live solver for `touch`, which must outlive this object, and waits until it is
  /// ready. Call once. Throws std::runtime_error if the live solver has trouble.
  virtual void start(LiveTouch& touch) = 0;
  virtual std::string trouble() const = 0;  ///< as LiveLink::trouble(); after start()
  virtual LiveStatistics statistics() const = 0;
};

/// Entry of the module. Reads the scene. Throws the errors of loadProblem() and UnsolvedDataset,
/// and std::runtime_error if there is no worker. The caller owns the result.
using OpenLiveService = LiveService*(const LiveRequest& request);
constexpr const char* live_service_entry = "openLiveService";

}  // namespace palpate
