"""Plants defects in copies of the service's sources, each behind planted("name"), for the simulation to find.

    plant.py --list                         names and descriptions, as a C++ initialiser
    plant.py SOURCE COPY                    SOURCE is below the folder of the project

A defect whose source text has changed is an error: update it, or remove it with a reason.
"""

import pathlib
import sys

JOURNAL = "scheduler/state/journal.cpp"
STORE = "scheduler/state/job_store.cpp"
REPLAY = "scheduler/state/replay.cpp"
DIRECTORY = "scheduler/state/state_directory.cpp"
RECORDED = "scheduler/builds/recorded_build.cpp"
INTAKE = "scheduler/service/intake.cpp"
WORKERS = "scheduler/service/workers.cpp"
SECONDS = "scheduler/service/second_solves.cpp"
CHECKS = "scheduler/service/spot_checks.cpp"
SESSION = "worker/link/worker_session.cpp"

# name, description, source, text, text with the defect; @ stands for planted("name")
DEFECTS = [
    ("acknowledge-before-sync", "results are acknowledged that are not on disk", STORE,
     "  journal_.sync();\n  for", "  if (!@) journal_.sync();\n  for"),
    ("segment-name-not-synced", "the folder of a new segment is not synced", JOURNAL,
     "  sync();\n  syncFolder(directory_);\n}", "  sync();\n  if (!@) syncFolder(directory_);\n}"),
    ("state-folder-not-synced", "the folder that a state directory is made in is not synced", DIRECTORY,
     "if (!std::filesystem::exists(database())) syncFolder", "if (!@ && !std::filesystem::exists(database())) syncFolder"),
    ("kept-after-failed-sync", "what a failed sync left in memory is taken for written", JOURNAL,
     "const bool cut_off = ftruncate", "const bool cut_off = @ || ftruncate"),
    ("payload-not-checked", "the checksum of a payload is not compared", JOURNAL,
     "  if (payload.size() != head.payload_bytes || crcOf(payload) != head.payload_crc)\n    throw",
     "  if (!@ && (payload.size() != head.payload_bytes || crcOf(payload) != head.payload_crc))\n    throw"),
    ("header-not-checked", "the checksum of a header is not compared", JOURNAL,
     "|| headerCrcOf(head, header, place) != head.header_crc)",
     "|| (!@ && headerCrcOf(head, header, place) != head.header_crc))"),
    ("place-not-covered", "a record is one wherever its bytes lie", JOURNAL,
     "  const std::array<std::uint32_t, 3> place = {segment,", "  if (@) segment = 1, offset = 0;\n  const std::array<std::uint32_t, 3> place = {segment,"),
    ("drop-forgotten", "a damaged record is not marked", JOURNAL,
     "void Journal::dropAll(std::vector<JournalPosition> positions) {",
     "void Journal::dropAll(std::vector<JournalPosition> positions) {\n  if (@) return;"),
    ("record-forgotten", "a restart does not know every record", REPLAY,
     "    if (!recorded.where.emplace(key, where).second) return;",
     "    if (@ && recorded.where.size() % 20 == 19) return;\n    if (!recorded.where.emplace(key, where).second) return;"),
    ("lock-not-taken", "two schedulers may share a state directory", DIRECTORY,
     "for (int tries = 0; flock(", "for (int tries = 0; !@ && flock("),
    ("lease-forgotten", "what a lost worker held is not given back", WORKERS,
     "  leases.giveBack(worker.id);\n  registry.remove(worker, how",
     "  if (!@) leases.giveBack(worker.id);\n  registry.remove(worker, how"),
    ("silence-is-death", "a silent worker is taken for dead, and its work for deadly", WORKERS,
     "  if (departed_.size() > most_departed) departed_.pop_front();",
     "  if (@) blame(leases.suspectsOf(worker.id, worker.solving));\n  if (departed_.size() > most_departed) departed_.pop_front();"),
    ("silence-unnoticed", "a worker that says nothing any more keeps what it holds", WORKERS,
     "void Workers::loseSilent() {", "void Workers::loseSilent() {\n  if (@) return;"),
    ("idle-unnoticed", "a job that was lost on its way stays with the worker that never got it", WORKERS,
     "void Workers::reclaimFromIdle() {", "void Workers::reclaimFromIdle() {\n  if (@) return;"),
    ("duplicate-acknowledged-early", "a second result is acknowledged before the first is on disk", INTAKE,
     "  const wire::Result& first = waiting.result;",
     "  const wire::Result& first = waiting.result;\n  if (@) state_.acknowledge(worker.peer, message);"),
    ("duplicate-unanswered", "a result that is recorded already is not acknowledged again", INTAKE,
     "      state_.acknowledge(worker.peer, message);\n      return", "      if (!@) state_.acknowledge(worker.peer, message);\n      return"),
    ("spare-forgotten", "results behind a lost one are asked for again", INTAKE,
     "    settle(\n        plan, unclaimed_,",
     "    UnclaimedResults none;\n    settle(\n        plan, @ ? none : unclaimed_,"),
    ("damage-refused", "one lost record makes the rest useless", INTAKE,
     "if (!state_.store.damaged() && ", "if ((@ || !state_.store.damaged()) && "),
    ("kept-out-forgotten", "a restart forgets who is kept out", STORE,
     "      kept_out_(tables_.keptOut()),", "      kept_out_(@ ? std::vector<KeptOut>() : tables_.keptOut()),"),
    ("lies-kept", "what somebody gave who is kept out stays recorded", STORE,
     "  if (theirs.empty()) return;", "  if (@ || theirs.empty()) return;"),
    ("checks-forgotten", "a restart forgets what others are to solve again", SECONDS,
     "      due_(state.tables.checks()) {}", "      due_(@ ? std::map<ResultKey, bool>() : state.tables.checks()) {}"),
    ("checks-before-results", "whoever seals beside a scheduler reads which checks are open before the results", RECORDED,
     "    tables_.emplace(directory_);", "    if (!@) tables_.emplace(directory_);"),
    ("nothing-checked", "no result is solved again by another", CHECKS,
     "  ++results_;\n", "  ++results_;\n  if (@) return false;\n"),
    ("one-decides", "of two who differ the later one is right", CHECKS,
     "  if (right.size() < 2) return false;", "  if (right.size() < (@ ? 1 : 2)) return false;"),
    ("restart-unnoticed", "a worker does not notice that the scheduler was restarted", SESSION,
     "  if (epoch_.empty() || reply.epoch() == epoch_) return;",
     "  if (@ || epoch_.empty() || reply.epoch() == epoch_) return;"),
    ("never-asks-again", "a request that was lost is not repeated", SESSION,
     "void WorkerSession::askAgain(bool solving, Time now) {", "void WorkerSession::askAgain(bool solving, Time now) {\n  if (@) return;"),
    ("never-delivers-again", "a result that was lost is not delivered again", SESSION,
     "void WorkerSession::deliverAgain(Time now) {", "void WorkerSession::deliverAgain(Time now) {\n  if (@) return;"),
    ("hung-for-ever", "a solver that hangs is not noticed", SESSION,
     "bool WorkerSession::solverHangs(Time now) {", "bool WorkerSession::solverHangs(Time now) {\n  if (@) return false;"),
]


def copy_with_defects(source: pathlib.Path) -> str:
    text = source.read_text()
    for name, _, file, old, new in DEFECTS:
        if not source.as_posix().endswith("/" + file):
            continue
        # If another defect was planted at the same place before, the text still occurs once in it.
        if text.count(old) != 1:
            sys.exit(f"{file}: the text of the defect {name} is there {text.count(old)} times, not once:\n{old}")
        text = text.replace(old, new.replace("@", f'::palpate::simulation::planted("{name}")'))
    declaration = "namespace palpate::simulation {\nbool planted(const char* defect);\n}\n"
    return f"{declaration}#line 1 \"{source}\"\n{text}"


if sys.argv[1:] == ["--list"]:
    for name, what, *_ in DEFECTS:
        print(f'{{"{name}", "{what}"}},')
elif len(sys.argv) == 3:
    copy = copy_with_defects(pathlib.Path(sys.argv[1]))
    pathlib.Path(sys.argv[2]).write_text(copy)
else:
    sys.exit(__doc__)
