#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <type_traits>

namespace palpate {

/// Passes the latest value from one writing thread to one reading thread. Both threads are
/// wait-free: no lock, no allocation, no retry. A value that is not read before the next one is
/// written is lost, by design. Use a queue (boost::lockfree::spsc_queue) for values that must not
/// be lost.
///
/// There are three slots. The writer and the reader own one slot each, and the index of the third
/// is exchanged through `shared_`. Bit 2 of `shared_` means that this slot contains a new value
/// from the writer.
template <class T>
class TripleBuffer {
  // Copies must not allocate or throw. The type cannot be required to be trivially copyable,
  // because Eigen's small matrices are not.
  static_assert(std::is_trivially_destructible_v<T>);

 public:
  explicit TripleBuffer(const T& first = {}) : slots_{first, first, first} {}

  /// Stores a value. Writing thread only.
  void write(const T& value) noexcept {
    slots_[writing_] = value;
    writing_ = shared_.exchange(writing_ | fresh, std::memory_order_acq_rel) & index;
  }
  /// Returns the last value that was written, or the initial value. The reference is valid until
  /// the next call. Reading thread only.
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
