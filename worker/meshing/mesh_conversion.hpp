#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/base/foreign_program.hpp"

namespace palpate {

/// What convert_mesh.py made of a mesh file.
struct ConvertedMesh {
  bool is_volume = false;  ///< else a surface
  /// Of a volume a .msh (2.2, ASCII) as readGmsh reads it; of a surface what readTriangles reads.
  std::filesystem::path file;
  std::vector<std::string> notes;  ///< what was put right, sentences for people
};

/// What a user asks for beside the mesh as it is; of tetrahedra.
struct ConversionWishes {
  bool straight = false;  ///< of those with curved edges the corners
  bool weld = false;      ///< nodes that lie on each other as one (coincident_distance)
};

/// Reads a mesh of any format that convert_mesh.py or meshio knows into a new file of `folder`.
///
/// Error (bad input), naming the file and where it can the line, for what is wrong with it; Error
/// that names the package for a missing Python or module.
ConvertedMesh convertMesh(const std::filesystem::path& input, const std::filesystem::path& folder,
                          ConversionWishes wishes = {});

/// Longer than any body that can be computed on takes to be meshed.
inline constexpr std::chrono::minutes longest_meshing(30);

/// Runs gmsh, tetgen or Python to its end, or until this process is interrupted.
inline Ran runMeshing(ForeignProgram program) {
  program.patience = longest_meshing;
  program.heeds_interrupts = true;
  return runToItsEnd(program);
}

}  // namespace palpate
