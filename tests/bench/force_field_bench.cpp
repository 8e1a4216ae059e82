// How long one query of a force field takes, in nanoseconds, for a lattice of the paper (radius 100 mm,
// spacing 10 mm: 4169 configurations). Prints one JSON object. Nothing here is checked: times belong to the
// machine.
//
//   force_field_bench [SECONDS_PER_METHOD]

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <random>

#include "tests/support/sample_dataset.hpp"
#include "viewer/force_field.hpp"

namespace palpate {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double radius = 0.1, spacing = 0.01;

double nanoseconds(Clock::duration duration) {
  return std::chrono::duration<double, std::nano>(duration).count();
}

/// A hand's path: 1 kHz samples of a smooth curve through many cells, all of them covered.
std::vector<Eigen::Vector3d> path() {
  std::vector<Eigen::Vector3d> points;
  for (int n = 0; n < 10000; ++n) {
    const double t = 1e-3 * n;
    points.push_back(0.048 *
                     Eigen::Vector3d(std::sin(2.1 * t), std::sin(3.3 * t + 1), std::sin(1.3 * t + 2)));
  }
  return points;
}

/// As little locality as there is: random covered displacements.
std::vector<Eigen::Vector3d> scattered() {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> coordinate(-0.048, 0.048);
  std::vector<Eigen::Vector3d> points;
  for (int n = 0; n < 10000; ++n) {
    const double x = coordinate(random), y = coordinate(random), z = coordinate(random);
    points.emplace_back(x, y, z);
  }
  return points;
}

/// Median over repetitions of the mean time of a query.
double medianTime(const ForceField& field, const std::vector<Eigen::Vector3d>& points, double seconds,
                  double& sum) {
  std::vector<double> times;
  const Clock::time_point end =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  do {
    const Clock::time_point start = Clock::now();
    for (const Eigen::Vector3d& p : points) sum += field.evaluate(p).force.x();
    times.push_back(nanoseconds(Clock::now() - start) / static_cast<double>(points.size()));
  } while (Clock::now() < end);
  std::nth_element(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2), times.end());
  return times[times.size() / 2];
}

int runBenchmark(double seconds) {
  const Lattice lattice(radius, spacing);
  const SpaceTable space = test::solvedSpace(lattice, test::StiffeningEnergy());
  double sum = 0;
  std::string methods;
  for (const std::string& method : forceFieldMethods()) {
    const Clock::time_point start = Clock::now();
    const auto field = makeForceField(method, space);
    const double prepared = nanoseconds(Clock::now() - start);
    methods += fmt::format("{}\"{}\":{{\"path_ns\":{:.1f},\"scattered_ns\":{:.1f},\"prepare_ms\":{:.1f}}}",
                           methods.empty() ? "" : ",", method, medianTime(*field, path(), seconds / 2, sum),
                           medianTime(*field, scattered(), seconds / 2, sum), 1e-6 * prepared);
  }
  fmt::print("{{\"benchmark\":\"force_field\",\"configurations\":{},\"methods\":{{{}}},\"checksum\":{}}}\n",
             lattice.size(), methods, sum);
  return 0;
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  return palpate::runBenchmark(argc > 1 ? std::atof(argv[1]) : 1.0);
}
