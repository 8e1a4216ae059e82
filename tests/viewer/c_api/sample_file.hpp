#pragma once

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <memory>

#include "tests/support/sample_dataset.hpp"
#include "tests/support/temporary_directory.hpp"
#include "viewer/c_api/palpate.h"

namespace palpate::test {

inline constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();

/// The sample dataset in a file: a cube of 0.1 m with active nodes "tip" and "edge-2".
class SampleFile {
 public:
  explicit SampleFile(const SampleDataset& sample = SampleDataset()) { sample.seal(path()); }
  std::filesystem::path path() const { return directory_ / "sample.h5"; }

 private:
  TemporaryDirectory directory_;
};

struct CloseDataset {
  void operator()(palpate_dataset* dataset) const { palpate_dataset_close(dataset); }
};
using DatasetHandle = std::unique_ptr<palpate_dataset, CloseDataset>;

inline DatasetHandle open(const std::filesystem::path& file,
                          const palpate_open_options* options = nullptr) {
  palpate_dataset* dataset = nullptr;
  EXPECT_EQ(palpate_dataset_open(file.c_str(), options, &dataset), PALPATE_OK)
      << palpate_last_error();
  return DatasetHandle(dataset);
}

/// Tests that share an open sample.
struct SharedSample : testing::Test {
  static std::filesystem::path sharedFile() {
    static const SampleFile sample;
    return sample.path();
  }
  static palpate_dataset* shared() {
    static const DatasetHandle opened = open(sharedFile());
    return opened.get();
  }
};

struct DestroyContact {
  void operator()(palpate_contact* contact) const { palpate_contact_destroy(contact); }
};
using ContactHandle = std::unique_ptr<palpate_contact, DestroyContact>;

inline ContactHandle touchWith(const palpate_dataset* dataset,
                               const palpate_contact_options* options = nullptr) {
  palpate_contact* contact = nullptr;
  EXPECT_EQ(palpate_contact_create(dataset, options, &contact), PALPATE_OK) << palpate_last_error();
  return ContactHandle(contact);
}

struct DestroyGuard {
  void operator()(palpate_guard* guard) const { palpate_guard_destroy(guard); }
};
using GuardHandle = std::unique_ptr<palpate_guard, DestroyGuard>;

inline GuardHandle guardWith(const palpate_guard_options* options = nullptr) {
  palpate_guard* guard = nullptr;
  EXPECT_EQ(palpate_guard_create(options, &guard), PALPATE_OK) << palpate_last_error();
  return GuardHandle(guard);
}

/// A structure of the C API with its size set, everything else zero.
template <class Struct>
Struct sized() {
  Struct value{};
  value.size = sizeof value;
  return value;
}

/// Equal to the last bit; NaN equals NaN.
template <class Struct>
bool sameBits(const Struct& a, const Struct& b) {
  using Bytes = std::array<std::byte, sizeof(Struct)>;
  return std::bit_cast<Bytes>(a) == std::bit_cast<Bytes>(b);
}

inline palpate_dataset_info describe(const palpate_dataset* dataset) {
  auto info = sized<palpate_dataset_info>();
  EXPECT_EQ(palpate_dataset_describe(dataset, &info), PALPATE_OK) << palpate_last_error();
  return info;
}

/// The tool at a tick in 0..count-1: it approaches from +x, sinks into the cube beside its corner
/// "tip", slides a little and leaves.
inline std::array<double, 3> pressing(const palpate_dataset* dataset, int tick, int count) {
  auto tip = sized<palpate_space_info>();
  EXPECT_EQ(palpate_dataset_space(dataset, 0, &tip), PALPATE_OK);
  const double phase = static_cast<double>(tick) / count;
  const double depth = 0.006 * std::sin(3.141592653589793 * phase) - 0.001;
  return {tip.rest_position[0] - depth, tip.rest_position[1] - 0.012 - 0.004 * phase,
          tip.rest_position[2] - 0.008};
}

}  // namespace palpate::test
