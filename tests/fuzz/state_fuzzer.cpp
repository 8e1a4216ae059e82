#include <algorithm>
#include <filesystem>

#include "scheduler/builds/build.hpp"
#include "scheduler/service/coordinator.hpp"
#include "scheduler/state/inspection.hpp"
#include "tests/fuzz/light_sqlite.hpp"
#include "tests/support/scanned_journal.hpp"
#include "tests/support/solved_table.hpp"
#include "tests/support/temporary_directory.hpp"

namespace palpate::fuzz {
namespace {

/// Use of the directory after its changes.
enum StateUse : unsigned char {
  checks,
  reads,  ///< the other contents of the tables
  repairs,
  goes_on,     ///< continues the build
  does_it_all  ///< all of these, one after the other
};
/// Chosen by the first byte of an input. Mostly a single use, and rarely the slowest, because every
/// use reads the directory first.
constexpr StateUse uses[] = {does_it_all, repairs, goes_on, goes_on, checks, checks,
                             checks,      checks,  reads,   reads,   reads,  reads};
constexpr unsigned char numberOf(StateUse use) {
  return static_cast<unsigned char>(std::ranges::find(uses, use) - std::begin(uses));
}

/// Changes of a state directory, chosen by their first byte.
enum StateChange : unsigned char {
  overwrites_tables,   ///< bytes of state.db from an offset on
  overwrites_journal,  ///< bytes of the segment from an offset on
  cuts_tables,         ///< truncates to a length
  cuts_journal,
  appends_record,   ///< a header and a payload as a record with valid checksums
  appends_changed,  ///< the first result with some fields overwritten, with valid checksums
  changes_row,      ///< a number in counters, losses or progress
  changes_meta,     ///< a value of meta
  changes_file,     ///< content of lock or endpoint
  state_changes
};

constexpr const char* numbers_in_tables[] = {
    "INSERT OR REPLACE INTO counters VALUES ('runs', ?)",
    "INSERT OR REPLACE INTO counters VALUES ('bad_messages', ?)",
    "INSERT OR REPLACE INTO losses VALUES (?, 0, 0, 1, 1, 1)",
    "INSERT OR REPLACE INTO losses VALUES (0, ?, 0, 1, 1, 1)",
    "INSERT OR REPLACE INTO losses VALUES (0, 0, 0, ?, 1, 1)",
    "INSERT OR REPLACE INTO losses VALUES (0, 0, 0, 1, 1, ?)",
    "INSERT OR REPLACE INTO meta VALUES ('recorded', ?)"};
constexpr const char* texts_in_meta[] = {"build", "scene_name", "problem", "status"};

/// A directory with a few results, created once, and copies of it.
class FuzzedState {
 public:
  FuzzedState() {
    std::filesystem::remove_all(copy());
    std::filesystem::copy(original().path() / "state", copy());
  }

  void follow(Choices& choices) {
    switch (choices.oneOf(state_changes)) {
      case overwrites_tables: return overwrite(tables(), choices);
      case overwrites_journal: return overwrite(segment(), choices);
      case cuts_tables: return cut(tables(), choices.take<std::uint32_t>());
      case cuts_journal: return cut(segment(), choices.take<std::uint32_t>());
      case appends_record: {
        const std::string_view header = choices.takeBytes();
        return append(header, choices.takeBytes());
      }
      case appends_changed: return appendChanged(choices.takeBytes());
      case changes_row: {
        const char* const sql = numbers_in_tables[choices.oneOf(std::size(numbers_in_tables))];
        return changeTables(sql, choices.take<std::int64_t>());
      }
      case changes_meta: {
        const char* const key = texts_in_meta[choices.oneOf(std::size(texts_in_meta))];
        return changeTables(fmt::format("UPDATE meta SET value = ? WHERE key = '{}'", key),
                            choices.takeBytes());
      }
      case changes_file: {
        const char* const name = choices.oneOf(2) == 0 ? "lock" : "endpoint";
        return putInto(copy() / name, choices.takeBytes());
      }
      default: return;
    }
  }

  /// All uses of a directory: inspect it, inspect it again while it is locked, repair it, and
  /// continue the build.
  static void use(StateUse how) {
    switch (how) {
      case checks: return check();
      case reads: return read();
      case repairs: return repairIt();
      case goes_on: return goOn();
      default: break;
    }
    for (const auto step : {check, read}) try {
        step();
      } catch (const Error&) {
        // The tables may be damaged or of another version.
      }
    repairIt();
    goOn();
  }

 private:
  static void check() {
    StateDirectory::liveAddress(copy());
    inspect(copy());
  }
  static void read() {
    StoredTables stored(copy());
    stored.servers();
    stored.counters();
    stored.progress();
  }
  static void repairIt() {
    const StateDirectory held(copy());
    StateDirectory::liveAddress(copy());
    repair(held, inspect(held));
    const Inspection again = inspect(held);
    require(again.tables != Inspection::TableState::damaged && again.lost_results == 0,
            "repaired tables are not whole");
  }
  static void goOn() {
    constexpr auto now = Coordinator::Time() + std::chrono::hours(1);
    Build build(problem(), copy(), now);
    build.coordinator().advance(now);
  }

  static const Problem& problem() {
    static const Problem cube = test::smallCubeProblem();
    return cube;
  }
  static const test::TemporaryDirectory& original() {
    static const test::TemporaryDirectory directory;
    static const bool made = [] {
      const StateDirectory state(directory.path() / "state");
      JobStore store(state, problem());
      const auto now = Coordinator::Time() + std::chrono::hours(1);
      Coordinator coordinator(problem(), encodeProblem(problem()), store, now);
      for (const auto& [header, payload] : firstResults()) store.append(header, payload);
      store.commit();
      return true;
    }();
    require(made, "there is a directory to begin with");
    return directory;
  }
  static std::filesystem::path copy() { return original().path() / "copy"; }
  static std::filesystem::path tables() { return copy() / "state.db"; }
  static std::filesystem::path segment() { return copy() / "segment-000001.dat"; }

  /// Results of both origins and of the neighbours of the first.
  static const std::vector<std::pair<wire::Result, std::string>>& firstResults() {
    static const std::vector<std::pair<wire::Result, std::string>> found = [] {
      std::vector<std::pair<wire::Result, std::string>> results = {
          test::solve(problem(), 0, {0, 0, 0}, {0, 0, 0}),
          test::solve(problem(), 1, {0, 0, 0}, {0, 0, 0})};
      for (const LatticePoint& target : {LatticePoint{-1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {0, 0, 1}})
        results.push_back(test::solve(problem(), 0, target, {0, 0, 0}));
      return results;
    }();
    return found;
  }

  static void overwrite(const std::filesystem::path& file, Choices& choices) {
    std::string content = bytesIn(file);
    const std::size_t offset = choices.take<std::uint32_t>() % (content.size() + 1);
    const std::string_view bytes = choices.takeBytes().substr(0, content.size() - offset);
    content.replace(offset, bytes.size(), bytes);
    putInto(file, content);
  }
  static void cut(const std::filesystem::path& file, std::uint32_t length) {
    std::filesystem::resize_file(
        file, std::min<std::uintmax_t>(length, std::filesystem::file_size(file)));
  }
  static void append(std::string_view header, std::string_view payload) {
    Journal(copy(), test::scanned(JournalReader(copy())).end).append(header, payload);
  }
  static void appendChanged(std::string_view changes) {
    auto [result, payload] = firstResults().front();
    wire::Result other;
    if (other.ParseFromArray(changes.data(), static_cast<int>(changes.size())))
      result.MergeFrom(other);
    append(result.SerializeAsString(), payload);
  }
  template <class Value>
  static void changeTables(const std::string& sql, const Value& value) {
    Database database(tables(), Database::Access::read_write_create);
    Statement(database, sql).run(value);
  }
};

void useState(std::string_view bytes) {
  Choices choices(bytes);
  FuzzedState state;
  const StateUse use = uses[choices.oneOf(std::size(uses))];
  for (int changes = 0; changes < 8 && !choices.done(); ++changes) state.follow(choices);
  FuzzedState::use(use);
}

std::vector<std::string> stateSeeds() {
  wire::Result other_build, far, failed;
  other_build.set_build(std::string(32, 'x'));
  far.mutable_target()->set_i(2000000000);
  far.set_space(7);
  failed.mutable_failure()->set_cause(3);
  std::vector<std::string> changes = {
      "",
      Script().op(overwrites_tables).put(std::uint32_t{40}).putBytes("damaged").text(),
      Script().op(overwrites_journal).put(std::uint32_t{700}).putBytes("damaged").text(),
      Script().op(cuts_tables).put(std::uint32_t{5000}).text(),
      Script().op(cuts_journal).put(std::uint32_t{900}).text(),
      Script().op(appends_record).putBytes("header").putBytes("payload").text(),
      Script().op(changes_row).op(0).put(std::int64_t{1} << 40).text(),
      Script().op(changes_row).op(6).put(std::int64_t{5}).text(),
      Script().op(changes_row).op(6).put(std::int64_t{1} - (std::int64_t{1} << 32)).text(),
      Script().op(changes_meta).op(2).putBytes("no problem").text(),
      Script().op(changes_file).op(1).putBytes("tcp://127.0.0.1:1\n").text()};
  for (const wire::Result& result : {other_build, far, failed})
    changes.push_back(Script().op(appends_changed).putBytes(result.SerializeAsString()).text());
  // Each change with all uses in turn, then each other use of the unchanged directory.
  std::vector<std::string> seeds;
  for (const std::string& change : changes)
    seeds.push_back(Script().op(numberOf(does_it_all)).text() + change);
  for (const StateUse use : {checks, reads, repairs, goes_on})
    seeds.push_back(Script().op(numberOf(use)).text());
  return seeds;
}

const Registration state_fuzzer({"state", useState, stateSeeds, makeSqliteLight});

}  // namespace
}  // namespace palpate::fuzz
