#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/mesh/mesh.hpp"
#include "common/scene/scene.hpp"

/// What a dataset keeps of the nodal fields of a configuration (Storage).
namespace palpate {

/// The nodes whose displacements are stored, sorted.
std::vector<std::int32_t> storedNodes(const Scene& scene, const Mesh& mesh);

/// Number of pressures that are stored.
std::size_t storedPressures(const Scene& scene, const Mesh& mesh);

/// Bytes of the stored fields of one configuration, before compression.
std::size_t storedBytes(const Scene& scene, const Mesh& mesh);

}  // namespace palpate
