#pragma once

#include "common/mesh/mesh.hpp"
#include "common/scene/scene.hpp"

namespace palpate {

/// Which region each tetrahedron is in. Error (bad input), naming the key, when a region names an
/// element group that the mesh does not have (listing those it has) or that is empty, when a
/// tetrahedron is in two regions, or in none although there is no [material], or when none is left
/// for [material].
std::vector<std::uint16_t> selectRegions(const std::vector<Region>& regions, const Mesh& mesh);

/// The fibres of each tetrahedron as Problem::fibers. Error (bad input) when the mesh has no
/// element vectors of the name that a material gives (listing those it has), or a zero one where
/// one is needed.
std::vector<std::array<Eigen::Vector3d, 2>> selectFibers(
    const std::vector<Region>& regions, const std::vector<std::uint16_t>& region_of,
    const Mesh& mesh);

/// Whether some material has fibres.
bool hasFibers(const std::vector<Region>& regions);

}  // namespace palpate
