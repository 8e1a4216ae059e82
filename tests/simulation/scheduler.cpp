#include "tests/simulation/scheduler.hpp"

#include <limits>

namespace palpate::simulation {
namespace {

constexpr Seconds turn_every = 0.5;
/// How long `serve` waits for workers to leave (scheduler/verbs/served_build.hpp).
constexpr Seconds drain_limit = 30;
constexpr int most_damages = 200;

}  // namespace

SchedulerProcess::SchedulerProcess(Network& network, Disk& disk, Ledger& ledger,
                                   const Problem& problem, std::filesystem::path folder,
                                   const SpotCheckSettings& spot_checks, Random& random)
    : network_(network),
      disk_(disk),
      ledger_(ledger),
      problem_(problem),
      folder_(std::move(folder)),
      clock_(random) {
  settings_.spot_checks = spot_checks;
}

SchedulerProcess::~SchedulerProcess() = default;

void SchedulerProcess::end(State state) {
  build_.reset();
  inbox_.clear();
  network_.schedulerEnds();
  state_ = state;
}

/// An Error ends the process, and so does being killed.
void SchedulerProcess::guarded(const std::function<void()>& step) {
  try {
    step();
  } catch (const Error& error) {
    last_error_ = error.what();
    end(State::down);
  } catch (const std::filesystem::filesystem_error& error) {
    last_error_ = error.what();
    end(State::down);
  } catch (const Broken&) {
    throw;
  } catch (const std::logic_error& error) {
    if (!disk_.dead()) throw Broken(error.what());
    end(State::down);
  }
  // The process was killed in an operation that ignores errors (a log, the removal of a file).
  if (disk_.dead() && build_) end(State::down);
}

void SchedulerProcess::open(Seconds now) {
  // A segment holds only a few records, so that many segments come and go.
  constexpr std::uint64_t segment_bytes = 8000;
  build_ =
      std::make_unique<Build>(problem_, stateDirectory(), clock_.at(now), settings_, segment_bytes);
  // The process may have been killed after the exclusions were written, before it was told.
  if (ledger_.verdicts > 0) ledger_.noteKeptOut(StoredTables(stateDirectory()).keptOut());
  ledger_.cleaned_of = ledger_.kept_out;
  sealed_ = false;
  opened_at_ = now;
  state_ = State::running;
  network_.schedulerStarts();
}

void SchedulerProcess::start(Seconds now) {
  last_error_.clear();
  next_turn_ = now_ = now;
  guarded([&] { open(now); });
}

Seconds SchedulerProcess::nextWake(Seconds now) const {
  if (!build_) return never;
  Seconds next = std::min(next_turn_, network_.nextForScheduler());
  const Coordinator& coordinator = build_->coordinator();
  next = std::min(next, now + clock_.secondsUntil(coordinator.nextDeadline(), now));
  return std::max({next, stopped_until_, now});
}

void SchedulerProcess::wake(Seconds now) {
  if (!build_ || now < stopped_until_) return;
  now_ = now;
  next_turn_ = now + turn_every;
  guarded([&] {
    try {
      turn(now);
    } catch (const DamagedRecord& damage) {
      // Unreadable results are computed again, as in `serve` and `build`.
      if (++damages_ > most_damages)
        throw Broken("a damaged record stays, however often it is dropped");
      build_->drop(damage);
      openAnew(now);
    }
  });
}

/// Excludes liars, whose results are then computed again, as in `serve` and `build`.
void SchedulerProcess::keepOut(const std::vector<KeptOut>& liars, Seconds now) {
  ledger_.noteVerdict(liars, stateDirectory());
  if (const auto changes = std::exchange(kill_at_verdict_, std::nullopt)) {
    ++felt_[Accident::kill_at_verdict];
    if (*changes == 0) return disk_.die();
    disk_.killAfter(*changes);
  }
  build_->keepOut(liars);
  if (disk_.dead()) return;
  ledger_.noteKeptOut(liars);
  openAnew(now);
}

void SchedulerProcess::openAnew(Seconds now) {
  const bool stopping = build_->coordinator().stopping();
  end(State::down);
  open(now);
  if (stopping) build_->coordinator().stop(clock_.at(now));
}

void SchedulerProcess::turn(Seconds now) {
  Coordinator& coordinator = build_->coordinator();
  const Next next = exchange(coordinator, *this, clock_.at(now));
  if (next == Next::anew) return keepOut(coordinator.liars(), now);
  if (disk_.dead()) return;
  if (state_ == State::running) {
    if (next == Next::complete) return seal(now);
    if (next != Next::go_on) {
      coordinator.dismiss();
      leaves_at_ = now + drain_limit;
      state_ = State::leaving;
    }
  } else if (coordinator.deserted(clock_.at(now)) || now >= leaves_at_) {
    leave();
  }
}

void SchedulerProcess::leave() {
  const Coordinator& coordinator = build_->coordinator();
  const bool stuck = !sealed_ && coordinator.stuck();
  if (stuck && coordinator.asideCount() + coordinator.disputedCount() == 0)
    throw Broken("the scheduler is stuck and does not say why");
  end(sealed_ ? State::sealed : stuck ? State::stuck : State::stopped);
}

void SchedulerProcess::seal(Seconds now) {
  build_->verify();
  build_->coordinator().dismiss();
  exchange(build_->coordinator(), *this, clock_.at(now));
  ledger_.noteSealed(stateDirectory(), build_->coordinator().plans());
  build_->seal(dataset());
  sealed_ = true;
  leaves_at_ = now + drain_limit;
  state_ = State::leaving;
}

void SchedulerProcess::kill() {
  if (!build_) return;
  disk_.die();
  end(State::down);
}

void SchedulerProcess::stop(Seconds from, Seconds until, bool clock_too) {
  if (until <= stopped_until_) return;
  if (clock_too) clock_.leap(-(until - std::max(from, stopped_until_)));
  stopped_until_ = until;
}

void SchedulerProcess::askToStop(Seconds now) {
  if (build_ && state_ == State::running)
    guarded([&] { build_->coordinator().stop(clock_.at(now)); });
}

std::optional<Incoming> SchedulerProcess::receive() {
  // A process that was killed since the last call reads nothing.
  if (disk_.dead()) return std::nullopt;
  auto incoming = inbox_.next([&] { return network_.forScheduler(now_); });
  if (incoming && incoming->message.has_result())
    ledger_.noteDelivery(incoming->peer, incoming->message.result());
  return incoming;
}

void SchedulerProcess::note(const std::string& peer, const wire::Message& message) {
  for (const wire::Message& part : message.bundle().messages()) note(peer, part);
  if (message.has_result_ack() && !message.result_ack().unwanted()) {
    const wire::ResultAck& ack = message.result_ack();
    ledger_.noteAcknowledged(peer, {ack.space(), fromWire(ack.target()), fromWire(ack.parent())});
  }
  if (message.has_job() && ledger_.isKeptOut(peer))
    throw Broken("a worker that is kept out is given work");
  if (message.has_job())
    for (const wire::Target& target : message.job().targets()) {
      const ResultKey key = {message.job().space(), fromWire(target.point()),
                             fromWire(message.job().start())};
      if (ledger_.acknowledged.contains(key) && !ledger_.mayBeLost(key) &&
          !build_->coordinator().isChecked(key))
        throw Broken("a result that was acknowledged is asked for again");
    }
}

Sent SchedulerProcess::send(const Outgoing& outgoing) {
  if (disk_.dead()) return Sent::yes;
  note(outgoing.peer, outgoing.message);
  return network_.toWorker(outgoing.peer, outgoing.message,
                           outgoing.payload ? *outgoing.payload : "", now_);
}

}  // namespace palpate::simulation
