#include "tests/simulation/worker.hpp"

#include <limits>

#include "common/base/error.hpp"
#include "tests/support/solved_table.hpp"

namespace palpate::simulation {
namespace {

/// The real thread polls every 50 ms, but waits for events that take seconds.
constexpr Seconds looks_every = 0.4;

}  // namespace

WorkerProcess::WorkerProcess(Network& network, SolverWorld& world, const std::string& id,
                             const std::string& host, std::vector<std::string> ended, Seconds now,
                             Random random)
    : network_(network),
      world_(world),
      id_(id),
      host_(host),
      peer_("w" + id),
      random_(random),
      clock_(random_),
      now_(now),
      mailbox_(std::make_unique<Mailbox>()),
      next_turn_(now) {
  SessionOptions options;
  options.worker_id = id;
  options.ended = std::move(ended);
  options.host = host;
  options.pid = 1;
  options.kernel_family = "baseline";
  session_ = std::make_unique<WorkerSession>(*mailbox_, options, clock_.at(now));
  network_.join(peer_, now);
}

Seconds WorkerProcess::nextWake(Seconds now) const {
  if (end_) return never;
  Seconds next = std::min(next_turn_, network_.nextForWorker(peer_));
  if (work_ && !hangs_) next = std::min(next, work_->done_at);
  return std::max({next, stopped_until_, now});
}

void WorkerProcess::endsWith(End end, Seconds now) {
  end_ = end;
  work_.reset();
  network_.leave(peer_, now);
}

void WorkerProcess::kill(Seconds now) {
  if (!end_) endsWith(End::killed, now);
}

void WorkerProcess::stop(Seconds from, Seconds until, bool clock_too) {
  if (until <= stopped_until_) return;
  const Seconds more = until - std::max(from, stopped_until_);
  if (clock_too) clock_.leap(-more);
  if (work_) work_->done_at += more;
  stopped_until_ = until;
}

void WorkerProcess::interrupt(Seconds now) {
  if (!end_) session_->interrupt(clock_.at(now));
}

void WorkerProcess::beginTarget(Seconds now) {
  const wire::Job& job = work_->job.job;
  const wire::Target& target = job.targets(work_->target);
  if (!mailbox_->begin(job.id(), target.point())) {
    work_.reset();
    return;
  }
  hangs_ = std::exchange(hang_next_, false);
  if (hangs_) ++felt_[Accident::hung_solver];
  Seconds takes = random_.between(0.2, 4);
  if (longer_ > 0) {
    ++felt_[Accident::slow_solve];
    takes += std::exchange(longer_, 0);
  }
  work_->done_at = now + takes;
}

void WorkerProcess::finishTarget() {
  const wire::Job& job = work_->job.job;
  const wire::Target& target = job.targets(work_->target);
  const Scenario& scenario = *world_.scenario;
  auto [result, payload] = scenario.solve(scenario.problem, job.space(), fromWire(target.point()),
                                          fromWire(job.start()));
  test::answer(job, target, result);
  const auto liar = world_.liars.find(host_);
  if (liar != world_.liars.end() && liar->second.falsify(result, payload)) {
    ++felt_[Accident::lying_worker];
    world_.told->note(host_, result);
  }
  mailbox_->finish(
      {std::move(result), std::move(payload), work_->target + 1 == job.targets_size()});
}

void WorkerProcess::solve(Seconds now) {
  if (hangs_) return;
  while (work_ && work_->done_at <= now) {
    const wire::Job& job = work_->job.job;
    const auto deadly =
        world_.deadly.find({job.space(), fromWire(job.targets(work_->target).point())});
    if (deadly != world_.deadly.end() && now < deadly->second) {
      ++felt_[Accident::deadly_transition];
      return endsWith(End::killed, now);
    }
    if (no_memory_) {
      ++felt_[Accident::out_of_memory];
      work_.reset();
      mailbox_->solverEnds("out of memory");
      return;
    }
    finishTarget();
    if (++work_->target < job.targets_size())
      beginTarget(now);
    else
      work_.reset();
  }
  // Acts as the solver thread: next() shows that nothing is being solved.
  if (work_ || mailbox_->solverError()) return;
  if (auto job = mailbox_->next(false)) {
    work_ = Work{std::move(*job), 0, 0};
    beginTarget(now);
  }
}

void WorkerProcess::wake(Seconds now) {
  if (end_ || now < stopped_until_) return;
  now_ = now;
  next_turn_ = now + looks_every;
  solve(now);
  if (end_) return;
  try {
    while (const auto incoming = inbox_.next([&] { return network_.forWorker(peer_, now); }))
      session_->receive(*incoming, clock_.at(now));
    const WorkerSession::Next next = session_->advance(clock_.at(now));
    for (const Letter& letter : session_->takeOutbox())
      network_.toScheduler(peer_, letter.message, letter.payload, now_);
    switch (next) {
      case WorkerSession::Next::go_on: break;
      case WorkerSession::Next::connect:
        network_.reconnect(peer_, now);
        session_->connected(clock_.at(now));
        break;
      case WorkerSession::Next::end: return endsWith(End::left, now);
      case WorkerSession::Next::anew:  // it has only one kernel family
      case WorkerSession::Next::killed: return endsWith(End::killed, now);
    }
  } catch (const Error&) {
    return endsWith(End::failed, now);
  }
  solve(now);  // the target that has just arrived
}

}  // namespace palpate::simulation
