#pragma once

#include <array>
#include <string>
#include <string_view>

namespace palpate {

/// Instruction sets for which hot loops are compiled, slowest first. Results of two families agree
/// up to rounding, but not bit by bit.
enum class CpuFamily {
  baseline,  ///< x86-64
  avx2,      ///< AVX2 and FMA
  avx512,    ///< AVX-512 F, DQ and VL
};

inline constexpr std::array all_cpu_families = {CpuFamily::baseline, CpuFamily::avx2,
                                                CpuFamily::avx512};

/// Returns "baseline", "avx2" or "avx512".
constexpr std::string_view name(CpuFamily family) {
  constexpr std::array<std::string_view, 3> names = {"baseline", "avx2", "avx512"};
  return names[static_cast<std::size_t>(family)];
}

/// Returns OpenBLAS's name of its kernels for this family.
constexpr std::string_view blasKernelsOf(CpuFamily family) {
  constexpr std::array<std::string_view, 3> names = {"Prescott", "Haswell", "SkylakeX"};
  return names[static_cast<std::size_t>(family)];
}

/// Returns the kernels that the bits of a result depend on, of elements and of OpenBLAS, as in
/// "avx2/Haswell". They are the same on every machine with this family, whatever its CPU is called.
inline std::string arithmeticOf(CpuFamily family) {
  return std::string(name(family)) + "/" + std::string(blasKernelsOf(family));
}

#ifdef __x86_64__  // the fields are also compiled for WebAssembly, which has only one family
/// Returns the fastest family that this machine supports. Any thread.
inline CpuFamily cpuFamily() {
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) return CpuFamily::baseline;
  const bool has_avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                          __builtin_cpu_supports("avx512vl");
  return has_avx512 ? CpuFamily::avx512 : CpuFamily::avx2;
}
#endif

}  // namespace palpate

/// Attribute of a function that is compiled once per CpuFamily; calls use the machine's version. It
/// is for loops with results that may differ between machines in the last bits. Elsewhere
/// cpuFamily() chooses, so that the choice can be recorded. Inlined functions are compiled along
/// with it. It is off with the thread sanitizer, which is not ready when the loader chooses. It is
/// also off with Clang (which builds the fuzzers), because Clang does not inline vectors wider than
/// the default.
#if defined(__SANITIZE_THREAD__) || defined(__clang__)
#define PALPATE_PER_CPU_FAMILY
#else
#define PALPATE_PER_CPU_FAMILY [[gnu::target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")]]
#endif
