#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>
#include <vector>

#include "tests/viewer/c_api/counting_malloc.hpp"
#include "tests/viewer/c_api/sample_file.hpp"

namespace palpate {
namespace {

constexpr int counted_ticks = 1000;

class RealTime : public test::SharedSample {
 protected:
  void SetUp() override {
    if (test::allocationCount() < 0) GTEST_SKIP() << "a sanitizer has an allocator of its own";
    ASSERT_NE(shared(), nullptr);  // opened before anything is counted
    const long before = test::allocationCount();
    void* volatile memory = std::malloc(100);
    std::free(memory);
    ASSERT_EQ(test::allocationCount(), before + 1);
  }
};

TEST_F(RealTime, QueriesDoNotAllocateInsideOutsideAndForNan) {
  auto sample = test::sized<palpate_sample>();
  int failures = 0;
  const long before = test::allocationCount();
  for (int n = 0; n < counted_ticks; ++n) {
    const double p[3] = {n == 500 ? std::numeric_limits<double>::quiet_NaN() : 5e-5 * n - 0.025,
                         1e-5 * n, -0.002};
    for (int space = 0; space < 2; ++space)
      for (int method = 0; method < 2; ++method)
        failures += palpate_query(shared(), space, method, p, &sample) == PALPATE_OK ? 0 : 1;
  }
  EXPECT_EQ(test::allocationCount(), before);
  EXPECT_EQ(failures, 0);
}

TEST_F(RealTime, ContactsAndGuardsDoNotAllocate) {
  const auto contact = test::touchWith(shared());
  const auto guard = test::guardWith();
  auto touch = test::sized<palpate_touch>();
  auto force = test::sized<palpate_guarded_force>();
  int failures = 0, touching = 0;
  const long before = test::allocationCount();
  for (int n = 0; n < counted_ticks; ++n) {
    const auto tool = test::pressing(shared(), n, counted_ticks);
    failures += palpate_contact_update(contact.get(), tool.data(), 1, &touch) == PALPATE_OK ? 0 : 1;
    failures += palpate_guard_limit(guard.get(), tool.data(), &touch, PALPATE_READING_FRESH,
                                    &force) == PALPATE_OK
                    ? 0
                    : 1;
    failures += palpate_contact_use(contact.get(), shared(), n / 10 % 2) == PALPATE_OK ? 0 : 1;
    touching += touch.touching;
  }
  EXPECT_EQ(test::allocationCount(), before);
  EXPECT_EQ(failures, 0);
  EXPECT_GT(touching, counted_ticks / 2);
}

TEST_F(RealTime, ShapesDoNotAllocate) {
  std::vector<float> shape(3 * static_cast<std::size_t>(test::describe(shared()).vertex_count));
  int failures = 0;
  const long before = test::allocationCount();
  for (int n = 0; n < counted_ticks; ++n) {
    const double p[3] = {1e-5 * n, 0.001, 0};
    failures +=
        palpate_displacements(shared(), 1, p, shape.data(), shape.size(), nullptr) == PALPATE_OK
            ? 0
            : 1;
  }
  EXPECT_EQ(test::allocationCount(), before);
  EXPECT_EQ(failures, 0);
}

TEST_F(RealTime, OutOfMemoryIsAStatus) {
  palpate_contact* contact = nullptr;
  palpate_guard* guard = nullptr;
  palpate_dataset* dataset = nullptr;
  const std::string file = sharedFile().string();
  const long before = test::allocationCount();
  ASSERT_EQ(palpate_dataset_open(file.c_str(), nullptr, &dataset), PALPATE_OK);
  const long needed = test::allocationCount() - before;
  palpate_dataset_close(dataset);
  ASSERT_NE(palpate_last_error(), nullptr);  // creates this thread's text
  palpate_status without_contact = PALPATE_OK, without_guard = PALPATE_OK;
  {
    const test::MemoryShortage shortage(0);
    without_contact = palpate_contact_create(shared(), nullptr, &contact);
    without_guard = palpate_guard_create(nullptr, &guard);
  }
  EXPECT_EQ(without_contact, PALPATE_OUT_OF_MEMORY);
  EXPECT_EQ(without_guard, PALPATE_OUT_OF_MEMORY);
  EXPECT_EQ(contact, nullptr);
  EXPECT_EQ(guard, nullptr);
  EXPECT_NE(std::string(palpate_last_error()).find("out of memory"), std::string::npos);
  // The last tenth of the allocations prepares force fields; earlier ones are also HDF5's, which
  // has its own messages for a lack of memory. Threads share the preparation of fields, so this
  // thread may not need all allocations.
  for (long granted = needed - 1; granted > needed * 9 / 10; granted -= needed / 40 + 1) {
    dataset = shared();
    palpate_status status = PALPATE_OK;
    {
      const test::MemoryShortage shortage(granted);
      status = palpate_dataset_open(file.c_str(), nullptr, &dataset);
    }
    if (status == PALPATE_OK) {
      EXPECT_NE(dataset, nullptr);
      palpate_dataset_close(dataset);
      continue;
    }
    EXPECT_EQ(status, PALPATE_OUT_OF_MEMORY) << palpate_last_error();
    EXPECT_EQ(dataset, nullptr);
  }
  dataset = shared();
  {
    const test::MemoryShortage shortage(1);
    EXPECT_NE(palpate_dataset_open(file.c_str(), nullptr, &dataset), PALPATE_OK);
  }
  EXPECT_EQ(dataset, nullptr);
}

}  // namespace
}  // namespace palpate
