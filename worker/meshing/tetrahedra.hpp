#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "worker/meshing/closed_surface.hpp"

namespace palpate {

/// The program that fills a surface with tetrahedra.
enum class Mesher : std::uint8_t {
  automatic,  ///< gmsh; if it fails, gmsh on the given triangles, then tetgen
  gmsh,       ///< new triangles of the requested size, then tetrahedra
  tetgen      ///< keeps the given triangles, which limit how coarse the mesh can be
};

/// A tetrahedral mesh and its file.
struct Tetrahedra {
  std::string msh;  ///< a complete file, Gmsh 2.2 ASCII, in the unit of the surface
  Mesh mesh;        ///< the same mesh, read as if its unit were metres
  std::vector<std::string> notes = {};  ///< sentences for the user: corrections, program, limits
};

/// Upper limit of the number of nodes, far above what the solver can handle.
inline constexpr std::int32_t most_nodes = 3000000;

/// Accepted relative deviation from the requested number of nodes.
inline constexpr double near_enough = 0.2;

/// Fills a surface with tetrahedra. The programs' files lie in `folder`. In the mesh, the volume is
/// the group "body" and the surface is the group "surface". Errors begin with `source`.
///
/// Error (bad input) for a size that gives no element or more than most_nodes nodes. Error with the
/// package's name if no permitted program is installed. Error with the messages of the programs if
/// no mesh has the volume of the surface to within 25 %. A program that crashes or takes too long
/// has failed. Error with the exit code of an interrupt if this process is interrupted.
Tetrahedra fillWithTetrahedra(const ClosedSurface& surface, const Fineness& fineness, Mesher mesher,
                              const std::filesystem::path& folder, const std::string& source);

}  // namespace palpate
