#include "scheduler/state/inspection.hpp"

#include <algorithm>
#include <set>

#include "common/base/number_text.hpp"
#include "common/wire/wire.hpp"

namespace palpate {
namespace {

/// Returns the problem that a database stores; none if it cannot be read. Other parts of the
/// database may be damaged.
std::optional<Problem> problemIn(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) return std::nullopt;
  try {
    Database database(file, Database::Access::read_untouched);
    Statement query(database, "SELECT value FROM meta WHERE key = 'problem'");
    return query.step() ? std::optional(decodeProblem(query.text(0))) : std::nullopt;
  } catch (const Error&) {
    return std::nullopt;
  }
}

/// Inspects one state directory step by step; the results are in `found_`.
class Inspector {
 public:
  Inspector(std::filesystem::path directory, std::optional<std::string> scheduler)
      : directory_(std::move(directory)), journal_(directory_) {
    found_.scheduler = std::move(scheduler);
  }

  Inspection look() {
    // Read the tables before the journal. A scheduler writes them after the journal, so the journal
    // must then hold at least as many results as the tables count.
    readTables();
    readJournal();
    if (found_.segments == 0 && found_.tables != Inspection::TableState::whole)
      throw badInput("{}: is not a state directory of Palpate: it has no journal, and {}",
                     directory_.string(),
                     found_.tables_text.empty() ? "no state.db" : found_.tables_text);
    if (!found_.problem) salvageProblem();
    if (found_.problem) replay();
    if (!found_.scheduler && told_ > recorded_.size())
      found_.lost_results = told_ - recorded_.size();
    listLeftovers();
    return std::move(found_);
  }

 private:
  void readTables() {
    const std::filesystem::path file = StateDirectory::databaseIn(directory_);
    std::error_code none;
    if (const auto size = std::filesystem::file_size(file, none); none || size == 0) {
      found_.tables = Inspection::TableState::missing;
      return;
    }
    try {
      // A running scheduler has already created SQLite's index of its log, so read_only changes
      // nothing.
      StoredTables tables(directory_, found_.scheduler ? Database::Access::read_only
                                                       : Database::Access::read_untouched);
      tables.verify();
      const StoredBuild& build = tables.build();
      std::optional<Problem> problem = problemOf(build);
      if (!problem)
        throw DamagedDatabase(file, "its problem is damaged or does not match its build id");
      found_.build = build.build;
      found_.scene_name = build.scene_name;
      found_.problem = std::move(problem);
      told_ = tables.progress().value_or(Progress()).recorded;
    } catch (const DamagedDatabase& damage) {
      found_.tables = Inspection::TableState::damaged;
      found_.tables_text = damage.what();
    }
  }

  void readJournal() {
    JournalScan scan = journal_.scan(
        [&](const JournalPosition& where, std::string_view header) { readRecord(where, header); });
    found_.end = scan.end;
    for (const std::uint32_t segment : journal_.segments()) {
      ++found_.segments;
      found_.bytes += std::filesystem::file_size(journal_.segmentPath(segment));
      if (segment == scan.end.segment)
        found_.unfinished =
            std::filesystem::file_size(journal_.segmentPath(segment)) - scan.end.offset;
    }
    for (JournalGap& gap : scan.gaps) takeGap(gap);
  }

  void takeGap(JournalGap& gap) {
    if (gap.kind == JournalGap::Kind::dropped) return found_.dropped.push_back(std::move(gap.text));
    JournalDamage damage{gap.where, std::move(gap.text), std::nullopt};
    try {
      wire::Result result;
      if (gap.kind == JournalGap::Kind::damaged &&
          result.ParseFromString(journal_.readHeader(gap.where)))
        damage.key = keyOf(result);
    } catch (const DamagedRecord&) {
      // Not even a header can be read in this gap, so the key of the lost result stays unknown.
    }
    found_.damage.push_back(std::move(damage));
  }

  void readRecord(const JournalPosition& where, std::string_view header_bytes) {
    const auto add = [&](std::vector<JournalDamage>& list, const std::string& what,
                         const std::optional<ResultKey>& key) {
      list.push_back({where,
                      fmt::format("{}: the record at byte {}: {}",
                                  journal_.segmentPath(where.segment).string(), where.offset, what),
                      key});
    };
    wire::Result header;
    if (!header.ParseFromArray(header_bytes.data(), static_cast<int>(header_bytes.size())) ||
        !fromWire(header))
      return add(found_.damage, "an invalid result", std::nullopt);
    const ResultKey key = keyOf(header);
    if (!found_.build) found_.build = ContentId::fromBytes(header.build());
    if (!found_.build || header.build() != found_.build->bytes())
      return add(found_.foreign, "a result of another build", key);
    try {
      const std::string payload = journal_.read(where).payload;
      if (const std::string what = objectionToFields(header, payload); !what.empty())
        return add(found_.damage, what, key);
    } catch (const DamagedRecord& damage) {
      found_.damage.push_back({where, damage.what(), key});
      return;
    }
    ++found_.records;
    if (recorded_.emplace(key, where).second) in_order_.push_back(key);
  }

  /// Checks the nodal fields of a result, because later transitions start from them. Returns what
  /// is wrong with them, or an empty string.
  std::string objectionToFields(const wire::Result& result, const std::string& payload) const {
    if (payload.size() != result.payload_bytes())
      return "its payload differs in length from its header";
    if (!result.has_equilibrium()) return "";
    if (ContentId::of(payload).bytes() != result.fields_id())
      return "its payload does not match the content id in its header";
    if (!found_.problem) return "";
    try {
      NodalFields::decode(payload, found_.problem->mesh.nodes.size(),
                          found_.problem->pressures.count());
      return "";
    } catch (const Error& error) {
      return error.what();
    }
  }

  /// Reads the problem from the tables even if other parts of them are damaged, or else from
  /// damaged tables that were renamed to state.db.damaged.
  void salvageProblem() {
    for (const char* part : {"", ".damaged"}) {
      std::optional<Problem> problem =
          problemIn(StateDirectory::databaseIn(directory_).string() + part);
      if (!problem) continue;
      const ContentId id = problemId(*problem);
      if (found_.build.value_or(id) != id) continue;
      found_.build = id;
      found_.scene_name = problem->scene.name;
      found_.problem = std::move(problem);
      return;
    }
  }

  void replay() {
    const auto read = [&](const ResultKey& key) { return readRecorded(journal_, recorded_, key); };
    Replay replayed(*found_.problem);
    for (const ResultKey& key : in_order_)
      if (const auto result = read(key))
        if (const auto outcome = fromWire(*result)) replayed.take(key, *result, *outcome);
    replayed.finish(read);
    found_.spare = replayed.unclaimed.size();
    for (const JournalDamage& damage : found_.damage)
      if (damage.key && damage.key->space < found_.problem->active.size())
        lost_.emplace(damage.key->space, damage.key->target);
    for (const auto& [space, point] : lost_)
      found_.lost.push_back({found_.problem->active[space].name, point,
                             replayed.plans[space].positions().divisions()});
  }

  void listLeftovers() {
    const std::set<std::string> known = {"state.db.damaged", "lock.tmp", "endpoint.tmp"};
    for (const auto& entry : std::filesystem::directory_iterator(directory_))
      if (known.contains(entry.path().filename().string()))
        found_.leftovers.push_back(entry.path().string());
    std::ranges::sort(found_.leftovers);
  }

  std::filesystem::path directory_;
  JournalReader journal_;
  std::size_t told_ = 0;  ///< number of results according to the tables
  ResultIndex recorded_;
  std::vector<ResultKey> in_order_;  ///< in the order of recording
  std::set<std::pair<std::uint32_t, LatticePoint>> lost_;
  Inspection found_;
};

void refuseSeveralBuilds(const StateDirectory& held, const Inspection& found) {
  if (found.foreign.empty()) return;
  throw failure(
      "{}: found {} of another build (the first: {}); nothing was changed: move the segments of the "
      "other build elsewhere, or remove the segments that you do not need",
      held.path().string(), counted(found.foreign.size(), "record"), found.foreign.front().text);
}

}  // namespace

bool Inspection::whole() const {
  const bool left_over = spare > 0 && dropped.empty();
  return damage.empty() && foreign.empty() && lost_results == 0 && !left_over &&
         tables != TableState::damaged;
}

Inspection inspect(const std::filesystem::path& directory) {
  if (!std::filesystem::is_directory(directory))
    throw badInput("{}: is not a state directory of Palpate: no directory", directory.string());
  const auto scheduler = StateDirectory::holder(directory);
  Inspection found = Inspector(directory, scheduler).look();
  // A scheduler that started in the meantime changed the files that were being read: inspect again.
  if (const auto begun = StateDirectory::holder(directory); !scheduler && begun)
    found = Inspector(directory, begun).look();
  return found;
}

Inspection inspect(const StateDirectory& held) {
  return Inspector(held.path(), std::nullopt).look();
}

std::vector<std::string> repair(const StateDirectory& held, const Inspection& found) {
  refuseSeveralBuilds(held, found);
  std::vector<std::string> done;
  Journal journal(held.path(), found.end);
  if (found.unfinished > 0)
    done.push_back(fmt::format("{} bytes after the last record removed", found.unfinished));
  journal.fillMissing();
  for (const JournalDamage& damage : found.damage)
    if (damage.where.length > 0) journal.drop(damage.where);
  if (!found.damage.empty())
    done.push_back(
        fmt::format("dropped {} of the journal", counted(found.damage.size(), "damaged place")));
  using TableState = Inspection::TableState;
  const std::filesystem::path tables = held.database();
  if (found.tables == TableState::damaged) {
    putTablesAside(held);
    done.push_back(fmt::format("{0} renamed to {0}.damaged", tables.string()));
  }
  const bool outdated =
      found.tables != TableState::whole || found.lost_results > 0 || !found.damage.empty();
  if (!outdated || !found.problem) return done;
  Tables(held, *found.problem).forgetProgress();
  if (found.tables != TableState::whole) done.push_back(fmt::format("{} created", tables.string()));
  if (found.lost_results > 0)
    done.push_back(
        fmt::format("the tables no longer count {}", counted(found.lost_results, "lost result")));
  return done;
}

}  // namespace palpate
