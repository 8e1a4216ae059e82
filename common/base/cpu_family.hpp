#pragma once

#include <array>
#include <string>
#include <string_view>

namespace palpate {

/// The instruction sets that hot loops are compiled for, slowest first. Results of two families
/// agree to the rounding, not to the bit.
enum class CpuFamily {
  baseline,  ///< x86-64
  avx2,      ///< AVX2 and FMA
  avx512,    ///< AVX-512 F, DQ and VL
};

inline constexpr std::array all_cpu_families = {CpuFamily::baseline, CpuFamily::avx2,
                                                CpuFamily::avx512};

/// "baseline", "avx2" or "avx512".
constexpr std::string_view name(CpuFamily family) {
  constexpr std::array<std::string_view, 3> names = {"baseline", "avx2", "avx512"};
  return names[static_cast<std::size_t>(family)];
}

/// The kernels of OpenBLAS for it, by their own name.
constexpr std::string_view blasKernelsOf(CpuFamily family) {
  constexpr std::array<std::string_view, 3> names = {"Prescott", "Haswell", "SkylakeX"};
  return names[static_cast<std::size_t>(family)];
}

/// What the bits of a result depend on: element kernels and those of OpenBLAS, "avx2/Haswell". The
/// same on every machine that runs this family, whatever its CPU is called.
inline std::string arithmeticOf(CpuFamily family) {
  return std::string(name(family)) + "/" + std::string(blasKernelsOf(family));
}

#ifdef __x86_64__  // the fields are compiled for WebAssembly too, which has one family
/// The fastest family that this machine runs. Any thread.
inline CpuFamily cpuFamily() {
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) return CpuFamily::baseline;
  const bool has_avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                          __builtin_cpu_supports("avx512vl");
  return has_avx512 ? CpuFamily::avx512 : CpuFamily::avx2;
}
#endif

}  // namespace palpate

/// Before a function: it is compiled once per CpuFamily, and the machine's own version is called.
/// For loops whose last bits need not be the same everywhere; elsewhere cpuFamily() chooses, so
/// that the choice can be recorded. Functions that it inlines are compiled with it.
/// Once only under the thread sanitizer, which is not ready yet when the loader chooses, and by
/// Clang, which makes the fuzzers: it does not inline vectors that are wider than the default.
#if defined(__SANITIZE_THREAD__) || defined(__clang__)
#define PALPATE_PER_CPU_FAMILY
#else
#define PALPATE_PER_CPU_FAMILY [[gnu::target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")]]
#endif
