#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/hdf5_handle.hpp"

/// Names and numbers of the dataset format, shared by its writer and its reader. docs/dataset.md is the page
/// about it.
namespace palpate::layout {

inline constexpr std::string_view format = "palpate-dataset";
/// Readers refuse a newer major version and ignore what a newer minor version added.
inline constexpr std::int32_t major_version = 1;
/// 1: quadratic displacements or weighted patches are in the file (/mesh/edges, patch_weights). Without them
/// a file is the same as one of version 1.0, and says so.
inline constexpr std::int32_t minor_version = 1;
inline constexpr std::string_view units = "SI: m, N, Pa, J, N/m";

/// "/spaces/NAME/ARRAY".
inline std::string inSpace(const std::string& space, std::string_view array) {
  return fmt::format("/spaces/{}/{}", space, array);
}

/// Hash over the scene and all arrays: of the text "scene_toml HASH\n" followed by one line "PATH TYPE SHAPE
/// HASH\n" per array, sorted by path, for instance "/lattice/ijk int32 515x3 0a1b...\n"; the shape of a
/// scalar is "scalar".
ContentId contentHash(const std::string& scene_toml, std::vector<hdf5::ArrayInfo> arrays);

}  // namespace palpate::layout
