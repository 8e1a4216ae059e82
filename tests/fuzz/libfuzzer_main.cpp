// Runs the only fuzzer of this program under libFuzzer, which provides main().

#include <signal.h>

#include <cstdio>
#include <cstdlib>

#include "tests/fuzz/fuzzer.hpp"

using palpate::fuzz::fuzzers;

namespace {

/// libFuzzer's timer for slow inputs must not interrupt system calls.
bool restartAfterAlarms() {
  struct sigaction action {};
  if (sigaction(SIGALRM, nullptr, &action) != 0) return false;
  action.sa_flags |= SA_RESTART;
  return sigaction(SIGALRM, &action, nullptr) == 0;
}

}  // namespace

/// `FUZZER --seeds FOLDER` only writes the fuzzer's own seeds.
extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  const palpate::fuzz::Fuzzer& fuzzer = fuzzers().front();
  const bool seeds = *argc == 3 && std::string_view((*argv)[1]) == "--seeds";
  try {
    if (seeds) palpate::fuzz::writeSeeds(fuzzer, (*argv)[2]);
    if (!seeds && fuzzer.prepare != nullptr) fuzzer.prepare();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    std::_Exit(1);
  }
  if (seeds) std::exit(0);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  [[maybe_unused]] static const bool restarted = restartAfterAlarms();
  palpate::fuzz::feed(fuzzers().front(), {reinterpret_cast<const char*>(data), size});
  return 0;
}
