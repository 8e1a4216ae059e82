#pragma once

#include <array>
#include <string>
#include <string_view>

namespace palpate {

/// Families of CPUs, by the instruction sets for which hot loops are compiled, slowest first. Two
/// families compute the same results up to rounding, but not the same bits.
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

/// Returns the name by which OpenBLAS calls its kernels for this family.
constexpr std::string_view blasKernelsOf(CpuFamily family) {
  constexpr std::array<std::string_view, 3> names = {"Prescott", "Haswell", "SkylakeX"};
  return names[static_cast<std::size_t>(family)];
}

/// Returns the names of the element kernels and the OpenBLAS kernels, such as "avx2/Haswell".
/// Together they determine the bits of a result. The names depend on the family alone, not on the
/// CPU model.
inline std::string arithmeticOf(CpuFamily family) {
  return std::string(name(family)) + "/" + std::string(blasKernelsOf(family));
}

#ifdef __x86_64__  // viewer/fields is also compiled for WebAssembly, which has only one family
/// Returns the fastest family that this machine supports. Any thread.
inline CpuFamily cpuFamily() {
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) return CpuFamily::baseline;
  const bool has_avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                          __builtin_cpu_supports("avx512vl");
  return has_avx512 ? CpuFamily::avx512 : CpuFamily::avx2;
}
#endif

}  // namespace palpate

/// Compiles the function, and the functions inlined into it, once per CpuFamily. The loader picks
/// the version for this machine. Use this attribute only if results may differ between machines by
/// rounding. Otherwise choose the version by cpuFamily(), so that the choice can be recorded.
///
/// The attribute does nothing under the thread sanitizer, which is not initialised yet when the
/// loader picks a version. It also does nothing under Clang (which builds the fuzzers), because
/// Clang does not inline functions with vectors wider than the default.
#if defined(__SANITIZE_THREAD__) || defined(__clang__)
#define PALPATE_PER_CPU_FAMILY
#else
#define PALPATE_PER_CPU_FAMILY [[gnu::target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")]]
#endif
