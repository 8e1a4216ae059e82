#include "worker/verification/verify_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "worker/verification/case.hpp"

namespace palpate {
namespace {

using verification::Case;
using verification::Row;

struct VerifyOptions {
  std::vector<std::string> names;
  bool all = false;
  bool json = false;
};

/// The cases to run. Error when a name is part of no case's.
std::vector<Case> chosenCases(const VerifyOptions& options) {
  const std::vector<Case> known = verification::cases();
  const auto matches = [](const Case& problem, const std::string& name) {
    return std::string_view(problem.name).find(name) != std::string_view::npos;
  };
  for (const std::string& name : options.names)
    if (std::none_of(known.begin(), known.end(),
                     [&](const Case& problem) { return matches(problem, name); }))
      throw badInput(
          "there is no verification problem with \"{}\" in its name; palpate verify names them all",
          name);
  std::vector<Case> chosen;
  for (const Case& problem : known) {
    const bool wanted =
        options.names.empty() ||
        std::any_of(options.names.begin(), options.names.end(),
                    [&](const std::string& name) { return matches(problem, name); });
    if (wanted && (options.all || !problem.takes_long)) chosen.push_back(problem);
  }
  return chosen;
}

class TableOutput {
 public:
  void begin() const {
    fmt::print("{:<66} {:>14} {:>14}      {:>9} {:>9}\n", "", "computed", "reference", "deviation",
               "tolerance");
  }
  void print(const Case& problem, const std::vector<Row>& rows, double seconds) {
    fmt::print("{} ({:.1f} s)\n", problem.name, seconds);
    for (const Row& row : rows) {
      fmt::print("  {:<64} {:>14.8g} {:>14.8g} {:<4} {:>9.1e} {:>9.1e}  {}\n", row.name,
                 row.computed, row.reference, row.unit, row.deviation(), row.tolerance,
                 row.ok() ? "ok" : "NOT OK");
      ++(row.ok() ? good_ : bad_);
    }
    std::fflush(stdout);
    seconds_ += seconds;
  }
  void end() const { fmt::print("{} rows ok, {} not ok, {:.0f} s\n", good_, bad_, seconds_); }

 private:
  int good_ = 0, bad_ = 0;
  double seconds_ = 0;
};

void printJson(const Case& problem, const std::vector<Row>& rows, double seconds) {
  for (const Row& row : rows)
    fmt::print("{}\n", nlohmann::ordered_json{{"problem", problem.name},
                                              {"row", row.name},
                                              {"unit", row.unit},
                                              {"computed", row.computed},
                                              {"reference", row.reference},
                                              {"deviation", row.deviation()},
                                              {"tolerance", row.tolerance},
                                              {"ok", row.ok()},
                                              {"problem_seconds", seconds}}
                           .dump());
  std::fflush(stdout);
}

ExitCode verify(const VerifyOptions& options) {
  const std::vector<Case> chosen = chosenCases(options);
  TableOutput table;
  if (!options.json) table.begin();
  bool all_ok = true;
  for (const Case& problem : chosen) {
    const auto start = std::chrono::steady_clock::now();
    const std::vector<Row> rows = verification::rowsOf(problem);
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (options.json)
      printJson(problem, rows, seconds);
    else
      table.print(problem, rows, seconds);
    all_ok =
        all_ok && std::all_of(rows.begin(), rows.end(), [](const Row& row) { return row.ok(); });
  }
  if (!options.json) table.end();
  return all_ok ? ExitCode::done : ExitCode::failed;
}

std::function<ExitCode()> prepareVerify(CLI::App& app) {
  auto options = std::make_shared<VerifyOptions>();
  app.add_option("NAME", options->names, "Only the problems with this in their name")
      ->type_name("NAME");
  app.add_flag("--all", options->all, "Also the problems that take longer than seconds");
  app.add_flag("--json", options->json, "One JSON object per row");
  return [options] { return verify(*options); };
}

}  // namespace

const Verb verify_verb = {
    "verify", "Solve problems whose solution is known; print computed, reference and deviation",
    prepareVerify};

}  // namespace palpate
