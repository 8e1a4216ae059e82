#pragma once

#include "common/dataset/hdf5_reader.hpp"
#include "common/dataset/hdf5_writer.hpp"
#include "common/mesh/mesh.hpp"
#include "common/scene/scene.hpp"
#include "common/space/space_table.hpp"

/// The configuration spaces in a dataset: everything but the mesh and the nodal fields.
namespace palpate {

/// Writes /spaces, /patches, /splits, /attempts, /inconsistent_edges, /points and /probes. Tables
/// have the rows of all spaces one after the other: opening costs time per array.
void writeSpaces(hdf5::Writer& out, const std::vector<SpaceTable>& spaces);

/// Reads them. Error that names array or space unless they are those of the scene's active nodes,
/// on its lattice, of nodes of the mesh, and without faultOf.
std::vector<SpaceTable> readSpaces(const hdf5::Reader& in, const Scene& scene, const Mesh& mesh);

}  // namespace palpate
