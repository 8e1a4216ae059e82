#pragma once

#include <functional>

#include "common/dataset/hdf5_reader.hpp"
#include "common/dataset/hdf5_writer.hpp"
#include "common/dataset/stored_body.hpp"
#include "common/problem/problem.hpp"
#include "common/space/space_table.hpp"

/// What a dataset consists of, part by part: names, numbers and groups, each with its writer and
/// its reader. docs/dataset.md is the page about it. One thread at a time, as HDF5.
namespace palpate {

// ---- the root (dataset.cpp) -----------------------------------------------------------------

namespace layout {

inline constexpr std::string_view format = "palpate-dataset";
/// Readers refuse major versions that are not among these and ignore arrays that they do not know:
/// what a newer minor version added, and /rbf, which version 2 had.
inline constexpr std::int32_t oldest_major_version = 2, major_version = 3;
/// 4: width of fingers; 3: places of probes; 2: fingers
inline constexpr std::int32_t minor_version = 4;
inline constexpr std::string_view units = "SI: m, N, Pa, J, N/m";

/// Attributes of the root group that are read.
inline constexpr const char *format_attribute = "format", *version_attribute = "format_version",
                            *generator_attribute = "generator", *kernel_attribute = "kernel_family",
                            *scene_attribute = "scene_toml", *build_attribute = "build_id",
                            *content_attribute = "content_hash",
                            *partial_attribute = "partial";  ///< of a whole one there is none

/// Hash over the scene and all arrays: of the text "scene_toml HASH\n" followed by one line "PATH
/// TYPE SHAPE HASH\n" per array, sorted by path, for instance "/points/ijk int32 515x3 0a1b...\n";
/// the shape of a scalar is "scalar".
ContentId contentHash(const std::string& scene_toml, std::vector<hdf5::ArrayInfo> arrays);

}  // namespace layout

/// The content hash of a dataset whose every array was read, in parts, and is what its hash says.
/// Error as of Dataset and Dataset::verifyAll().
ContentId verifiedContent(const std::filesystem::path& file);

// ---- /mesh: the body and the nodes that mean something (stored_mesh.cpp) ----------------------

/// Writes the group /mesh.
void writeMesh(hdf5::Writer& out, const Problem& problem);
/// Reads it; Error that names the array when it is damaged, or is not that of a body with `scene`.
StoredBody readMesh(const hdf5::Reader& in, const Scene& scene);

// ---- the configuration spaces, without the nodal fields (stored_spaces.cpp) -------------------

/// Writes /spaces, /patches, /splits, /attempts, /inconsistent_edges, /points and /probes. Tables
/// have the rows of all spaces one after the other: opening costs time per array. `jumps`: the
/// inconsistent edges of each.
void writeSpaces(hdf5::Writer& out, const SpaceRowsList& spaces,
                 const std::vector<std::vector<LatticeEdge>>& jumps);

/// Reads them. Error that names array or space unless they are those of the scene's active nodes,
/// on its lattice, of nodes of the mesh, and without faultOf.
std::vector<SpaceTable> readSpaces(const hdf5::Reader& in, const Scene& scene, const Mesh& mesh);

// ---- the nodal fields: what scene.storage keeps, in the rows of /points (stored_fields.cpp) ---

/// Writes the fields of the points of all spaces, in that order, as the scene's [storage] says.
/// `fields` gives those of a solved point, all nodes; Error when they are not what its record
/// names.
void writeFields(hdf5::Writer& out, const Problem& problem, const SpaceRowsList& spaces,
                 const std::function<NodalFields(std::size_t space, std::int32_t point)>& fields);

/// Reads them back, each row compared with its hash.
class FieldsReader {
 public:
  /// Error that names the array when shapes are not those of the scene, the mesh and the spaces.
  /// `in` must outlive this object.
  FieldsReader(const hdf5::Reader& in, const Scene& scene, const Mesh& mesh,
               const std::vector<SpaceTable>& spaces);

  /// Displacements (metres) of the stored nodes, and pressures (Pa) of the nodes where they are
  /// kept, of `count` points from `first` on, one after the other; NaN in points that are not
  /// solved. Of a node between materials the pressure is that of its own slot (PressureSlots).
  /// `table` is that of space number `space`. Error that names point and array when a row is
  /// damaged.
  NodalFields read(std::size_t space, const SpaceTable& table, std::size_t first,
                   std::size_t count) const;

 private:
  const hdf5::Reader& in_;
  std::vector<std::size_t> first_rows_;  ///< of the spaces
  std::size_t n_values_, n_pressures_;   ///< per row of what is read
  std::size_t stored_pressures_ = 0;     ///< per row of the file
  bool quantized_;
  std::vector<ContentId> hashes_;
  std::vector<float> steps_;  ///< m
};

}  // namespace palpate
