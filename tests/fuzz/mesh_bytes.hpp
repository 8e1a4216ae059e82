#pragma once

#include "common/mesh/mesh_reader.hpp"
#include "tests/fuzz/fuzzer.hpp"

namespace palpate::fuzz {

/// The first steps of the programs with a new mesh.
inline void useMesh(Mesh mesh) {
  const MeshQuality quality = measure(mesh);
  require(quality.volume > 0 && quality.pieces > 0, "a mesh that was read has no body");
  require(!surfaceNodes(mesh).empty(), "a mesh that was read has no surface");
  for (const auto& [name, vectors] : mesh.element_vectors)
    require(vectors.size() == mesh.tetrahedra.size(), "not one vector per tetrahedron");
  addMidEdgeNodes(mesh);
  require(!piecesOf(mesh).empty(), "a mesh that was read has no piece");
}

}  // namespace palpate::fuzz
