#include "tests/simulation/world.hpp"

#include <fmt/format.h>
#include <sodium.h>

#include <algorithm>
#include <limits>

#include "common/base/whole_file.hpp"
#include "scheduler/builds/recorded_build.hpp"
#include "tests/support/scanned_journal.hpp"

namespace palpate::simulation {
namespace {

Random random_bytes(0);

/// Makes the random bytes of libsodium depend on the seed only.
void seedRandomBytes(std::uint64_t seed) {
  static randombytes_implementation ours = {
      .implementation_name = [] { return "seeded"; },
      .random = [] { return static_cast<std::uint32_t>(random_bytes.next()); },
      .stir = nullptr,
      .uniform = nullptr,
      .buf =
          [](void* const bytes, const std::size_t count) {
            for (std::size_t n = 0; n < count; ++n)
              static_cast<unsigned char*>(bytes)[n] =
                  static_cast<unsigned char>(random_bytes.next());
          },
      .close = nullptr};
  random_bytes = Random(seed);
  randombytes_set_implementation(&ours);
}

/// Time to completion after the last accident: for the work itself, and for each hung solve,
/// because the first one may take an hour to be detected.
constexpr Seconds patience = 3600, patience_with_the_hung = 3700;
/// A worker gives up after a quarter of an hour without a message, not counting suspended time.
constexpr Seconds goes_home_within = 20 * 60;
constexpr Seconds scheduler_restarts_after = 2, worker_replaced_after = 1;
constexpr Seconds refused_tries_after = 30;
constexpr std::size_t most_workers_known = 100, most_unacknowledged = 400, most_letters = 20000;
/// Some tens of thousands are usual.
constexpr std::int64_t most_steps = 1'000'000;
/// The most changes of the disk before an armed kill takes effect.
constexpr double most_changes = 40;

/// More checks in every second history; none in the others if nobody lies.
SpotCheckSettings checksOf(std::uint64_t seed) {
  constexpr double more = 0.05;
  SpotCheckSettings checks;
  if (seed % 2 == 0) checks.share = more;
  if (seed % 2 != 0 && !mayHaveLiar(seed)) checks.share = 0;
  return checks;
}

/// Everything that happens under one seed.
class World {
 public:
  World(const Scenario& scenario, std::uint64_t seed, const std::vector<Event>& history,
        const std::filesystem::path& folder)
      : scenario_(scenario),
        history_(history),
        folder_(folder),
        random_(seed),
        disk_(folder, random_.next()),
        network_(random_.next()),
        scheduler_(network_, disk_, ledger_, scenario.problem, folder, checksOf(seed), random_) {
    solver_world_.scenario = &scenario;
    solver_world_.told = &ledger_.lies;
    const auto hung = std::ranges::count(history, Accident::hung_solver, &Event::accident);
    patience_ = accidents_end_s + patience + static_cast<double>(hung) * patience_with_the_hung;
    // Three workers on different machines can determine which of them lies.
    const bool may_lie = mayHaveLiar(seed);
    const std::size_t workers = may_lie ? 3 + random_.below(2) : 1 + random_.below(4);
    for (std::size_t n = 0; n < workers; ++n)
      places_.push_back({.host = fmt::format("machine-{}", n), .starts_at = random_.between(0, 3)});
    Random sealer(seed ^ 0x7365616c);
    sealer_comes_at_ = sealer.between(0, sealer.chance(0.5) ? 10 : 100);
    sealer_waits_at_ = 1 + static_cast<int>(sealer.below(4));
  }

  Outcome run() {
    Outcome outcome;
    try {
      while (!over()) {
        if (sealer_comes_at_ && now_ >= *sealer_comes_at_ && scheduler_.up() && !power_is_cut_)
          sealBeside();
        step();
      }
      check(sameAsEver(), "the dataset that was sealed is another than undisturbed");
    } catch (const std::exception& error) {
      outcome.broken = fmt::format("at {:.3f} s: {}", now_, error.what());
    }
    outcome.simulated = now_;
    outcome.lies = ledger_.lies_heard;
    outcome.verdicts = ledger_.verdicts;
    outcome.spoiled = !outcome.broken && !spoiled_.empty();
    outcome.tables_hurt = ledger_.tables_hurt;
    outcome.felt = felt_;
    for (const auto& [kind, count] : network_.felt()) outcome.felt[kind] += count;
    for (const auto& [fault, count] : disk_.felt()) outcome.felt[accidentOf(fault)] += count;
    for (const auto& [kind, count] : scheduler_.felt()) outcome.felt[kind] += count;
    for (const Place& place : places_) note(place, outcome.felt);
    outcome.story = std::move(story_);
    return outcome;
  }

 private:
  /// The place of a worker, and of its successors.
  struct Place {
    std::string host;
    std::unique_ptr<WorkerProcess> worker = {};
    Seconds starts_at = 0;
    std::vector<std::string> ended = {};  ///< reported by the next worker
  };

  static void note(const Place& place, std::map<Accident, std::uint64_t>& felt) {
    if (!place.worker) return;
    for (const auto& [kind, count] : place.worker->felt()) felt[kind] += count;
  }
  static Accident accidentOf(DiskFault fault) {
    switch (fault) {
      case DiskFault::write_error: return Accident::write_error;
      case DiskFault::short_write: return Accident::short_write;
      case DiskFault::sync_error: return Accident::sync_error;
      case DiskFault::rename_error: return Accident::rename_error;
      case DiskFault::full: break;
    }
    return Accident::full_disk;
  }
  static void check(bool holds, const std::string& otherwise) {
    if (!holds) throw Broken(otherwise);
  }
  void tell(const std::string& what) {
    story_.push_back(fmt::format("{:10.3f} s  {}", now_, what));
  }

  bool over() const {
    return scheduler_.state() == SchedulerProcess::State::sealed &&
           std::ranges::all_of(places_, [](const Place& place) { return !place.worker; });
  }

  void step() {
    check(++steps_ < most_steps, "they talk without end, and nothing comes of it");
    Seconds next = scheduler_.nextWake(now_);
    if (!scheduler_.up() && !sealed()) next = std::min(next, scheduler_starts_at_);
    for (const Place& place : places_)
      next = std::min(next, place.worker ? place.worker->nextWake(now_)
                            : sealed()   ? never
                                         : place.starts_at);
    if (next_event_ < history_.size()) next = std::min(next, history_[next_event_].at);
    if (full_until_) next = std::min(next, *full_until_);
    check(next < never, "nobody has anything to do, and nothing is sealed");
    now_ = std::max(now_, next);
    check(now_ < patience_, "nothing is sealed hours after the last accident");
    if (sealed_at_) check(now_ < *sealed_at_ + goes_home_within, "a worker does not go home");

    if (full_until_ && now_ >= *full_until_) {
      disk_.setFull(false);
      full_until_.reset();
    }
    while (next_event_ < history_.size() && history_[next_event_].at <= now_)
      happen(history_[next_event_++]);
    turnScheduler();
    tellOfLies();
    for (Place& place : places_) turnWorker(place);
    check(network_.mostWaiting() < most_letters, "messages pile up");
  }

  void tellOfLies() {
    if (ledger_.lies_heard > std::exchange(lies_told_, ledger_.lies_heard))
      tell("the scheduler is told a lie");
    if (ledger_.verdicts > std::exchange(verdicts_told_, ledger_.verdicts))
      tell("who lied is found out");
  }

  bool sealed() const { return scheduler_.state() == SchedulerProcess::State::sealed; }

  // ---- The scheduler and who runs it ----

  void turnScheduler() {
    if (scheduler_.up()) {
      scheduler_.wake(now_);
    } else if (!sealed() && now_ >= scheduler_starts_at_) {
      if (scheduler_.state() == SchedulerProcess::State::stuck) retryDirectory();
      scheduler_.start(now_);
      tables_made_ = tables_made_ || scheduler_.up();
      tell(scheduler_.up() ? "the scheduler starts" : "the scheduler does not start");
    } else {
      return;
    }
    if (!scheduler_.up())
      afterEnd();
    else
      checkScheduler();
  }

  void checkScheduler() {
    const Coordinator& coordinator = scheduler_.coordinator();
    check(coordinator.workers() < most_workers_known, "workers that are gone are never forgotten");
    // Damaged tables may claim anything about the past.
    if (!ledger_.tables_hurt)
      check(static_cast<int>(coordinator.asideCount()) * deaths_before_aside <= deaths_,
            "a transition was set aside that fewer workers died on");
  }

  void afterEnd() {
    const bool killed = disk_.dead();
    const bool hurt = disk_.takeHurt() || killed;
    const std::string& error = scheduler_.lastError();
    using State = SchedulerProcess::State;
    const State state = scheduler_.state();
    tell(killed                    ? "the scheduler was killed"
         : state == State::sealed  ? "sealed, and the scheduler ends"
         : state == State::stuck   ? "the scheduler ends: some are set aside"
         : state == State::stopped ? "the scheduler ends as it was told"
                                   : "the scheduler ends: " + error);
    check(state != State::down || hurt || ledger_.tables_hurt,
          "the scheduler ended without a reason: " + error);
    if (power_is_cut_) {
      disk_.cutPower();
      tables_made_ = false;
      power_is_cut_ = false;
      tell("the power was cut, and is back");
    }
    disk_.revive();
    disk_.doNotKill();
    disk_.disarm();
    scheduler_starts_at_ = now_ + scheduler_restarts_after;
    if (sealed()) {
      sealed_at_ = now_;
      checkLeft();
    }
    checkDirectory();
  }

  /// After a quiet period no worker may have an undelivered result. A scheduler that completes soon
  /// after its start does not wait for workers that have not found it again; they give up in time.
  void checkLeft() const {
    constexpr Seconds quiet = 100;
    if (now_ < scheduler_.openedAt() + quiet) return;
    for (const Event& event : history_)
      if (now_ < event.at + event.length + quiet) return;
    for (const Place& place : places_)
      check(!place.worker || place.worker->unacknowledged() == 0,
            "a worker is left with results that nobody took");
  }

  /// Checks the files in the folder while no process uses them.
  void checkDirectory() {
    const std::filesystem::path directory = scheduler_.stateDirectory();
    if (std::filesystem::exists(scheduler_.dataset()))
      check(sameAsEver(), "a dataset is there that is not whole, or another than undisturbed");
    if (!std::filesystem::exists(directory)) {
      check(ledger_.acknowledged.empty(), "the state directory is gone");
      return;
    }
    ledger_.checkRecorded(recordedIn(directory));
    checkTables(directory);
  }

  void checkTables(const std::filesystem::path& directory) {
    // Skip tables that may be created or stored only in part: the next start repairs them.
    if (ledger_.tables_hurt || !tables_made_) return;
    try {
      StoredTables tables(directory);
      const Counters counters = tables.counters();
      const auto divergent = counters.find("divergent_results");
      check(divergent == counters.end() || divergent->second == 0 || ledger_.lies_heard > 0,
            "a result is taken for another than the recorded one");
    } catch (const Error& error) {
      throw Broken(std::string("the tables cannot be read: ") + error.what());
    }
  }

  static ResultKey keyIn(const std::string& header) {
    wire::Result result;
    check(result.ParseFromString(header), "a record in the journal cannot be read");
    return keyOf(result);
  }

  /// Whether the dataset is the undisturbed one, except for recorded lies that were undetected when
  /// it was sealed.
  bool sameAsEver() {
    const std::string sealed = readText(scheduler_.dataset(), "the dataset");
    const bool as_before = !spoiled_.empty() && sealed == spoiled_;
    if (!as_before) spoiled_.clear();
    if (as_before || sealed == scenario_.sealed) return true;
    if (ledger_.sealed_lies.empty()) return false;
    spoiled_ = scenario_.sealedWith(ledger_.sealed_lies, folder_.parent_path());
    tell("the dataset rests on lies that nobody found out");
    return sealed == spoiled_;
  }

  void retryDirectory() {
    tell("palpate retry");
    try {
      Tables(StateDirectory(scheduler_.stateDirectory())).forgetLosses();
      deaths_ = 0;
    } catch (const Error& error) {
      // The next start moves damaged tables aside, and with them the record of deaths.
      check(ledger_.tables_hurt || disk_.takeHurt(), error.what());
    }
  }

  // ---- Another process that reads ----

  /// Runs `palpate seal` at any time. While it reads, the others continue until every point is
  /// known.
  void sealBeside() {
    sealer_comes_at_.reset();
    std::exception_ptr broken;  // the C++ library does not pass it on
    disk_.beforeRead(sealer_waits_at_, [&] {
      try {
        while (!over() && !everyPointIsKnown() && !filesAreTakenNext()) step();
      } catch (...) {
        broken = std::current_exception();
      }
    });
    tell("palpate seal");
    try {
      const std::filesystem::path directory = scheduler_.stateDirectory();
      RecordedBuild recorded(directory);
      if (broken) std::rethrow_exception(broken);
      disk_.beforeRead(0, {});
      if (recorded.complete() && !ledger_.tables_hurt) checkSealedBeside(recorded);
    } catch (const Error& error) {
      tell(std::string("it does not: ") + error.what());
    }
    disk_.beforeRead(0, {});
    if (broken) std::rethrow_exception(broken);
  }

  void checkSealedBeside(RecordedBuild& recorded) {
    tell("it has the whole dataset");
    check(StoredTables(scheduler_.stateDirectory()).checks().empty(),
          "a dataset is taken for whole while a result is checked");
    const std::filesystem::path file = folder_.parent_path() / "beside.h5";
    recorded.seal(file);
    check(ledger_.lies_heard > 0 || readText(file, "the dataset") == scenario_.sealed,
          "a dataset that is sealed beside the scheduler is another than undisturbed");
  }

  bool everyPointIsKnown() {
    return scheduler_.up() &&
           std::ranges::all_of(scheduler_.coordinator().plans(), &SpacePlan::complete);
  }

  /// Returns whether the next accident removes files. All readers must have ended before that.
  bool filesAreTakenNext() const {
    if (next_event_ == history_.size()) return false;
    const Accident next = history_[next_event_].accident;
    return next == Accident::power_cut || next == Accident::tables_lost;
  }

  // ---- Workers and who replaces them ----

  void turnWorker(Place& place) {
    if (!place.worker) {
      if (sealed() || now_ < place.starts_at) return;
      const std::string id = fmt::format("worker-{:03}", ++workers_started_);
      place.worker =
          std::make_unique<WorkerProcess>(network_, solver_world_, id, place.host,
                                          std::move(place.ended), now_, Random(random_.next()));
      ledger_.host_of[place.worker->peer()] = place.host;
      place.ended.clear();
    }
    WorkerProcess& worker = *place.worker;
    if (worker.nextWake(now_) <= now_) worker.wake(now_);
    check(worker.unacknowledged() < most_unacknowledged, "a worker keeps more and more results");
    if (!worker.end()) return;
    const bool killed = worker.end() == WorkerProcess::End::killed;
    if (killed) {
      place.ended.push_back(worker.id());
      ++deaths_;
    }
    tell(fmt::format("{} {}", worker.id(),
                     killed                                       ? "died"
                     : worker.end() == WorkerProcess::End::failed ? "failed"
                                                                  : "left"));
    note(place, felt_);
    const bool refused =
        worker.end() == WorkerProcess::End::failed && ledger_.lies.isLiar(place.host);
    place.worker.reset();
    place.starts_at = now_ + (refused ? refused_tries_after : worker_replaced_after);
  }

  // ---- Accidents ----

  void happen(const Event& event) {
    tell(describe(event));
    const Seconds until = event.at + event.length;
    Place& place = places_[event.who % places_.size()];
    WorkerProcess* const worker = place.worker.get();
    const auto felt = [&] { ++felt_[event.accident]; };
    switch (event.accident) {
      case Accident::slow_network:
      case Accident::lost_messages:
      case Accident::doubled_messages:
      case Accident::reordered_messages:
      case Accident::cut_to_worker:
      case Accident::cut_to_scheduler:
      case Accident::cut_both_ways:
      case Accident::reset:
      case Accident::half_open:
      case Accident::narrow_link:
        return network_.happen(event, worker && event.who % 3 != 0 ? worker->peer() : "");
      default: break;
    }
    if (worker != nullptr) happenToWorker(event, *worker);
    if (scheduler_.up()) happenToScheduler(event);
    switch (event.accident) {
      case Accident::full_disk:
        disk_.setFull(true);
        full_until_ = std::max(full_until_.value_or(0), until);
        break;
      case Accident::journal_rot: return rotJournal(event);
      case Accident::table_rot: return rotTables(event);
      case Accident::tables_lost:
        if (scheduler_.up() || !std::filesystem::exists(tables())) break;
        felt();
        ledger_.hurtTables();
        std::filesystem::remove(tables());
        break;
      case Accident::lock_file_removed:
        if (std::error_code none;
            std::filesystem::remove(scheduler_.stateDirectory() / "lock", none))
          felt();
        break;
      case Accident::deadly_transition:
        solver_world_.deadly[{static_cast<std::uint32_t>(event.who % 2), someTarget(event)}] =
            event.at + 3 * event.length;
        break;
      case Accident::lying_worker: solver_world_.liars.try_emplace(place.host, event.who); break;
      case Accident::kill_at_verdict:
        scheduler_.killAtVerdict(static_cast<int>(event.how_much * most_changes));
        break;
      default: break;
    }
  }

  void happenToWorker(const Event& event, WorkerProcess& worker) {
    const Seconds until = event.at + event.length;
    switch (event.accident) {
      case Accident::kill_worker: worker.kill(now_); break;
      case Accident::stop_worker: worker.stop(now_, until, false); break;
      case Accident::suspend_worker: worker.stop(now_, until, true); break;
      case Accident::worker_clock_jump: worker.leap(event.length); break;
      case Accident::interrupt_worker: worker.interrupt(now_); break;
      case Accident::hung_solver: return worker.hangNext();  // counted when it takes effect
      case Accident::out_of_memory: return worker.runOutOfMemory();
      case Accident::slow_solve: return worker.solveSlowly(event.length);
      default: return;
    }
    ++felt_[event.accident];
  }

  void happenToScheduler(const Event& event) {
    const Seconds until = event.at + event.length;
    // Some kills come in the middle of the next writes, others while the scheduler waits.
    const int changes = static_cast<int>(event.how_much * most_changes);
    switch (event.accident) {
      case Accident::power_cut: power_is_cut_ = true; [[fallthrough]];
      case Accident::kill_scheduler:
        if (changes > 0) {
          disk_.killAfter(changes);
        } else {
          scheduler_.kill();
          afterEnd();
        }
        break;
      case Accident::stop_scheduler: scheduler_.stop(now_, until, false); break;
      case Accident::suspend_scheduler: scheduler_.stop(now_, until, true); break;
      case Accident::scheduler_clock_jump: scheduler_.leap(event.length); break;
      case Accident::ask_to_stop:
        scheduler_.askToStop(now_);
        if (!scheduler_.up()) afterEnd();
        break;
      case Accident::second_scheduler: startSecond(); break;
      case Accident::write_error: return disk_.arm(DiskFault::write_error);
      case Accident::short_write: return disk_.arm(DiskFault::short_write);
      case Accident::sync_error: return disk_.arm(DiskFault::sync_error);
      case Accident::rename_error: return disk_.arm(DiskFault::rename_error);
      default: return;
    }
    ++felt_[event.accident];
  }

  void startSecond() {
    try {
      const StateDirectory second(scheduler_.stateDirectory());
    } catch (const Error&) {
      return;
    }
    throw Broken("two schedulers share a state directory");
  }

  LatticePoint someTarget(const Event& event) const {
    const auto coordinate = [&](int shift) {
      return static_cast<std::int32_t>((event.who >> shift) % 3) - 1;
    };
    return {coordinate(4), coordinate(8), coordinate(12)};
  }

  std::filesystem::path tables() const {
    return StateDirectory::databaseIn(scheduler_.stateDirectory());
  }

  void rotJournal(const Event& event) {
    const JournalReader reader(scheduler_.stateDirectory());
    if (!std::filesystem::exists(scheduler_.stateDirectory())) return;
    const auto records = test::scanned(reader).records;
    if (records.empty()) return;
    const auto& hit = records[event.who % records.size()];
    ledger_.spoiled.insert(keyIn(hit.header));
    disk_.flip(scheduler_.stateDirectory() / fmt::format("segment-{:06}.dat", hit.where.segment),
               hit.where.offset + (event.who >> 20) % hit.where.length,
               static_cast<int>(event.how_much * 7.99));
    ++felt_[event.accident];
  }

  void rotTables(const Event& event) {
    std::error_code none;
    const std::filesystem::path file = tables().string() + (event.who % 2 == 0 ? "" : "-wal");
    const std::uintmax_t size = std::filesystem::file_size(file, none);
    if (none || size == 0) return;
    ledger_.hurtTables();
    disk_.flip(file, (event.who / 2) % size, static_cast<int>(event.how_much * 7.99));
    ++felt_[event.accident];
  }

  const Scenario& scenario_;
  const std::vector<Event>& history_;
  const std::filesystem::path folder_;
  Random random_;
  Disk disk_;
  Network network_;
  Ledger ledger_;
  SolverWorld solver_world_;
  SchedulerProcess scheduler_;
  std::vector<Place> places_;
  Seconds now_ = 0, scheduler_starts_at_ = 0, patience_ = 0;
  std::size_t next_event_ = 0;
  std::optional<Seconds> full_until_, sealed_at_, sealer_comes_at_;
  int sealer_waits_at_ = 0;  ///< number of its reads (Disk::beforeRead)
  bool power_is_cut_ = false, tables_made_ = false;
  int deaths_ = 0, workers_started_ = 0;
  std::int64_t steps_ = 0;
  std::size_t lies_told_ = 0, verdicts_told_ = 0;  ///< numbers already in the story
  std::map<Accident, std::uint64_t> felt_;
  std::vector<std::string> story_;
  std::string spoiled_;  ///< the current dataset, if it contains undetected lies
};

}  // namespace

Outcome simulate(const Scenarios& scenarios, std::uint64_t seed, const std::vector<Event>& history,
                 const std::filesystem::path& folder) {
  std::filesystem::remove_all(folder);
  std::filesystem::create_directory(folder);
  seedRandomBytes(seed);
  Outcome outcome = World(scenarios.of(seed), seed, history, folder).run();
  std::filesystem::remove_all(folder);
  return outcome;
}

}  // namespace palpate::simulation
