#pragma once

#include <filesystem>
#include <fstream>
#include <optional>

#include "tests/support/meshes.hpp"
#include "tests/support/problems.hpp"
#include "tests/support/temporary_directory.hpp"

namespace palpate::test {

/// A Mooney-Rivlin blob of 125 nodes as files, for tests that run the programs: side xmin is fixed,
/// and the tool moves a patch of radius 4 cm at the other end. Tests may change `scene` before
/// write().
struct BlobOnDisk {
  BlobOnDisk() {
    scene.name = "blob";
    scene.mesh = "blob.msh";
    scene.fixed.groups = {"xmin"};
    scene.active = {{"tip", Eigen::Vector3d(0.1, 0, 0.02), std::nullopt, 0.04}};
    writeGmsh22(blobMesh(), directory / "blob.msh");
  }

  /// Writes the scene and its mesh into the same folder. Returns the path of the scene.
  std::string write() const {
    const std::filesystem::path file = directory / "blob.toml";
    std::ofstream(file) << resolvedToml(scene);
    return file.string();
  }

  TemporaryDirectory directory;
  Scene scene = mooneyRivlinScene();
};

}  // namespace palpate::test
