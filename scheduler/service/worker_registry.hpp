#pragma once

#include <chrono>
#include <map>

#include "common/keys/key_pair.hpp"
#include "proto/palpate.pb.h"
#include "scheduler/plan/leases.hpp"
#include "scheduler/state/kept_out.hpp"

namespace palpate {

/// One worker process, from its Hello until it leaves or is lost.
struct Worker {
  using Time = std::chrono::steady_clock::time_point;

  std::string id;               ///< from its Hello, 1 to 64 bytes; kept over reconnections
  std::string peer;             ///< address for messages to it
  wire::Provenance provenance;  ///< as recorded in its results; the host is printable
  std::uint32_t pid = 0;
  std::string kernel_family;
  /// number of jobs that it can accept now; only WorkerRegistry::addCredit() raises it
  std::uint32_t credit = 0;
  Time heard;  ///< time of its last message
  /// The leased transition that its last heartbeat named; none if it is solving none of its leases.
  std::optional<ResultKey> solving;
  /// Time when it was last sent a message because of its silence.
  std::optional<Time> probed;
  /// Since this time it holds leases, but its heartbeats report no solve; none if they report one.
  std::optional<Time> idle_since;
  std::int32_t results = 0;  ///< number of its results recorded in this run
  /// Number of results that it delivered since it joined, or since it was last overdue. Determines
  /// how many targets it may hold (Allotment::limitOf).
  std::uint32_t earned = 0;
  /// Recent mean time between its results, s; 0 before its first result.
  double between_results = 0;
  /// Time when it last delivered a result, or was given work after it had none.
  Time moved{};
  /// Until this time it gets no work, unless it delivers a result before. Set when one of its
  /// leases goes to another worker because it is overdue.
  std::optional<Time> overdue_until;
};

/// Returns true if two programs, given by their buildName, are the same build: they have the same
/// version, and the same commit if both know their commit.
bool isSameBuild(std::string_view a, std::string_view b);

/// The workers that said Hello and neither left nor were lost, by id and by peer. Their leases are
/// in Leases. One thread; references to a worker are valid until it is removed.
class WorkerRegistry {
 public:
  using Time = Worker::Time;
  using Workers = std::map<std::string, Worker>;  ///< by id
  /// Limit on the number of workers; further workers are refused. About ten times the largest
  /// number that one scheduler was seen to keep busy.
  static constexpr std::size_t most_workers = 10000;

  /// `kernel_family` is that of the recorded results, or else the one that the user chose. If it is
  /// empty, the first result decides. `kept_out` holds the workers, machines and keys that may not
  /// join.
  explicit WorkerRegistry(std::string kernel_family, std::vector<KeptOut> kept_out = {})
      : kernel_family_(std::move(kernel_family)), kept_out_(std::move(kept_out)) {}

  /// Kernel family of every result of this build; empty until it is known.
  const std::string& kernelFamily() const { return kernel_family_; }
  /// Sets the kernel family, with the first result.
  void setKernelFamily(const std::string& family) { kernel_family_ = family; }

  /// Returns why this worker may not join, as a clause with the remedy; empty if it may. Workers
  /// need the same protocol, build and kernels, because all must give the same bits.
  std::string objectionTo(const wire::Hello& hello, const std::optional<PublicKey>& key) const;
  /// Returns true if the worker supports the kernels of this build but uses other ones, so that it
  /// must change them before it may join.
  bool wouldChangeKernels(const wire::Hello& hello) const;
  /// Adds a worker to which there is no objection. A known worker loses its credit and its work in
  /// progress. The peer must not belong to another worker.
  Worker& admit(const std::string& peer, const wire::Hello& hello,
                const std::optional<PublicKey>& key, Time now);
  /// Removes a worker. `state` is "left" or "lost", for the tables.
  void remove(const Worker& worker, const char* state, Time now);

  /// Returns the worker of this peer, or null.
  Worker* ofPeer(const std::string& peer);
  /// Returns the worker with this id, or null.
  Worker* find(const std::string& id);
  /// Raises the number of jobs that a worker can take, up to most_credit. The limit prevents a
  /// worker from hoarding jobs.
  void addCredit(Worker& worker, std::uint64_t jobs);
  static constexpr std::uint32_t most_credit = 64;
  /// Calls visit(worker) for each worker with credit, in the order of ids, until `visit` returns
  /// false. The cost grows with the number of these workers, not of all workers.
  template <class Visit>
  void eachAsking(Visit visit) {
    for (auto entry = asking_.begin(); entry != asking_.end();) {
      if (entry->second->credit == 0) {
        entry = asking_.erase(entry);
        continue;
      }
      if (!visit(*entry->second)) return;
      ++entry;
    }
  }
  bool someoneAsks();
  Workers& all() { return workers_; }
  const Workers& all() const { return workers_; }

  /// Returns the rows of the present workers for the table of servers, with full ids. A worker that
  /// holds some of `leases` is busy.
  std::vector<wire::WorkerStatus> rows(const Leases& leases, Time now) const;
  /// Returns the rows of the workers that left since the last call. Limits the rows of workers
  /// without a result to the number that the table keeps.
  std::vector<wire::WorkerStatus> takeDeparted() { return std::exchange(departed_, {}); }

 private:
  std::string kernel_family_;
  std::vector<KeptOut> kept_out_;
  Workers workers_;
  std::map<std::string, std::string> id_of_peer_;
  /// workers that may have credit; eachAsking() removes others
  std::map<std::string, Worker*> asking_;
  std::vector<wire::WorkerStatus> departed_;
};

}  // namespace palpate
