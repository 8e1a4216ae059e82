#pragma once

#include <functional>

#include "common/dataset/hdf5_reader.hpp"
#include "common/dataset/hdf5_writer.hpp"
#include "common/dataset/stored_body.hpp"
#include "common/problem/problem.hpp"
#include "common/space/space_table.hpp"

/// The parts of a dataset file, each with its writer and its reader. docs/dataset.md documents the
/// format. One thread at a time, as for HDF5.
namespace palpate {

// ---- the root (dataset.cpp) -----------------------------------------------------------------

namespace layout {

inline constexpr std::string_view format = "palpate-dataset";
/// Range of major versions that readers accept. They ignore arrays that they do not know, such as
/// additions of newer minor versions and /rbf of version 2.
inline constexpr std::int32_t oldest_major_version = 2, major_version = 3;
/// Current minor version. Minor version 2 added fingers, 3 added probe places, and 4 the width of a
/// finger's reach.
inline constexpr std::int32_t minor_version = 4;
inline constexpr std::string_view units = "SI: m, N, Pa, J, N/m";

/// Attributes of the root group that readers use.
inline constexpr const char *format_attribute = "format", *version_attribute = "format_version",
                            *generator_attribute = "generator", *kernel_attribute = "kernel_family",
                            *scene_attribute = "scene_toml", *build_attribute = "build_id",
                            *content_attribute = "content_hash",
                            *partial_attribute = "partial";  ///< absent if the dataset is complete

/// Returns the content hash of a dataset. It is the hash of a text that begins with the line
/// "scene_toml HASH\n" and has one line "PATH TYPE SHAPE HASH\n" per array, sorted by path. An
/// example is "/points/ijk int32 515x3 0a1b...\n". The shape of a scalar is "scalar".
ContentId contentHash(const std::string& scene_toml, std::vector<hdf5::ArrayInfo> arrays);

}  // namespace layout

/// Reads every array, in parts to save memory, compares it with its hash, and returns the content
/// hash. Throws the same Errors as Dataset and Dataset::verifyAll().
ContentId verifiedContent(const std::filesystem::path& file);

// ---- /mesh: the body with its surface, fixed and stored nodes (stored_mesh.cpp) -------------

/// Writes the group /mesh.
void writeMesh(hdf5::Writer& out, const Problem& problem);
/// Reads the group /mesh. Error that names the array if an array is damaged or does not fit
/// `scene`.
StoredBody readMesh(const hdf5::Reader& in, const Scene& scene);

// ---- the configuration spaces, without the nodal fields (stored_spaces.cpp) -------------------

/// Writes /spaces, /patches, /splits, /attempts, /inconsistent_edges, /points and /probes. Each
/// table holds the rows of all spaces, one space after the other, because every further array would
/// make opening the file slower. `jumps` holds the inconsistent edges of each space.
void writeSpaces(hdf5::Writer& out, const SpaceRowsList& spaces,
                 const std::vector<std::vector<LatticeEdge>>& jumps);

/// Reads the spaces. Error that names the array or space if the spaces do not match the scene's
/// active nodes, its lattice and the nodes of the mesh, or do not pass faultOf().
std::vector<SpaceTable> readSpaces(const hdf5::Reader& in, const Scene& scene, const Mesh& mesh);

// ---- the nodal fields that scene.storage selects, in the rows of /points (stored_fields.cpp) ---

/// Writes the nodal fields of all points, one space after the other. The scene's [storage] selects
/// nodes and number format. `fields` returns the fields of a solved point for all nodes. Error if
/// their id differs from the one in the point's record (PointRecord::fields).
void writeFields(hdf5::Writer& out, const Problem& problem, const SpaceRowsList& spaces,
                 const std::function<NodalFields(std::size_t space, std::int32_t point)>& fields);

/// Reads the stored fields and compares each row with its hash.
class FieldsReader {
 public:
  /// Error that names the array if its shape does not fit the scene, the mesh and the spaces. `in`
  /// must outlive this object.
  FieldsReader(const hdf5::Reader& in, const Scene& scene, const Mesh& mesh,
               const std::vector<SpaceTable>& spaces);

  /// Returns the fields of `count` points of a space, from point `first` on, one point after the
  /// other. They are the displacements (metres) of the stored nodes and, if stored, the pressures
  /// (Pa) of the nodes with a pressure. Values are NaN at points that are not solved. A node
  /// between materials has several pressures and gets the one in its first slot (PressureSlots).
  /// `table` is the space with the index `space`. Error that names the point and the array if a row
  /// is damaged.
  NodalFields read(std::size_t space, const SpaceTable& table, std::size_t first,
                   std::size_t count) const;

 private:
  const hdf5::Reader& in_;
  std::vector<std::size_t> first_rows_;  ///< first row of each space
  std::size_t n_values_, n_pressures_;   ///< values per row of the result
  std::size_t stored_pressures_ = 0;     ///< pressures per row of the file
  bool quantized_;
  std::vector<ContentId> hashes_;
  std::vector<float> steps_;  ///< quantization step of each row, m
};

}  // namespace palpate
