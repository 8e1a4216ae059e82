// Energy that the force fields of a sealed dataset create around random closed loops: piecewise
// smooth paths inside balls of 0.2 to 1 times the workspace radius, of each active node in turn, at
// a fixed anchor. Prints one JSON object: for each method over all loops, and over those on which
// every answer used only solved and consistent corners ("covered"). "net_share" is the sum of |net
// work| over the sum of the energy exchanged, "largest_share" that of the worst loop;
// "created_share" counts only loops that gave energy.
//
//   palpate_loop_energy_bench DATASET [LOOPS] [METHOD...]     (default: 10000 potential trilinear)

#include <algorithm>
#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>

#include "common/base/error.hpp"
#include "common/dataset/dataset.hpp"
#include "tests/support/random_loops.hpp"
#include "viewer/fields/field_choice.hpp"

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

class Tally {
 public:
  void add(const test::LoopEnergy& energy) {
    ++loops_;
    net_ += std::abs(energy.net);
    created_ += std::max(0.0, energy.net);
    exchanged_ += energy.exchanged;
    error_ += energy.error;
    if (energy.exchanged > 0)
      largest_ = std::max(largest_, std::abs(energy.net) / energy.exchanged);
  }
  Json toJson() const {
    Json json = {{"loops", loops_}};
    if (loops_ == 0) return json;
    json["exchanged_J"] = exchanged_;
    json["net_share"] = net_ / exchanged_;
    json["created_share"] = created_ / exchanged_;
    json["largest_share"] = largest_;
    json["quadrature_error_share"] = error_ / exchanged_;
    return json;
  }

 private:
  int loops_ = 0;
  double net_ = 0, created_ = 0, exchanged_ = 0, error_ = 0, largest_ = 0;
};

Json measure(const Dataset& dataset, const std::string& method, int loops) {
  std::vector<std::unique_ptr<ForceField>> fields;
  for (const SpaceTable& space : dataset.spaces()) fields.push_back(makeForceField(method, space));
  Tally all, covered;
  std::mt19937 random(20);
  for (int n = 0; n < loops; ++n) {
    const std::size_t space = static_cast<std::size_t>(n) % fields.size();
    const double size = 0.2 + 0.8 * (static_cast<double>(random()) + 0.5) / 4294967296.0;
    const test::RandomLoop loop(random, size * dataset.scene().workspace.radius);
    const test::LoopEnergy energy = loopEnergy(*fields[space], loop);
    all.add(energy);
    if (energy.covered) covered.add(energy);
  }
  return {{"all", all.toJson()}, {"covered", covered.toJson()}};
}

int runBenchmark(const std::vector<std::string>& arguments) {
  if (arguments.empty())
    throw badInput("usage: palpate_loop_energy_bench DATASET [LOOPS] [METHOD...]");
  const Dataset dataset(arguments[0]);
  const int loops = arguments.size() > 1 ? std::stoi(arguments[1]) : 10000;
  std::vector<std::string> methods(
      arguments.begin() + std::min<std::ptrdiff_t>(2, std::ssize(arguments)), arguments.end());
  if (methods.empty()) methods = {"potential", "trilinear"};
  Json answer = {{"active_nodes", dataset.spaces().size()}, {"seed", 20}};
  for (const std::string& method : methods)
    answer["methods"][method] = measure(dataset, method, loops);
  std::cout << answer.dump(2) << '\n';
  return 0;
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  try {
    return palpate::runBenchmark({argv + 1, argv + argc});
  } catch (const std::exception& error) {
    fmt::print(stderr, "palpate_loop_energy_bench: {}\n", error.what());
    return 1;
  }
}
