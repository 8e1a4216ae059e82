#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/base/foreign_program.hpp"

namespace palpate {

/// The result of convert_mesh.py for a mesh file.
struct ConvertedMesh {
  bool is_volume = false;  ///< otherwise a surface
  /// A .msh file (2.2, ASCII) for readGmsh if the mesh is a volume, a file for readTriangles if it
  /// is a surface.
  std::filesystem::path file;
  std::vector<std::string> notes;  ///< corrections, sentences for the user
};

/// Optional changes to a tetrahedral mesh.
struct ConversionWishes {
  bool straight = false;  ///< curved tetrahedra become straight: only their corners are kept
  bool weld = false;      ///< coincident nodes are merged (coincident_distance)
};

/// Converts a mesh of any format that convert_mesh.py or meshio reads into a new file in `folder`.
///
/// Error (bad input), with the file and if possible the line, if the mesh is wrong. Error with the
/// package's name if Python or a module is missing.
ConvertedMesh convertMesh(const std::filesystem::path& input, const std::filesystem::path& folder,
                          ConversionWishes wishes = {});

/// Time limit of a meshing program. Bodies that are small enough to be solved take less.
inline constexpr std::chrono::minutes longest_meshing(30);

/// Runs gmsh, tetgen or Python until it ends or this process is interrupted.
inline Ran runMeshing(ForeignProgram program) {
  program.patience = longest_meshing;
  program.heeds_interrupts = true;
  return runToItsEnd(program);
}

}  // namespace palpate
