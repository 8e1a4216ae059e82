#pragma once

#include "common/base/error.hpp"
#include "common/wire/curve.hpp"
#include "worker/link/worker_session.hpp"

namespace palpate {

/// Runs the network thread of a worker process: owns the socket, and passes messages and the time
/// to a WorkerSession.
class SchedulerLink {
 public:
  /// The references must outlive this object. `keys` is empty if the scheduler requires no keys.
  SchedulerLink(zmq::context_t& context, Mailbox& mailbox, SessionOptions options,
                std::optional<KeyFolder> keys);

  /// Runs until there is no more work (returns done), or until SIGINT or SIGTERM (returns
  /// interrupted).
  ///
  /// After a signal, the work in progress is delivered or handed back within
  /// SessionOptions::drain_s, even if the solver does not react. Error if the scheduler refuses
  /// this worker or is silent for SessionOptions::give_up_s, or if the solver thread failed. A hung
  /// solve ends the process (SIGKILL).
  ExitCode run();
  /// If run() ended because the scheduler wants this worker to use other kernels, returns these
  /// kernels (for beginAnewWith). Otherwise empty.
  const std::string& wantedKernels() const { return wanted_kernels_; }

 private:
  void connect();
  void tellTrouble(std::string trouble);

  zmq::context_t& context_;
  Mailbox& mailbox_;
  const SessionOptions options_;
  const std::optional<KeyFolder> keys_;
  zmq::socket_t socket_;
  Inbox inbox_;
  std::optional<HandshakeWatch> handshakes_;  ///< after socket_, so that it is destroyed first
  std::string told_;                          ///< reason that tellTrouble() logged last
  std::string wanted_kernels_;
};

}  // namespace palpate
