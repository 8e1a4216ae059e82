#include "tests/fuzz/fuzzer.hpp"
#include "tests/support/solved_table.hpp"
#include "worker/link/worker_session.hpp"

namespace palpate::fuzz {
namespace {

using namespace std::chrono_literals;

/// Events in the life of a worker, chosen by their first byte.
enum SessionEvent : unsigned char {
  hears_anything,  ///< a Message and a payload, unchanged
  hears_welcome,   ///< from one of two schedulers of the problem's build
  hears_problem,   ///< the problem of the build
  hears_job,       ///< a valid Job with some fields overwritten
  hears_fields,    ///< the fields that the job needs
  solves,          ///< its current target
  time_passes,     ///< ms, up to a minute
  session_events
};

class FuzzedWorker {
 public:
  void follow(Choices& choices) {
    wire::Message message;
    switch (choices.oneOf(session_events)) {
      case hears_anything: {
        const std::string_view bytes = choices.takeBytes();
        if (!message.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) message.Clear();
        hear(message, std::string(choices.takeBytes()));
        break;
      }
      case hears_welcome:
        message.mutable_welcome()->set_epoch(choices.oneOf(2) == 0 ? "first" : "second");
        message.mutable_welcome()->set_build(std::string(known().id.bytes()));
        hear(message);
        break;
      case hears_problem:
        message.mutable_problem_reply()->set_build(std::string(known().id.bytes()));
        hear(message, known().bytes);
        break;
      case hears_job: {
        wire::Job& job = *message.mutable_job();
        job.set_id(1);
        job.set_start_id(known().start_id);
        *job.add_targets()->mutable_point() = toWire(LatticePoint{1, 0, 0});
        const std::string_view bytes = choices.takeBytes();
        wire::Job other;
        if (other.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())))
          job.MergeFrom(other);
        hear(message);
        break;
      }
      case hears_fields:
        message.mutable_fields_reply()->set_id(known().start_id);
        hear(message, known().fields);
        break;
      case solves: solve(); break;
      case time_passes: now_ += choices.take<std::uint16_t>() * 1ms; break;
      default: break;
    }
    const WorkerSession::Next next = session_.advance(now_);
    session_.takeOutbox();
    if (next == WorkerSession::Next::connect) session_.connected(now_);
    ended_ = next == WorkerSession::Next::end || next == WorkerSession::Next::killed;
  }
  bool ended() const { return ended_; }

 private:
  struct Known {
    Problem problem = test::cubeProblem();
    std::string bytes = encodeProblem(problem);
    ContentId id = problemId(problem);
    std::string fields = test::solve(problem, 0, {0, 0, 0}, {0, 0, 0}).second;
    std::string start_id = std::string(ContentId::of(fields).bytes());
  };
  static const Known& known() {
    static const Known known;
    return known;
  }

  void hear(const wire::Message& message, const std::string& payload = "") {
    session_.receive({"", message, payload}, now_);
  }

  /// Acts as the solver thread, but looks up the answers.
  void solve() {
    const std::optional<ReadyJob> ready = mailbox_.next(false);
    if (!ready) return;
    require(ready->problem && ready->job.targets_size() > 0 &&
                ready->job.space() < ready->problem->active.size(),
            "the solver is given a job that it cannot solve");
    if (ready->start)
      require(ready->start->displacement.size() == 3 * ready->problem->mesh.nodes.size(),
              "the solver is given a start that is not of its mesh");
    for (const wire::Target& target : ready->job.targets()) {
      if (!mailbox_.begin(ready->job.id(), target.point())) return;
      auto [result, payload] = test::solve(*ready->problem, ready->job.space(),
                                           fromWire(target.point()), fromWire(ready->job.start()));
      mailbox_.finish({std::move(result), std::move(payload), true});
    }
  }

  WorkerSession::Time now_ = WorkerSession::Time() + 1h;
  Mailbox mailbox_;
  WorkerSession session_ = {
      mailbox_, {.worker_id = "w", .host = "here", .kernel_family = "baseline"}, now_};
  bool ended_ = false;
};

void followScheduler(std::string_view bytes) {
  Choices choices(bytes);
  FuzzedWorker worker;
  while (!choices.done() && !worker.ended()) worker.follow(choices);
}

std::vector<std::string> sessionSeeds() {
  wire::Job origin;
  origin.set_space(1);
  wire::Message ack;
  *ack.mutable_result_ack()->mutable_target() = toWire(LatticePoint{1, 0, 0});
  wire::Message drain;
  drain.mutable_drain()->set_finished(true);
  Script work, refused;
  work.op(hears_welcome).op(0).op(hears_problem).op(hears_job).putBytes("").op(hears_fields);
  work.op(solves).op(hears_anything).putBytes(ack.SerializeAsString()).putBytes("");
  work.op(hears_job).putBytes(origin.SerializeAsString()).op(solves);
  work.op(time_passes).put(std::uint16_t{11000}).op(hears_welcome).op(1);
  work.op(hears_anything).putBytes(drain.SerializeAsString()).putBytes("");
  wire::Message unknown;
  unknown.mutable_fields_reply()->set_unknown(true);
  unknown.mutable_fields_reply()->set_id(std::string(32, 'x'));
  refused.op(hears_welcome).op(0).op(hears_problem).op(hears_job).putBytes("");
  refused.op(hears_anything).putBytes(unknown.SerializeAsString()).putBytes("fields");
  return {work.text(), refused.text()};
}

const Registration session_fuzzer({"session", followScheduler, sessionSeeds});

}  // namespace
}  // namespace palpate::fuzz
