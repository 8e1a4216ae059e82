#pragma once

#include "common/mesh/mesh.hpp"

namespace palpate {

/// What people are told of a mesh: lines that begin with a word for the topic, SI units. `quality`
/// is measure(mesh), `name` what the mesh is called.
std::string meshText(const Mesh& mesh, const MeshQuality& quality, const std::string& name);

/// How parts of the body are not joined although they touch, a sentence each: coincident nodes,
/// hinges. `file` is the mesh's in the advice.
std::vector<std::string> unjoinedText(const Mesh& mesh, const MeshQuality& quality,
                                      const std::string& file);

}  // namespace palpate
