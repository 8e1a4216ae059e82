// Time of one query of a force field, or of all displacements of 2228 nodes. Prints one JSON
// object. Checks nothing, because times depend on the machine. For each method and number of
// configurations (a ball of 100 mm):
//
//   path_ns       a hand's path: 1 kHz samples of a smooth curve through many cells
//   scattered_ns  random displacements, with the least possible locality in one space
//   cold_ns       random displacements, each after clearing the caches: the first touch
//   prepare_ms    the constructor
//
//   force_field_bench [SECONDS_PER_NUMBER]

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <random>

#include "tests/support/sample_dataset.hpp"
#include "viewer/fields/displacement_field.hpp"
#include "viewer/fields/field_choice.hpp"

namespace palpate {
namespace {

using Clock = std::chrono::steady_clock;
/// The returned value only keeps the compiler from removing the work.
using Query = std::function<double(const Eigen::Vector3d&)>;

constexpr double radius = 0.1;
// Memory of global radial functions grows with the square of the points, time with the cube.
constexpr std::int32_t most_radial_points = 1500;

double nanoseconds(Clock::duration duration) {
  return std::chrono::duration<double, std::nano>(duration).count();
}

double median(std::vector<double> times) {
  const auto middle = times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2);
  std::nth_element(times.begin(), middle, times.end());
  return *middle;
}

std::vector<Eigen::Vector3d> path(int count) {
  std::vector<Eigen::Vector3d> points;
  for (int n = 0; n < count; ++n) {
    const double t = 1e-3 * n;
    points.push_back(
        0.048 * Eigen::Vector3d(std::sin(2.1 * t), std::sin(3.3 * t + 1), std::sin(1.3 * t + 2)));
  }
  return points;
}

std::vector<Eigen::Vector3d> scattered(int count) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> coordinate(-0.048, 0.048);
  std::vector<Eigen::Vector3d> points;
  for (int n = 0; n < count; ++n) {
    const double x = coordinate(random), y = coordinate(random), z = coordinate(random);
    points.emplace_back(x, y, z);
  }
  return points;
}

double checksum = 0;

/// Median over repetitions of a query's mean time.
double hotTime(const Query& query, const std::vector<Eigen::Vector3d>& points, double seconds) {
  std::vector<double> times;
  for (const Clock::time_point begin = Clock::now();
       times.size() < 3 || nanoseconds(Clock::now() - begin) < 1e9 * seconds;) {
    const Clock::time_point start = Clock::now();
    for (const Eigen::Vector3d& p : points) checksum += query(p);
    times.push_back(nanoseconds(Clock::now() - start) / static_cast<double>(points.size()));
  }
  return median(times);
}

/// Median of single queries, each after writing more memory than any cache holds.
double coldTime(const Query& query) {
  static std::vector<char> other(std::size_t{128} << 20);
  std::vector<double> times;
  for (const Eigen::Vector3d& p : scattered(60)) {
    for (std::size_t i = 0; i < other.size(); i += 64) ++other[i];
    const Clock::time_point start = Clock::now();
    checksum += query(p);
    times.push_back(nanoseconds(Clock::now() - start));
  }
  std::vector<double> clock;
  for (int n = 0; n < 1000; ++n) {
    const Clock::time_point start = Clock::now();
    clock.push_back(nanoseconds(Clock::now() - start));
  }
  return median(times) - median(clock);
}

std::string methodResult(const std::string& method, const SpaceTable& space, double seconds) {
  const Clock::time_point start = Clock::now();
  const auto field = makeForceField(method, space);
  const double prepared = nanoseconds(Clock::now() - start);
  // Clients pay for the virtual call too; the std::function around it costs about a nanosecond
  // more.
  const Query query = [&](const Eigen::Vector3d& p) { return field->evaluate(p).force.x(); };
  return fmt::format(
      "{{\"method\":\"{}\",\"configurations\":{},\"path_ns\":{:.1f},\"scattered_ns\":{:.1f},\"cold_ns\":{:.0f},\"prepare_ms\":{:.1f}}}",
      method, space.lattice.size(), hotTime(query, path(10000), seconds),
      hotTime(query, scattered(10000), seconds), coldTime(query), 1e-6 * prepared);
}

std::string shapeResult(const SpaceTable& space, double seconds) {
  constexpr std::size_t nodes = 2228;
  const std::vector<float> rows(space.points.size() * 3 * nodes, 1e-3f);
  const DisplacementField field(space, rows);
  std::vector<float> shape(3 * nodes);
  const Query query = [&](const Eigen::Vector3d& p) {
    field.evaluate(p, shape);
    return static_cast<double>(shape[0]);
  };
  return fmt::format(
      "{{\"nodes\":{},\"configurations\":{},\"path_us\":{:.2f},\"scattered_us\":{:.2f},"
      "\"cold_us\":{:.2f}}}",
      nodes, space.lattice.size(), 1e-3 * hotTime(query, path(1000), seconds),
      1e-3 * hotTime(query, scattered(1000), seconds), 1e-3 * coldTime(query));
}

int runBenchmark(double seconds) {
  std::vector<std::string> forces;
  for (const double spacing : {radius / 3, radius / 5, radius / 7, radius / 10}) {
    const SpaceTable space = test::solvedSpace(Lattice(radius, spacing), test::StiffeningEnergy());
    for (const std::string& method : forceFieldMethods())
      if (space.lattice.size() <= most_radial_points || method.find("rbf") == std::string::npos)
        forces.push_back(methodResult(method, space, seconds));
  }
  const SpaceTable space = test::solvedSpace(Lattice(radius, radius / 5), test::StiffeningEnergy());
  fmt::print(
      "{{\"benchmark\":\"force_field\",\"forces\":[\n{}],\n\"displacements\":{},\n"
      "\"checksum\":{}}}\n",
      fmt::join(forces, ",\n"), shapeResult(space, seconds), checksum);
  return 0;
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  return palpate::runBenchmark(argc > 1 ? std::atof(argv[1]) : 0.3);
}
