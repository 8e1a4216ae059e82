#pragma once

#include "common/base/error.hpp"
#include "common/wire/bundle.hpp"
#include "common/wire/curve.hpp"
#include "worker/link/worker_session.hpp"

namespace palpate {

/// The network thread of a worker process: the socket and the clock around a WorkerSession.
class SchedulerLink {
 public:
  /// The references must outlive this object. Without `keys` the scheduler asks for none.
  SchedulerLink(zmq::context_t& context, Mailbox& mailbox, SessionOptions options,
                std::optional<KeyFolder> keys);

  /// Serves until there is no more work (done), or SIGINT or SIGTERM came and what was in work was
  /// delivered or handed back (interrupted), within SessionOptions::drain_s whatever the solver
  /// does. Error when the scheduler refuses this worker or says nothing for
  /// SessionOptions::give_up_s, when the solver thread gave up. A solve that hangs ends the process
  /// (SIGKILL).
  ExitCode run();
  /// run() ended because the scheduler wants this worker with these kernels (beginAnewWith); empty
  /// otherwise.
  const std::string& wantedKernels() const { return wanted_kernels_; }

 private:
  void connect();
  void send();
  void tellTrouble(std::string trouble);

  zmq::context_t& context_;
  Mailbox& mailbox_;
  const SessionOptions options_;
  const std::optional<KeyFolder> keys_;
  zmq::socket_t socket_;
  Inbox inbox_;
  Bundler outbox_;
  std::optional<HandshakeWatch> handshakes_;  ///< behind the socket: it goes first
  std::string told_;                          ///< of what keeps it from the scheduler
  std::string wanted_kernels_;
};

}  // namespace palpate
