#pragma once

#include <chrono>
#include <deque>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <zmq.hpp>

#include "common/wire/wire.hpp"
#include "worker/elements/kernel_family.hpp"
#include "worker/link/mailbox.hpp"

namespace palpate {

struct LinkOptions {
  std::string endpoint;
  /// Jobs asked for in advance: the one in work and one that hides the network.
  std::uint32_t credit = 2;
  /// Without any word from the scheduler for this long, the socket is made anew; after `give_up`,
  /// the worker ends.
  std::chrono::milliseconds reconnect_after{20000};
  std::chrono::milliseconds give_up{15 * 60 * 1000};
  /// On SIGTERM: how long to wait until the target in work is done and acknowledged.
  std::chrono::milliseconds drain{10000};
};

/// Why run() came back.
enum class LinkEnd : std::uint8_t {
  finished,     ///< the scheduler has no more work
  interrupted,  ///< SIGINT or SIGTERM; what was in work was delivered or handed back
  given_up,     ///< no word from the scheduler for LinkOptions::give_up
};

/// A worker's side of the protocol (docs/wire.md): says hello, asks for work, fetches start
/// configurations, delivers results and keeps each until it is acknowledged. Whatever happens to
/// the scheduler, it asks again and delivers again.
///
/// run() is the network thread; it owns the socket. The solver thread is on the other side of the
/// mailbox.
class SchedulerLink {
 public:
  SchedulerLink(zmq::context_t& context, Mailbox& mailbox, const ElementKernels& kernels,
                LinkOptions options);

  /// Serves until there is no more work. Error when the scheduler refuses this worker or the solver
  /// thread gave up.
  LinkEnd run();

 private:
  using Clock = std::chrono::steady_clock;
  /// (space, target, parent): the key of a result.
  using ResultKey = std::tuple<std::uint32_t, LatticePoint, LatticePoint>;

  void connect();
  void sayHello();
  void send(const wire::Message& message, std::string_view payload = {});
  void requestJobs(std::uint32_t credit);
  void handle(const Incoming& incoming);
  void handleWelcome(const wire::Welcome& welcome);
  void handleProblem(const wire::ProblemReply& reply, const std::string& payload);
  void handleJob(const wire::Job& job);
  void handleFields(const wire::FieldsReply& reply, const std::string& payload);
  void deliverFinished();
  void deliverAgain();
  void introduceAgain();
  void beat();
  void forgetWork();
  void startReadyJobs();
  std::shared_ptr<const NodalFields> cached(const ContentId& id);
  void remember(const ContentId& id, std::shared_ptr<const NodalFields> fields);

  zmq::context_t& context_;
  Mailbox& mailbox_;
  const ElementKernels& kernels_;
  const LinkOptions options_;
  const std::string worker_id_;  ///< 16 random bytes
  zmq::socket_t socket_;

  std::string incarnation_;  ///< of the scheduler; empty before Welcome
  ContentId build_;
  std::shared_ptr<const Problem> problem_;
  std::chrono::milliseconds heartbeat_{1000};
  Clock::time_point last_heard_, last_sent_hello_, last_beat_, last_connected_, last_delivered_;
  bool draining_ = false;  ///< no more jobs are asked for
  bool finished_ = false;  ///< Drain said the build is complete

  std::deque<wire::Job> waiting_;  ///< jobs whose start configuration is not here yet
  std::map<ResultKey, FinishedTarget> unacknowledged_;

  /// Least recently used last.
  std::list<std::pair<ContentId, std::shared_ptr<const NodalFields>>> cache_;
  std::size_t cache_bytes_ = 0;
};

}  // namespace palpate
