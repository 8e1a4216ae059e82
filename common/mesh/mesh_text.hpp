#pragma once

#include "common/mesh/mesh.hpp"

namespace palpate {

/// Returns the description of a mesh: lines that begin with their topic, in SI units. `quality` is
/// measure(mesh); `name` is the mesh's in the text.
std::string meshText(const Mesh& mesh, const MeshQuality& quality, const std::string& name);

/// Returns one sentence for each kind of parts that touch without being joined: coincident nodes
/// and hinges. `file` is the mesh file in the advice.
std::vector<std::string> unjoinedText(const Mesh& mesh, const MeshQuality& quality,
                                      const std::string& file);

}  // namespace palpate
