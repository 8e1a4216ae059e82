#pragma once

#include "common/dataset/hdf5_reader.hpp"
#include "common/dataset/hdf5_writer.hpp"
#include "common/problem/problem.hpp"

/// The group /mesh of a dataset: the body and the nodes that mean something.
namespace palpate {

/// What /mesh holds.
struct StoredMesh {
  Mesh mesh;                          ///< without groups; quadratic with P2 displacement
  std::vector<std::int32_t> fixed;    ///< sorted
  std::vector<std::int32_t> surface;  ///< surfaceNodes(mesh)
  std::vector<std::int32_t> stored;   ///< layout::storedNodes of the scene
};

/// Writes the group /mesh.
void writeMesh(hdf5::Writer& out, const Problem& problem);
/// Reads it; Error that names the array when it is damaged, or is not that of a body with `scene`.
StoredMesh readMesh(const hdf5::Reader& in, const Scene& scene);

}  // namespace palpate
