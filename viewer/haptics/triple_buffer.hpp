#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <type_traits>

namespace palpate {

/// Passes the latest value from one writing thread to one reading thread. Both sides are wait-free:
/// no lock, no allocation, no retry. A value that is not read in time is lost, by design; use a
/// queue (boost::lockfree::spsc_queue) for values that must not be lost.
///
/// There are three slots: the writer and the reader own one each, and the third is exchanged
/// through `shared_`. Bit 2 of `shared_` means that the writer put a new value there.
template <class T>
class TripleBuffer {
  // Copies must not allocate or throw; Eigen's small matrices are not trivially copyable.
  static_assert(std::is_trivially_destructible_v<T>);

 public:
  explicit TripleBuffer(const T& first = {}) : slots_{first, first, first} {}

  /// Writing thread only.
  void write(const T& value) noexcept {
    slots_[writing_] = value;
    writing_ = shared_.exchange(writing_ | fresh, std::memory_order_acq_rel) & index;
  }
  /// Reading thread only. Returns the last written value, or the first one; the reference is valid
  /// until the next call.
  const T& read() noexcept {
    if ((shared_.load(std::memory_order_relaxed) & fresh) != 0)
      reading_ = shared_.exchange(reading_, std::memory_order_acq_rel) & index;
    return slots_[reading_];
  }

 private:
  static constexpr std::uint32_t fresh = 4, index = 3;
  std::array<T, 3> slots_;
  alignas(64) std::atomic<std::uint32_t> shared_ = 1;
  alignas(64) std::uint32_t writing_ = 0;
  alignas(64) std::uint32_t reading_ = 2;
};

}  // namespace palpate
