#include "worker/verification/case.hpp"

#include <cmath>
#include <exception>
#include <limits>

namespace palpate::verification {

double Row::deviation() const {
  const double difference = std::abs(computed - reference);
  return reference == 0 ? difference : difference / std::abs(reference);
}

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const auto subject :
       {homogeneousCases, manufacturedCases, infSupCases, cookCases, punchCases, torsionCases,
        inflationCases, elasticaCases, limitPointCases, reactionCases, contactStiffnessCases})
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
