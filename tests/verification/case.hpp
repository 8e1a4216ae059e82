#pragma once

#include <string>
#include <vector>

/// Verification problems: bodies with a closed-form or published solution, solved with the same
/// System and Newton as all other problems. `palpate verify` prints the results, and
/// tests/worker/verify_test.cpp checks their tolerances. docs/verification.md
/// describes each problem and the source of its reference.
namespace palpate::verification {

/// One computed number and its reference.
struct Row {
  std::string name;
  double computed = 0;
  double reference = 0;
  double tolerance = 0;  ///< largest accepted deviation()
  const char* unit = "";

  /// Returns |computed - reference|, relative to the reference unless that is zero. NaN if
  /// `computed` is NaN.
  double deviation() const;
  bool ok() const { return deviation() <= tolerance; }
};

/// Returns the rows of all parts, in this order.
std::vector<Row> joined(const std::vector<std::vector<Row>>& parts);

/// Returns the observed order of convergence: log2 of the ratio of two errors, where the second has
/// half the element size.
double orderOf(double coarse_error, double fine_error);

/// Compares the results of two meshes, of which the second has half the element size, with the
/// exact value. Returns a row for the order of convergence, which should be 2, and a row for the
/// value extrapolated with that order. `unit` is the unit of the value.
std::vector<Row> rowsOfSecondOrder(const std::string& name, double coarse, double fine,
                                   double exact, const char* unit);

/// One problem: rows that are computed together.
struct Case {
  const char* name;  ///< lower case, words joined by hyphens
  bool takes_long;   ///< takes more than a few seconds: run only with --all
  std::vector<Row> (*run)();
};

/// Returns all cases in the order of docs/verification.md.
std::vector<Case> cases();

/// Returns the hard cases of the solver (`palpate verify --hard`). Their rows say how much of its
/// path each tool covered, and compare the force with the reference.
std::vector<Case> hardCases();

/// Returns the rows of one case. A solve that does not converge, or another error, becomes one
/// failed row with the message.
std::vector<Row> rowsOf(const Case& problem);

/// Return the cases of one subject; one function per file of this folder.
std::vector<Case> homogeneousCases();
std::vector<Case> manufacturedCases();
std::vector<Case> infSupCases();
std::vector<Case> cookCases();
std::vector<Case> punchCases();
std::vector<Case> torsionCases();
std::vector<Case> inflationCases();
std::vector<Case> elasticaCases();
std::vector<Case> limitPointCases();
std::vector<Case> reactionCases();
std::vector<Case> contactStiffnessCases();
std::vector<Case> interfaceCases();

}  // namespace palpate::verification
