#include "common/dataset/dataset.hpp"
#include "tests/fuzz/fuzzer.hpp"
#include "tests/support/sample_dataset.hpp"
#include "tests/support/temporary_directory.hpp"

namespace palpate::fuzz {
namespace {

/// Opens any bytes as a dataset. The fuzzer dataset_values tests files with correct hashes.
void readDatasetFile(std::string_view bytes) {
  static const test::TemporaryDirectory directory;
  const std::filesystem::path file = directory / "fuzzed.h5";
  putInto(file, bytes);
  const Dataset dataset(file);
  dataset.verifyAll();
}

std::vector<std::string> datasetSeeds() {
  const test::TemporaryDirectory directory;
  test::SampleDataset sample;
  sample.seal(directory / "sample.h5");
  return {bytesIn(directory / "sample.h5")};
}

const Registration dataset_fuzzer({"dataset", readDatasetFile, datasetSeeds});

}  // namespace
}  // namespace palpate::fuzz
