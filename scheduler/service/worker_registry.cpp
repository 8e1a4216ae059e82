#include "scheduler/service/worker_registry.hpp"

#include <algorithm>

#include "common/base/assertion.hpp"
#include "common/base/program.hpp"
#include "common/base/text.hpp"
#include "common/wire/wire.hpp"
#include "scheduler/state/tables.hpp"

namespace palpate {
namespace {

constexpr std::size_t longest_id = 64;
constexpr std::size_t longest_family = 64;

wire::WorkerStatus rowOf(const Worker& worker, const char* state, Worker::Time now) {
  wire::WorkerStatus row;
  row.set_worker(hexOf(worker.id));
  row.set_host(worker.provenance.host());
  row.set_pid(worker.pid);
  row.set_kernel_family(worker.kernel_family);
  row.set_state(state);
  row.set_heard_seconds_ago(std::chrono::duration<double>(now - worker.heard).count());
  row.set_results(worker.results);
  return row;
}

wire::Provenance provenanceOf(const wire::Hello& hello, const std::optional<PublicKey>& key) {
  wire::Provenance who;
  who.set_worker(hello.worker());
  who.set_host(printable(hello.host()));
  if (key) who.set_key(key->bytes().data(), key->bytes().size());
  return who;
}

}  // namespace

bool isSameBuild(std::string_view a, std::string_view b) {
  const std::string_view version_a = a.substr(0, a.find(' ')), version_b = b.substr(0, b.find(' '));
  const bool both_know = a.size() > version_a.size() && b.size() > version_b.size();
  return version_a == version_b && (!both_know || a == b);
}

void WorkerRegistry::addCredit(Worker& worker, std::uint64_t jobs) {
  worker.credit =
      static_cast<std::uint32_t>(std::min<std::uint64_t>(most_credit, worker.credit + jobs));
  asking_[worker.id] = &worker;
}

bool WorkerRegistry::someoneAsks() {
  bool some = false;
  eachAsking([&](const Worker&) {
    some = true;
    return false;
  });
  return some;
}

std::string WorkerRegistry::objectionTo(const wire::Hello& hello,
                                        const std::optional<PublicKey>& key) const {
  if (hello.protocol() != protocol_version)
    return fmt::format(
        "this scheduler speaks protocol {}, the worker protocol {}: install the same version of "
        "Palpate on both",
        protocol_version, hello.protocol());
  // Results of two builds of the program may differ in the last bits.
  if (!isSameBuild(hello.version(), buildName()))
    return fmt::format(
        "this scheduler is palpate {}, the worker palpate {}: their results may differ, so install "
        "the same program on both",
        buildName(), printable(hello.version()));
  if (hello.worker().empty() || hello.worker().size() > longest_id)
    return "its id is missing or too long";
  if (hello.kernel_family().empty()) return "it names no kernel family";
  if (hello.kernel_family() != printable(hello.kernel_family(), longest_family))
    return "the name of its kernel family is too long, or not printable";
  if (workers_.size() >= most_workers && !workers_.contains(hello.worker()))
    return fmt::format("{} workers are connected already, the maximum for a scheduler",
                       most_workers);
  const wire::Provenance who = provenanceOf(hello, key);
  for (const KeptOut& liar : kept_out_)
    if (liar.covers(who))
      return fmt::format(
          "this {} is excluded from this build because {}: check the machine with palpate verify "
          "before it works on another build",
          name(liar.kind), liar.reason);
  if (kernel_family_.empty() || hello.kernel_family() == kernel_family_ ||
      wouldChangeKernels(hello))
    return "";
  return fmt::format(
      "this build uses the {} kernels, but the worker has only the {} kernels (because of its CPU, "
      "PALPATE_KERNELS or OPENBLAS_CORETYPE, see docs/solver.md), and mixed kernels would make the "
      "last bits irreproducible: use machines that support {}, or start a new build with --kernels "
      "that all machines support",
      kernel_family_, hello.kernel_family(), kernel_family_);
}

bool WorkerRegistry::wouldChangeKernels(const wire::Hello& hello) const {
  return !kernel_family_.empty() && hello.kernel_family() != kernel_family_ &&
         std::ranges::find(hello.runs(), kernel_family_) != hello.runs().end();
}

Worker& WorkerRegistry::admit(const std::string& peer, const wire::Hello& hello,
                              const std::optional<PublicKey>& key, Time now) {
  const Worker* before = ofPeer(peer);
  PALPATE_ASSERT(before == nullptr || before->id == hello.worker(),
                 "a connection must have only one worker");
  // A worker that reconnects has a new peer name; its old one is forgotten.
  Worker& worker = workers_[hello.worker()];
  id_of_peer_.erase(worker.peer);
  Worker fresh;
  fresh.id = hello.worker();
  fresh.peer = peer;
  fresh.provenance = provenanceOf(hello, key);
  fresh.pid = hello.pid();
  fresh.kernel_family = hello.kernel_family();
  fresh.heard = fresh.moved = now;
  fresh.results = worker.results;
  fresh.overdue_until = worker.overdue_until;
  worker = std::move(fresh);
  id_of_peer_[peer] = worker.id;
  return worker;
}

void WorkerRegistry::remove(const Worker& worker, const char* state, Time now) {
  PALPATE_ASSERT(workers_.contains(worker.id), "a worker must be removed only once");
  // Keep a row of the worker: otherwise the tables would show it at work until it comes back.
  if (worker.results > 0 || std::ssize(departed_) < Tables::most_idle_departed)
    departed_.push_back(rowOf(worker, state, now));
  id_of_peer_.erase(worker.peer);
  asking_.erase(worker.id);
  workers_.erase(workers_.find(worker.id));
}

Worker* WorkerRegistry::ofPeer(const std::string& peer) {
  const auto id = id_of_peer_.find(peer);
  return id == id_of_peer_.end() ? nullptr : &workers_.at(id->second);
}

Worker* WorkerRegistry::find(const std::string& id) {
  const auto found = workers_.find(id);
  return found == workers_.end() ? nullptr : &found->second;
}

std::vector<wire::WorkerStatus> WorkerRegistry::rows(const Leases& leases, Time now) const {
  std::vector<wire::WorkerStatus> rows;
  for (const auto& [id, worker] : workers_)
    rows.push_back(rowOf(worker, leases.leasedTo(id) > 0 ? "busy" : "idle", now));
  return rows;
}

}  // namespace palpate
