// Writes a scene as TOML, for messages and datasets. scene.cpp reads it.

#include <fmt/ranges.h>

#include "common/base/assertion.hpp"
#include "common/scene/material_toml.hpp"
#include "common/scene/scene.hpp"
#include "common/scene/toml_text.hpp"

namespace palpate {
namespace {

/// Returns the TOML `key = [item, ...]` with one item per line; empty if there are no items.
std::string listOf(const char* key, const std::vector<std::string>& items) {
  if (items.empty()) return {};
  std::string text = fmt::format("{} = [\n", key);
  for (const std::string& item : items) text += "  " + item + ",\n";
  return text + "]\n";
}

std::string boxToml(const Box& box) {
  return fmt::format("{{ lowest = {}, highest = {} }}", decimalToml(box.lowest),
                     decimalToml(box.highest));
}

std::string sphereToml(const Sphere& sphere) {
  return fmt::format("{{ center = {}, radius = {} }}", decimalToml(sphere.center),
                     decimalToml(sphere.radius));
}

std::string regionToml(const Region& region) {
  if (region.isRest()) return "\n[material]\n" + materialToml(region.material);
  std::string text = "\n[[region]]\n";
  if (!region.group.empty()) text += fmt::format("group = {}\n", quotedToml(region.group));
  return text + listOf("box", mapped(region.boxes, boxToml)) +
         listOf("sphere", mapped(region.spheres, sphereToml)) + materialToml(region.material);
}

std::string fixedToml(const FixedSelection& fixed) {
  std::vector<std::string> below, above;
  for (const HalfSpace& half : fixed.half_spaces)
    (half.below ? below : above)
        .push_back(fmt::format("{{ axis = \"{}\", {} = {} }}", "xyz"[half.axis],
                               half.at ? "at" : "fraction",
                               decimalToml(half.at ? *half.at : *half.fraction)));
  std::string text = "\n[fixed]\n" + listOf("below", below) + listOf("above", above) +
                     listOf("box", mapped(fixed.boxes, boxToml)) +
                     listOf("sphere", mapped(fixed.spheres, sphereToml)) +
                     listOf("group", mapped(fixed.groups, quotedToml));
  if (!fixed.nodes.empty()) text += fmt::format("nodes = [{}]\n", fmt::join(fixed.nodes, ", "));
  return text;
}

std::string surfaceToml(const SurfaceSelection& surface) {
  if (surface.all) return "\"all\"";
  std::vector<std::string> keys;
  const auto add = [&](const char* key, const std::vector<std::string>& items) {
    if (!items.empty()) keys.push_back(fmt::format("{} = [{}]", key, fmt::join(items, ", ")));
  };
  add("box", mapped(surface.boxes, boxToml));
  add("sphere", mapped(surface.spheres, sphereToml));
  add("group", mapped(surface.groups, quotedToml));
  return fmt::format("{{ {} }}", fmt::join(keys, ", "));
}

std::string activeToml(const ActiveSelection& active) {
  PALPATE_ASSERT(active.near || active.node || active.surface, "an active node must have a place");
  const std::string place = active.surface ? "surface = " + surfaceToml(*active.surface)
                            : active.near ? fmt::format("near = {}  # m", decimalToml(*active.near))
                                          : fmt::format("node = {}", *active.node);
  std::string text = fmt::format("\n[[active]]\nname = {}\n{}\nradius = {}  # m\n",
                                 quotedToml(active.name), place, decimalToml(active.radius));
  if (active.tool != ToolKind::rigid) text += fmt::format("tool = \"{}\"\n", word(active.tool));
  if (!active.area.empty()) text += fmt::format("area = {}\n", quotedToml(active.area));
  if (active.probe)
    text += fmt::format("probe_of = {}\nprobe = {}  # m\n", quotedToml(active.probe_of),
                        decimalToml(*active.probe));
  return text;
}

/// Returns the table [accuracy]. It is empty if all values are defaults, so that scenes from before
/// [accuracy] existed keep their ids.
std::string accuracyToml(const Accuracy& accuracy) {
  if (accuracy == Accuracy{}) return {};
  const std::string error =
      accuracy.adaptive() ? fmt::format("force_error = {}\n", decimalToml(accuracy.force_error))
                          : "";
  return fmt::format("\n[accuracy]\n{}force_floor = {}  # N\nlevels = {}\nprobes = {}\n", error,
                     decimalToml(accuracy.force_floor), accuracy.levels, accuracy.probes);
}

std::string storageToml(const Storage& storage) {
  if (storage == Storage{}) return {};
  return fmt::format("\n[storage]\ndisplacement = \"{}\"\nprecision = \"{}\"\n",
                     word(storage.displacement), word(storage.precision));
}

}  // namespace

std::string resolvedToml(const Scene& scene) {
  PALPATE_ASSERT(!scene.regions.empty(), "a body must have a material");
  std::string text =
      fmt::format("name = {}\nmesh = {}\nlength_unit = \"m\"\n", quotedToml(scene.name),
                  quotedToml(scene.mesh.filename().string()));
  // Leave out the default, so that scenes from before the key existed keep their bytes and ids.
  if (scene.contact != ContactMode{})
    text += fmt::format("contact = \"{}\"\n", word(scene.contact));
  for (const Region& region : scene.regions) text += regionToml(region);
  const Discretization& d = scene.discretization;
  text += fmt::format(
      "\n[discretization]\ndisplacement = \"{}\"\npressure = \"{}\"\nconstraint = \"{}\"\n",
      word(d.displacement), word(d.pressure), word(d.constraint));
  if (!scene.gravity.isZero(0))
    text += fmt::format("\n[gravity]\nacceleration = {}  # m/s^2\n", decimalToml(scene.gravity));
  text += fixedToml(scene.fixed);
  for (const ActiveSelection& active : scene.active) text += activeToml(active);
  const Workspace& w = scene.workspace;
  text += fmt::format(
      "\n"
      "[workspace]\n"
      "radius = {}  # m\n"
      "spacing = {}  # m\n"
      "max_force = {}  # N\n"
      "reject_inverted = {}\n",
      decimalToml(w.radius), decimalToml(w.spacing), decimalToml(w.max_force), w.reject_inverted);
  if (scene.device)
    text += fmt::format("\n[device]\nprofile = \"{}\"\n", scene.device->profile.name);
  return text + accuracyToml(scene.accuracy) + storageToml(scene.storage);
}

}  // namespace palpate
