#include <sstream>

#include "common/base/displacement_input.hpp"
#include "tests/fuzz/fuzzer.hpp"

namespace palpate::fuzz {
namespace {

/// Standard input of `query` and `solve`.
void readDisplacements(std::string_view bytes) {
  using Words = std::vector<std::string>;
  for (const Words& at : {Words{}, Words{"-"}}) try {
      std::istringstream input{std::string(bytes)};
      forEachTouch(at, {"-"}, input, 0.06, [](const TouchInput& touch) {
        require(touch.displacement.allFinite() && (!touch.at || touch.at->allFinite()),
                "what is not finite is taken");
      });
    } catch (const Error&) {
      // A line of three numbers is refused where six are expected.
    }
}

std::vector<std::string> displacementsSeeds() {
  return {"# x y z\n0.013 -0.006 +0.009\n1e-3,2e-3, 3E-3\r\n\n13 -6 9\n", "0 0 0 1 2 3\n"};
}

const Registration displacements_fuzzer({"displacements", readDisplacements, displacementsSeeds});

}  // namespace
}  // namespace palpate::fuzz
