#include "common/base/program.hpp"
#include "scheduler/service/coordinator.hpp"
#include "tests/fuzz/light_sqlite.hpp"
#include "tests/support/solved_table.hpp"
#include "tests/support/temporary_directory.hpp"

namespace palpate::fuzz {
namespace {

using namespace std::chrono_literals;

/// Actions of a peer, chosen by their first byte modulo `peer_deeds`.
enum PeerDeed : unsigned char {
  says_anything,     ///< a Message and a payload, unchanged
  says_hello,        ///< as an acceptable worker
  asks_for_jobs,     ///< with a credit from the input
  delivers,          ///< all targets of its oldest job, unchanged
  delivers_changed,  ///< its first target, with some fields of the Result overwritten
  passes_time,       ///< ms, up to a minute
  goes_away,         ///< its connection breaks
  asks_for_status,   ///< as anybody is allowed to
  peer_deeds
};

/// A build of a small problem and two peers that send what the input says.
class FuzzedScheduler {
 public:
  FuzzedScheduler()
      : directory_(folder_ / "state"),
        store_(directory_, problem(), 1 << 20),
        coordinator_(problem(), problemBytes(), store_, now_) {}

  void follow(Choices& choices) {
    const std::string peer = choices.oneOf(2) == 0 ? "a" : "b";
    wire::Message message;
    switch (choices.oneOf(peer_deeds)) {
      case says_anything: {
        const std::string_view bytes = choices.takeBytes();
        if (!message.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) message.Clear();
        say(peer, message, std::string(choices.takeBytes()));
        break;
      }
      case says_hello:
        message.mutable_hello()->set_protocol(protocol_version);
        message.mutable_hello()->set_version(version());
        message.mutable_hello()->set_worker(peer);
        message.mutable_hello()->set_kernel_family("baseline");
        say(peer, message);
        break;
      case asks_for_jobs:
        message.mutable_request()->set_credit(choices.take<std::uint32_t>());
        say(peer, message);
        break;
      case delivers: deliver(peer); break;
      case delivers_changed: deliverChanged(peer, choices.takeBytes()); break;
      case passes_time: now_ += choices.take<std::uint16_t>() * 1ms; break;
      case goes_away: coordinator_.peerUnreachable(peer, now_); break;
      case asks_for_status:
        message.mutable_status_request();
        say(peer, message);
        break;
      default: break;
    }
    coordinator_.advance(now_);
    hear();
  }

  bool beginsAnew() const { return coordinator_.next() == Next::anew; }
  /// The records must be a valid start for the next run.
  void end() {
    coordinator_.stop(now_);
    coordinator_.status(now_);
    replayJournal(folder_ / "state", problem(), store_.build(), {});
  }

 private:
  static const Problem& problem() {
    static const Problem cube = test::smallCubeProblem();
    return cube;
  }
  static const std::string& problemBytes() {
    static const std::string bytes = encodeProblem(problem());
    return bytes;
  }

  /// The answer of an honest worker, computed once.
  static std::pair<wire::Result, std::string> solved(std::uint32_t space, const wire::Point& target,
                                                     const wire::Point& parent) {
    static std::map<ResultKey, std::pair<wire::Result, std::string>> known;
    const ResultKey key = {space, fromWire(target), fromWire(parent)};
    const auto found = known.find(key);
    if (found != known.end()) return found->second;
    const auto& [_, to, from] = key;
    return known.emplace(key, test::solve(problem(), space, to, from)).first->second;
  }

  void say(const std::string& peer, const wire::Message& message, const std::string& payload = "") {
    coordinator_.receive({peer, message, payload}, now_);
    hear();
  }

  void hear() {
    for (Outgoing& outgoing : coordinator_.takeOutbox())
      if (outgoing.message.has_job())
        jobs_[outgoing.peer].push_back(std::move(*outgoing.message.mutable_job()));
  }

  std::optional<wire::Job> oldestJob(const std::string& peer) {
    std::deque<wire::Job>& jobs = jobs_[peer];
    if (jobs.empty()) return std::nullopt;
    wire::Job job = std::move(jobs.front());
    jobs.pop_front();
    return job;
  }

  void deliver(const std::string& peer) {
    const std::optional<wire::Job> job = oldestJob(peer);
    if (!job) return;
    for (const wire::Target& target : job->targets()) {
      auto [result, payload] = solved(job->space(), target.point(), job->start());
      test::answer(*job, target, result);
      wire::Message message;
      *message.mutable_result() = std::move(result);
      say(peer, message, payload);
    }
  }

  void deliverChanged(const std::string& peer, std::string_view changes) {
    const std::optional<wire::Job> job = oldestJob(peer);
    if (!job) return;
    auto [result, payload] = solved(job->space(), job->targets(0).point(), job->start());
    test::answer(*job, job->targets(0), result);
    wire::Result other;
    if (other.ParseFromArray(changes.data(), static_cast<int>(changes.size())))
      result.MergeFrom(other);
    wire::Message message;
    *message.mutable_result() = std::move(result);
    say(peer, message, payload);
  }

  test::TemporaryDirectory folder_;
  StateDirectory directory_;
  JobStore store_;
  Coordinator::Time now_ = Coordinator::Time() + 1h;
  Coordinator coordinator_;
  std::map<std::string, std::deque<wire::Job>> jobs_;
};

void followPeers(std::string_view bytes) {
  Choices choices(bytes);
  FuzzedScheduler scheduler;
  // Each action may access the disk. Two peers with equal results may expose a third.
  for (int deeds = 0; deeds < 100 && !choices.done() && !scheduler.beginsAnew(); ++deeds)
    scheduler.follow(choices);
  if (!scheduler.beginsAnew()) scheduler.end();
}

std::vector<std::string> peerSeeds() {
  wire::Result costly;
  costly.mutable_cost()->set_newton_iterations(7);
  costly.mutable_cost()->set_seconds(1e9);
  wire::Result failed;
  failed.mutable_failure()->set_cause(2);
  wire::Message beat;
  beat.mutable_heartbeat()->set_solving(true);
  beat.mutable_heartbeat()->mutable_target()->set_i(1);
  wire::Message ask;
  ask.mutable_fields_request()->set_id(std::string(32, 'x'));
  ask.mutable_fields_request()->mutable_point();
  Script build, lost;
  build.op(0).op(says_hello).op(0).op(asks_for_jobs).put(std::uint32_t{4});
  for (int turn = 0; turn < 8; ++turn)
    build.op(0).op(delivers).op(0).op(asks_for_jobs).put(std::uint32_t{2});
  lost.op(1).op(says_hello).op(1).op(asks_for_jobs).put(std::uint32_t{2});
  lost.op(1).op(delivers_changed).putBytes(costly.SerializeAsString());
  lost.op(1).op(delivers_changed).putBytes(failed.SerializeAsString());
  for (const wire::Message& message : {beat, ask})
    lost.op(1).op(says_anything).putBytes(message.SerializeAsString()).putBytes("");
  lost.op(1)
      .op(asks_for_status)
      .op(0)
      .op(passes_time)
      .put(std::uint16_t{65000})
      .op(1)
      .op(goes_away);
  return {build.text(), lost.text()};
}

/// The tables of a build are written but not read, so keeping them in memory tests the same code.
void keepTablesInMemory() {
  makeSqliteLight();
  require(sqlite3_vfs_register(sqlite3_vfs_find("memdb"), 1) == SQLITE_OK, "SQLite has memory");
}

const Registration coordinator_fuzzer({"coordinator", followPeers, peerSeeds, keepTablesInMemory});

}  // namespace
}  // namespace palpate::fuzz
