#include "tests/fuzz/fuzzer.hpp"

#include <spdlog/spdlog.h>

#include <cstdio>
#include <cstdlib>

namespace palpate::fuzz {

std::vector<Fuzzer>& fuzzers() {
  static std::vector<Fuzzer> all;
  return all;
}

void feed(const Fuzzer& fuzzer, std::string_view bytes) {
  spdlog::set_level(spdlog::level::off);
  try {
    fuzzer.read(bytes);
  } catch (const Error&) {
    // Expected: most inputs are invalid.
  }
}

void writeSeeds(const Fuzzer& fuzzer, const std::filesystem::path& folder) {
  std::size_t number = 0;
  for (const std::string& seed : fuzzer.seeds())
    putInto(folder / fmt::format("seed-{}", number++), seed);
}

void require(bool condition, const char* what) {
  if (condition) return;
  std::fprintf(stderr, "fuzzer: %s\n", what);
  std::abort();
}

}  // namespace palpate::fuzz
