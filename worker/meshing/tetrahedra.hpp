#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "worker/meshing/closed_surface.hpp"

namespace palpate {

/// Which program fills a surface.
enum class Mesher : std::uint8_t {
  automatic,  ///< gmsh; where that fails gmsh on the given triangles, then tetgen
  gmsh,       ///< new triangles of the wanted size, then tetrahedra
  tetgen      ///< the given triangles stay, and decide how coarse it can be
};

/// A mesh on its way into a file.
struct Tetrahedra {
  std::string msh;  ///< a whole file, Gmsh 2.2 ASCII, in the unit of what it was made of
  Mesh mesh;        ///< the same, read as if its unit were metres
  std::vector<std::string> notes = {};  ///< what was put right, which program, what it could not do
};

/// More than can be computed on by far.
inline constexpr std::int32_t most_nodes = 3000000;

/// Nodes within this share of what was wanted are near enough.
inline constexpr double near_enough = 0.2;

/// Fills a surface with tetrahedra, in files of `folder`. The volume is the group "body", the
/// surface the group "surface". `source` begins errors.
///
/// Error (bad input) for a size that makes no element, or millions; Error that names the package
/// when no program is installed that may be used; Error, with what it said, when none of them makes
/// a mesh whose volume is that of the surface to 25 %. One that crashes or takes too long has
/// failed like any other; an interrupt ends everything, with its exit code.
Tetrahedra fillWithTetrahedra(const ClosedSurface& surface, const Fineness& fineness, Mesher mesher,
                              const std::filesystem::path& folder, const std::string& source);

}  // namespace palpate
