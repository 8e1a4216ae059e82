#pragma once

#include "common/base/error.hpp"
#include "common/wire/bundle.hpp"
#include "common/wire/curve.hpp"
#include "worker/elements/kernel_family.hpp"
#include "worker/link/worker_session.hpp"

namespace palpate {

/// 16 random bytes.
std::string randomWorkerId();

struct LinkOptions {
  /// Of the scheduler, as checkEndpoint() wants it.
  std::string endpoint = default_endpoint;
  std::optional<KeyFolder> keys;  ///< nothing: the scheduler asks for none
  double give_up_s = SessionOptions().give_up_s;
  double drain_s = SessionOptions().drain_s;  ///< counted from SIGTERM
  double leave_idle_s = 0;                    ///< as SessionOptions has it
  std::string worker_id = randomWorkerId();
  std::vector<std::string> ended;  ///< as SessionOptions has it
};

/// The network thread of a worker process: the socket and the clock around a WorkerSession.
class SchedulerLink {
 public:
  /// The references must outlive this object.
  SchedulerLink(zmq::context_t& context, Mailbox& mailbox, const ElementKernels& kernels,
                LinkOptions options);

  /// Serves until there is no more work (done), or SIGINT or SIGTERM came and what was in work was
  /// delivered or handed back (interrupted), within LinkOptions::drain_s whatever the solver does.
  /// Error when the scheduler refuses this worker or says nothing for LinkOptions::give_up_s, when
  /// the solver thread gave up. A solve that hangs ends the process (SIGKILL).
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
  const ElementKernels& kernels_;
  const LinkOptions options_;
  zmq::socket_t socket_;
  Inbox inbox_;
  Bundler outbox_;
  std::optional<HandshakeWatch> handshakes_;  ///< behind the socket: it goes first
  std::string told_;                          ///< of what keeps it from the scheduler
  std::string wanted_kernels_;
};

}  // namespace palpate
