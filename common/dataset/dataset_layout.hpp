#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/dataset/hdf5_handle.hpp"
#include "common/mesh/mesh.hpp"
#include "common/scene/scene.hpp"

/// Names and numbers of the dataset format, shared by its writer and its reader. docs/dataset.md is
/// the page about it.
namespace palpate::layout {

inline constexpr std::string_view format = "palpate-dataset";
/// Readers refuse major versions that are not among these and ignore arrays that they do not know:
/// what a newer minor version added, and /rbf, which version 2 had.
inline constexpr std::int32_t oldest_major_version = 2, major_version = 3;
inline constexpr std::int32_t minor_version = 0;
inline constexpr std::string_view units = "SI: m, N, Pa, J, N/m";

/// Attributes of the root group that are read.
inline constexpr const char *format_attribute = "format", *version_attribute = "format_version",
                            *generator_attribute = "generator", *kernel_attribute = "kernel_family",
                            *scene_attribute = "scene_toml", *build_attribute = "build_id",
                            *content_attribute = "content_hash";

/// Hash over the scene and all arrays: of the text "scene_toml HASH\n" followed by one line "PATH
/// TYPE SHAPE HASH\n" per array, sorted by path, for instance "/points/ijk int32 515x3 0a1b...\n";
/// the shape of a scalar is "scalar".
ContentId contentHash(const std::string& scene_toml, std::vector<hdf5::ArrayInfo> arrays);

/// What of the nodal fields is stored (Storage): the nodes that have displacements, sorted, and the
/// number of pressures.
std::vector<std::int32_t> storedNodes(const Scene& scene, const Mesh& mesh);
std::size_t storedPressures(const Scene& scene, const Mesh& mesh);

}  // namespace palpate::layout
