#include "tests/verification/case.hpp"

#include <cmath>
#include <exception>
#include <limits>

namespace palpate::verification {

double Row::deviation() const {
  const double difference = std::abs(computed - reference);
  return reference == 0 ? difference : difference / std::abs(reference);
}

std::vector<Row> joined(const std::vector<std::vector<Row>>& parts) {
  std::vector<Row> all;
  for (const std::vector<Row>& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

double orderOf(double coarse_error, double fine_error) {
  return std::log2(coarse_error / fine_error);
}

std::vector<Row> rowsOfSecondOrder(const std::string& name, double coarse, double fine,
                                   double exact, const char* unit) {
  return {{name + ", order", orderOf(coarse - exact, fine - exact), 2, 0.1},
          {name + ", extrapolated", (4 * fine - coarse) / 3, exact, 0.005, unit}};
}

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const auto subject : {homogeneousCases, manufacturedCases, infSupCases, cookCases,
                             punchCases, torsionCases, inflationCases, elasticaCases,
                             limitPointCases, reactionCases, contactStiffnessCases, interfaceCases})
    for (const Case& problem : subject()) all.push_back(problem);
  return all;
}

std::vector<Row> rowsOf(const Case& problem) {
  try {
    return problem.run();
  } catch (const std::exception& error) {
    constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
    return {{std::string(problem.name) + ": " + error.what(), nothing, 0, 0}};
  }
}

}  // namespace palpate::verification
