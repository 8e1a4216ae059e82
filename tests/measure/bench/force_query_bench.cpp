// Query times of the force fields of a sealed dataset for given displacements, one query at a time
// in this process, with their answers and the memory of each field. Prints one JSON object.
// scipy_bench measures SciPy with the same points and displacements. Checks nothing, because times
// depend on the machine.
//
//   palpate_force_query_bench DATASET ACTIVE METHOD... < DISPLACEMENTS
//
// DISPLACEMENTS: one line "x y z" each, metres.

#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <iostream>
#include <nlohmann/json.hpp>

#include "common/base/error.hpp"
#include "common/dataset/dataset.hpp"
#include "common/scene/active_choice.hpp"
#include "viewer/fields/field_choice.hpp"

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

Json toJson(const Eigen::Vector3d& v) { return {v[0], v[1], v[2]}; }

/// Processor time of this thread, which depends little on other programs.
double cpuSeconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Median, over passes through all displacements, of a query's mean time in nanoseconds.
double medianTime(const ForceField& field, const std::vector<Eigen::Vector3d>& displacements) {
  std::vector<double> times;
  double sum = 0;
  for (const double start = cpuSeconds(); times.size() < 5 || cpuSeconds() - start < 0.5;) {
    const double pass = cpuSeconds();
    for (const Eigen::Vector3d& p : displacements) sum += field.evaluate(p).force.x();
    times.push_back(1e9 * (cpuSeconds() - pass) / static_cast<double>(displacements.size()));
  }
  std::nth_element(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2),
                   times.end());
  // Uses the sum, so that the compiler keeps the queries.
  return std::isfinite(sum) ? times[times.size() / 2] : 0;
}

/// Bytes that the program has allocated and not freed.
std::size_t bytesInUse() {
  const struct mallinfo2 info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

Json measure(const std::string& method, const SpaceTable& space,
             const std::vector<Eigen::Vector3d>& displacements) {
  const std::size_t before = bytesInUse();
  const double start = cpuSeconds();
  const auto field = makeForceField(method, space);
  Json result;
  result["prepare_s"] = cpuSeconds() - start;
  result["field_bytes"] = bytesInUse() - before;
  result["query_ns"] = medianTime(*field, displacements);
  for (const Eigen::Vector3d& p : displacements)
    result["force"].push_back(toJson(field->evaluate(p).force));
  return result;
}

int runBenchmark(const std::vector<std::string>& arguments) {
  if (arguments.size() < 2)
    throw badInput("usage: palpate_force_query_bench DATASET ACTIVE METHOD... < DISPLACEMENTS");
  const Dataset dataset(arguments[0]);
  const SpaceTable& space =
      dataset.spaces()[chooseActive(dataset.scene(), arguments[1]).spaces.front()];
  std::vector<Eigen::Vector3d> displacements;
  for (double x = 0, y = 0, z = 0; std::cin >> x >> y >> z;) displacements.emplace_back(x, y, z);

  Json answer;
  answer["spacing"] = space.lattice.spacing();
  answer["radius"] = space.lattice.radius();
  for (std::int32_t n = 0; n < space.lattice.size(); ++n) {
    if (!isSolved(space.points[n].tag)) continue;
    answer["point"].push_back(toJson(space.lattice.displacement(n)));
    answer["point_force"].push_back(toJson(space.points[n].equilibrium.force));
  }
  for (std::size_t m = 2; m < arguments.size(); ++m)
    answer["methods"][arguments[m]] = measure(arguments[m], space, displacements);
  std::cout << answer.dump() << '\n';
  return 0;
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  try {
    return palpate::runBenchmark({argv + 1, argv + argc});
  } catch (const std::exception& error) {
    fmt::print(stderr, "palpate_force_query_bench: {}\n", error.what());
    return 1;
  }
}
