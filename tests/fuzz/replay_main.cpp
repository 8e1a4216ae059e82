// palpate_fuzz_replay NAME CORPUS...: runs a fuzzer without libFuzzer, once for each of its own
// seeds and for each file below each CORPUS (a file, or a folder, which may be missing). --list:
// the names.

#include <algorithm>
#include <cstdio>

#include "tests/fuzz/fuzzer.hpp"

using namespace palpate;

namespace {

std::vector<std::filesystem::path> filesBelow(const std::filesystem::path& place) {
  if (!std::filesystem::is_directory(place)) return {place};
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(place))
    files.push_back(entry.path());
  std::ranges::sort(files);
  return files;
}

int replay(const std::string& name, const std::vector<std::filesystem::path>& corpora) {
  const auto fuzzer = std::ranges::find(fuzz::fuzzers(), name, &fuzz::Fuzzer::name);
  if (fuzzer == fuzz::fuzzers().end()) throw badInput("there is no fuzzer \"{}\"", name);
  std::size_t count = 0;
  for (const std::string& seed : fuzzer->seeds()) {
    fuzz::feed(*fuzzer, seed);
    ++count;
  }
  for (const std::filesystem::path& corpus : corpora)
    for (const std::filesystem::path& file : filesBelow(corpus)) {
      std::printf("%s\n", file.c_str());
      std::fflush(stdout);  // the last line names what crashed
      fuzz::feed(*fuzzer, fuzz::bytesIn(file));
      ++count;
    }
  std::printf("%s: %zu inputs\n", name.c_str(), count);
  return count > 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  try {
    if (words.size() == 1 && words[0] == "--list") {
      for (const fuzz::Fuzzer& fuzzer : fuzz::fuzzers()) std::printf("%s\n", fuzzer.name.c_str());
      return 0;
    }
    if (words.empty()) throw badInput("usage: palpate_fuzz_replay NAME CORPUS... | --list");
    return replay(words[0], {words.begin() + 1, words.end()});
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
