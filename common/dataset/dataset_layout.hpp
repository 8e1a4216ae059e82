#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/dataset/hdf5_handle.hpp"

/// Names and numbers of the dataset format, shared by its writer and its reader. docs/dataset.md is
/// the page about it.
namespace palpate::layout {

inline constexpr std::string_view format = "palpate-dataset";
/// Readers refuse another major version and ignore what a newer minor version added.
inline constexpr std::int32_t major_version = 2;
inline constexpr std::int32_t minor_version = 0;
inline constexpr std::string_view units = "SI: m, N, Pa, J, N/m";

/// Hash over the scene and all arrays: of the text "scene_toml HASH\n" followed by one line "PATH
/// TYPE SHAPE HASH\n" per array, sorted by path, for instance "/points/ijk int32 515x3 0a1b...\n";
/// the shape of a scalar is "scalar".
ContentId contentHash(const std::string& scene_toml, std::vector<hdf5::ArrayInfo> arrays);

/// Arrays of RBF weights in /rbf, in the order of SpaceTable::rbf.
inline constexpr std::array<const char*, 4> rbf_paths = {"/rbf/linear", "/rbf/linear_tail",
                                                         "/rbf/cubic", "/rbf/cubic_tail"};
/// Rows of the tails.
inline constexpr std::array<std::size_t, 4> rbf_tail_rows = {0, 1, 0, 4};

/// Displacements as 16-bit integers: step * values, the largest in magnitude being 32767.
struct Quantized {
  float step = 0;  ///< metres
  std::vector<std::int16_t> values;
};
Quantized quantize(std::span<const float> displacement);
/// An error of a quantized displacement is at most this part of the step: half of it, and what
/// rounding to float32 adds.
inline constexpr double quantization_error = 0.51;

/// Hash of one row of stored fields: the displacements as they are stored, the step where they are
/// quantized, the pressures where there are some.
ContentId rowHash(std::string_view displacement, const float* step,
                  std::span<const float> pressure);

}  // namespace palpate::layout
