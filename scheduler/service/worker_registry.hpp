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

  std::string id;                ///< of its Hello, 1 to 64 bytes: the same over reconnections
  std::string peer;              ///< where messages to it go
  wire::Provenance provenance;   ///< as results tell who gave them
  std::optional<PublicKey> key;  ///< under which it said Hello
  std::string host;              ///< printable, as is its family: people see them
  std::uint32_t pid = 0;
  std::string kernel_family;
  std::uint32_t credit = 0;  ///< jobs it can take now; grows by WorkerRegistry::addCredit() only
  Time heard;                ///< when its last message came
  /// As its last heartbeat said; nothing when it solves none of what it was given.
  std::optional<ResultKey> solving;
  /// When it was last asked for a sign of life, because it was silent.
  std::optional<Time> probed;
  /// Since when its heartbeats say that it solves nothing, although it holds leases.
  std::optional<Time> idle_since;
  std::int32_t results = 0;  ///< recorded ones, of this run
  /// Results since it came, or since others had to be given what it held: as many it may hold.
  std::uint32_t earned = 0;
  /// s, between its results, as it was lately; 0 before the first.
  double between_results = 0;
  /// It was given work when it had none, or delivered some.
  Time moved{};
  /// It held what others had to be given, and gets nothing before then, or before it delivers.
  std::optional<Time> overdue_until;
};

/// A worker's id as people see it.
std::string hexOfId(std::string_view id);

/// Whether two programs are of one build, as they name it (buildName): of one version, and of one
/// commit where both know theirs.
bool isSameBuild(std::string_view a, std::string_view b);

/// Who is there: the workers that said Hello and neither left nor were lost, by id and by peer.
/// What they hold is for Leases to know. One thread; references to workers last until they are
/// removed.
class WorkerRegistry {
 public:
  using Time = Worker::Time;
  using Workers = std::map<std::string, Worker>;  ///< by id
  /// More at once are refused. Some ten times what one scheduler was ever seen to feed.
  static constexpr std::size_t most_workers = 10000;

  /// `kernel_family` of the results that are recorded, or the one that was chosen; empty when there
  /// is neither: then the first result decides. `kept_out`: whom nobody lets in.
  explicit WorkerRegistry(std::string kernel_family, std::vector<KeptOut> kept_out = {})
      : kernel_family_(std::move(kernel_family)), kept_out_(std::move(kept_out)) {}

  /// The kernels that every result of this build is computed with; empty before that is known.
  const std::string& kernelFamily() const { return kernel_family_; }
  /// The first result came from these.
  void setKernelFamily(const std::string& family) { kernel_family_ = family; }

  /// Why this worker may not join, as a clause that says what to do; empty when it may. All workers
  /// must give the same bits: same protocol, build and kernels.
  std::string objectionTo(const wire::Hello& hello, const std::optional<PublicKey>& key) const;
  /// It may join with other kernels, which it has too.
  bool wouldChangeKernels(const wire::Hello& hello) const;
  /// Adds a worker without objection, or begins anew with one that is known: no credit, nothing in
  /// work. The peer must not be that of another worker.
  Worker& admit(const std::string& peer, const wire::Hello& hello,
                const std::optional<PublicKey>& key, Time now);
  /// It is gone: "left" or "lost", as the tables will say.
  void remove(const Worker& worker, const char* state, Time now);

  /// Null when there is none.
  Worker* ofPeer(const std::string& peer);
  /// The first with this process number on any host; null when there is none.
  Worker* ofProcess(std::uint32_t pid);
  /// Null when there is none.
  Worker* find(const std::string& id);
  Worker& at(const std::string& id) { return workers_.at(id); }
  /// It can take `jobs` more, but never more than most_credit: what a worker hoards, others lack.
  void addCredit(Worker& worker, std::uint64_t jobs);
  static constexpr std::uint32_t most_credit = 64;
  /// Calls visit(worker) for those with credit, by id, as long as it returns true. Costs as much as
  /// these are many, not as all are.
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

  /// Rows of the table of servers, with whole ids: who is there now, busy when `leases` says so.
  std::vector<wire::WorkerStatus> rows(const Leases& leases, Time now) const;
  /// Those of who went since the last call; without a result, no more than the table keeps.
  std::vector<wire::WorkerStatus> takeDeparted() { return std::exchange(departed_, {}); }

 private:
  std::string objectionToKernels(const std::string& family) const;

  std::string kernel_family_;
  std::vector<KeptOut> kept_out_;
  Workers workers_;
  std::map<std::string, std::string> id_of_peer_;
  std::map<std::string, Worker*> asking_;  ///< and some that have no credit any more
  std::vector<wire::WorkerStatus> departed_;
};

}  // namespace palpate
