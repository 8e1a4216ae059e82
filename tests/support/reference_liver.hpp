#pragma once

#include <filesystem>
#include <utility>

#include "common/mesh/mesh_reader.hpp"
#include "common/problem/problem.hpp"

namespace palpate::test {

/// The tip of the left lobe of liver-493 and of its finer meshes, metres.
inline const Eigen::Vector3d liver_tip(0.0582, 0.1344, 0.0025);

/// `scene` on a reference liver with the default conditions of getfem_reference.py: fixed where x
/// is in the lowest 15 %, one active node at the tip.
inline Problem liverProblem(Scene scene, Mesh mesh) {
  scene.fixed = {};
  scene.fixed.half_spaces = {{0, true, 0.15, std::nullopt}};
  ActiveSelection active;
  active.name = "tip";
  active.near = liver_tip;
  scene.active = {active};
  return resolve(std::move(scene), std::move(mesh));
}
inline Problem liverProblem(Scene scene, const std::filesystem::path& mesh) {
  return liverProblem(std::move(scene), readGmsh(mesh));
}

}  // namespace palpate::test
