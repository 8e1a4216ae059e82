#pragma once

#include <string>
#include <vector>

/// Verification problems: bodies whose solution is known on paper or published, solved with the
/// same System and Newton as everything else. `palpate verify` prints them,
/// tests/worker/verification/verify_test.cpp holds them to their tolerance. docs/verification.md
/// says what each is and where its reference comes from.
namespace palpate::verification {

/// One number and what it should be.
struct Row {
  std::string name;
  double computed = 0;
  double reference = 0;
  double tolerance = 0;  ///< for `deviation`
  const char* unit = "";

  /// |computed - reference|, relative to the reference unless that is zero. NaN when `computed` is.
  double deviation() const;
  bool ok() const { return deviation() <= tolerance; }
};

/// These rows one after another.
std::vector<Row> joined(const std::vector<std::vector<Row>>& parts);

/// Observed order of convergence: log2 of the ratio of two errors, the second with half the element
/// size.
double orderOf(double coarse_error, double fine_error);

/// How a number that two meshes give, the second with half the element size, tends to what is
/// exact: its order, which should be 2, and its extrapolation by that order. `unit` is that of the
/// number.
std::vector<Row> rowsOfSecondOrder(const std::string& name, double coarse, double fine,
                                   double exact, const char* unit);

/// One problem: some rows that are computed together.
struct Case {
  const char* name;  ///< lower case, words joined by hyphens
  bool takes_long;   ///< more than a few seconds: only with --all
  std::vector<Row> (*run)();
};

/// All cases in the order of docs/verification.md.
std::vector<Case> cases();

/// Hard cases of the solver (`palpate verify --hard`): how far each gets, and its force beside the
/// reference.
std::vector<Case> hardCases();

/// The rows of one case. A solve that does not converge, or another error, becomes one row that is
/// not ok and says what happened.
std::vector<Row> rowsOf(const Case& problem);

/// The cases of one subject, one function per file of this folder.
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
