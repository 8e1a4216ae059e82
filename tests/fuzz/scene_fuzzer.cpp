#include "common/scene/scene.hpp"
#include "tests/fuzz/fuzzer.hpp"

namespace palpate::fuzz {
namespace {

void readSceneText(std::string_view bytes) {
  const std::string resolved = resolvedToml(parseScene(std::string(bytes), "scene.toml"));
  Scene again;
  try {
    again = parseScene(resolved, "resolved.toml");
  } catch (const Error& error) {
    require(false, error.what());
  }
  require(resolvedToml(again) == resolved, "a resolved scene is not read as it was written");
}

std::vector<std::string> sceneSeeds() {
  std::vector<std::string> seeds;
  for (const LawName law : {LawName::mooney_rivlin, LawName::ogden})
    for (const ToolKind tool : {ToolKind::rigid, ToolKind::finger}) {
      Scene scene;
      scene.name = "organ";
      scene.mesh = "organ.msh";
      Material& material = scene.regions[0].material;
      material.law = law;
      if (law == LawName::ogden)
        material.ogden = {{3000, 2}, {-200, -2}};
      else
        material.c10 = material.c01 = 1300;
      scene.fixed.groups = {"xmin"};
      scene.fixed.half_spaces = {{0, true, 0.15, std::nullopt}};
      scene.fixed.spheres = {{Eigen::Vector3d::Zero(), 0.01}};
      ActiveSelection active;
      active.name = "tip";
      active.near = Eigen::Vector3d(0.1, 0.05, 0.02);
      active.radius = 0.01;
      active.tool = tool;
      scene.active = {active};
      scene.accuracy = {.force_error = 0.03, .probes = 4};
      seeds.push_back(resolvedToml(scene));
    }
  return seeds;
}

const Registration scene_fuzzer({"scene", readSceneText, sceneSeeds});

}  // namespace
}  // namespace palpate::fuzz
