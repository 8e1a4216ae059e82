#pragma once

#include "common/mesh/mesh.hpp"

namespace palpate {

/// Describes a mesh in lines of text, each beginning with its topic, in SI units. `quality` is
/// measure(mesh); the text calls the mesh `name`.
std::string meshText(const Mesh& mesh, const MeshQuality& quality, const std::string& name);

/// Returns a sentence about coincident nodes and one about hinges, if the mesh has any: both mean
/// that parts of the body touch without being joined. `file` is the mesh file in the commands that
/// the sentences suggest.
std::vector<std::string> unjoinedText(const Mesh& mesh, const MeshQuality& quality,
                                      const std::string& file);

}  // namespace palpate
