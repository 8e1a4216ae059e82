#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "common/base/program.hpp"
#include "tests/verification/case.hpp"
#include "worker/elements/blas_kernels.hpp"

namespace palpate {
namespace {

using verification::Case;
using verification::Row;

struct VerifyOptions {
  std::vector<std::string> names;
  bool all = false, hard = false;
  bool json = false;

  void addTo(CLI::App& app) {
    app.add_option("NAME", names, "Run only problems with this in their name")->type_name("NAME");
    app.add_flag("--all", all, "Also run problems that take more than a few seconds");
    app.add_flag("--hard", hard, "Run the hard cases of the solver instead");
    app.add_flag("--json", json, "One JSON object per row");
  }
};

/// Returns the cases to run. Error if a name matches no case.
std::vector<Case> chosenCases(const VerifyOptions& options) {
  std::vector<Case> chosen = options.hard ? verification::hardCases() : verification::cases();
  const auto has = [](const std::string& name) {
    return [&](const Case& problem) {
      return std::string_view(problem.name).find(name) != std::string_view::npos;
    };
  };
  // A misspelt name must not look like a successful run.
  for (const std::string& name : options.names)
    if (std::ranges::none_of(chosen, has(name)))
      throw badInput(
          "there is no verification problem with \"{}\" in its name; palpate verify lists them all",
          name);
  std::erase_if(chosen, [&](const Case& problem) {
    const bool wanted =
        options.names.empty() ||
        std::ranges::any_of(options.names, [&](const auto& name) { return has(name)(problem); });
    return !wanted || (problem.takes_long && !options.all);
  });
  return chosen;
}

void printRowsTable(const Case& problem, const std::vector<Row>& rows, double seconds) {
  fmt::print("{} ({:.1f} s)\n", problem.name, seconds);
  for (const Row& row : rows)
    fmt::print("  {:<64} {:>14.8g} {:>14.8g} {:<4} {:>9.1e} {:>9.1e}  {}\n", row.name, row.computed,
               row.reference, row.unit, row.deviation(), row.tolerance, row.ok() ? "ok" : "NOT OK");
}

void printRowsJson(const Case& problem, const std::vector<Row>& rows, double seconds) {
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
}

ExitCode verify(const VerifyOptions& options) {
  const std::vector<Case> chosen = chosenCases(options);
  if (!options.json)
    fmt::print("{:<66} {:>14} {:>14}      {:>9} {:>9}\n", "", "computed", "reference", "deviation",
               "tolerance");
  std::ptrdiff_t good = 0, bad = 0;
  double all_seconds = 0;
  for (const Case& problem : chosen) {
    const auto start = std::chrono::steady_clock::now();
    const std::vector<Row> rows = verification::rowsOf(problem);
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    (options.json ? printRowsJson : printRowsTable)(problem, rows, seconds);
    std::fflush(stdout);  // the next problem may take minutes
    good += std::ranges::count_if(rows, &Row::ok);
    bad += std::ranges::count(rows, false, &Row::ok);
    all_seconds += seconds;
  }
  if (!options.json) fmt::print("{} rows ok, {} not ok, {:.0f} s\n", good, bad, all_seconds);
  return bad == 0 ? ExitCode::done : ExitCode::failed;
}

/// `palpate verify [NAME...] [--all | --hard] [--json]`: exit 0 if all rows are within their
/// tolerance, else 1.
const Verb verify_verb = {
    "verify", "Solve problems with known solutions; print computed, reference and deviation",
    prepareVerb<VerifyOptions, verify>};

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  palpate::chooseBlasKernels(argv);
  return palpate::runProgram(argc, argv, "palpate-verify: computed results beside known solutions",
                             std::array{palpate::verify_verb});
}
