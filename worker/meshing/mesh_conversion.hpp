#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace palpate {

/// What convert_mesh.py made of a mesh file.
struct ConvertedMesh {
  bool is_volume = false;  ///< else a surface
  /// Of a volume a .msh (2.2, ASCII) as readGmsh reads it; of a surface what readTriangles reads.
  std::filesystem::path file;
  std::vector<std::string> notes;  ///< what was put right, sentences for people
};

/// Reads a mesh of any format that convert_mesh.py or meshio knows into a new file of `folder`.
/// `straight`: of tetrahedra with curved edges the corners are taken.
///
/// Error (bad input), naming the file and where it can the line, for what is wrong with it; Error
/// that names the package for a missing Python or module.
ConvertedMesh convertMesh(const std::filesystem::path& input, const std::filesystem::path& folder,
                          bool straight);

}  // namespace palpate
