// The one fuzzer of this program under libFuzzer, which brings main().

#include <cstdio>
#include <cstdlib>

#include "tests/fuzz/fuzzer.hpp"

using palpate::fuzz::fuzzers;

/// `FUZZER --seeds FOLDER` writes the fuzzer's own seeds and does nothing else.
extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  if (*argc != 3 || std::string_view((*argv)[1]) != "--seeds") return 0;
  try {
    palpate::fuzz::writeSeeds(fuzzers().front(), (*argv)[2]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    std::_Exit(1);
  }
  std::exit(0);
}

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  palpate::fuzz::feed(fuzzers().front(), {reinterpret_cast<const char*>(data), size});
  return 0;
}
