#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <type_traits>

namespace palpate {

/// The latest value from one writing thread to one reading thread. Both sides are wait-free: no
/// lock, no allocation, no retry. Values that are not read in time are lost; that is the purpose. A
/// queue (boost::lockfree::spsc_queue) is for what must not be lost.
///
/// Three slots: the writer owns one, the reader one, and the third is exchanged with `shared_`,
/// whose bit 2 says that the writer put something new there.
template <class T>
class TripleBuffer {
  // Copies must neither allocate nor throw; Eigen's small matrices are not trivially copyable.
  static_assert(std::is_trivially_destructible_v<T>);

 public:
  explicit TripleBuffer(const T& first = {}) : slots_{first, first, first} {}

  /// Writing thread only.
  void write(const T& value) noexcept {
    slots_[writing_] = value;
    writing_ = shared_.exchange(writing_ | fresh, std::memory_order_acq_rel) & index;
  }
  /// Reading thread only. The last value that was written, or the first; the reference holds until
  /// the next call.
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
