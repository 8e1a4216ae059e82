#include "common/problem/problem.hpp"
#include "tests/fuzz/fuzzer.hpp"
#include "tests/support/solved_table.hpp"

namespace palpate::fuzz {
namespace {

void readProblem(std::string_view bytes) {
  const Problem problem = decodeProblem(bytes);
  require(problemId(problem) == problemId(decodeProblem(encodeProblem(problem))),
          "a problem changes its name on the way");
}

std::vector<std::string> problemSeeds() {
  const Problem cube = test::cubeProblem();
  Scene finger = cube.scene;
  finger.active.resize(1);
  finger.active[0].tool = ToolKind::finger;
  finger.active[0].radius = 0.03;
  Scene quadratic = cube.scene;
  quadratic.discretization = {DisplacementSpace::p2, PressureSpace::p1};
  std::vector<std::string> seeds = {encodeProblem(cube)};
  for (const Scene& scene : {finger, quadratic})
    seeds.push_back(encodeProblem(resolve(scene, test::cubeMesh(0.1, 2))));
  return seeds;
}

const Registration problem_fuzzer({"problem", readProblem, problemSeeds});

}  // namespace
}  // namespace palpate::fuzz
