#include "common/scene/scene.hpp"

#include <algorithm>
#include <array>

#include "common/base/error.hpp"
#include "common/base/text_file.hpp"
#include "common/base/units.hpp"
#include "common/scene/material_toml.hpp"
#include "common/scene/toml_section.hpp"

namespace palpate {
namespace {

constexpr std::array<std::string_view, length_units.size()> unit_words = {
    length_units[0].word, length_units[1].word, length_units[2].word};
constexpr std::array<std::string_view, 3> axis_words = {"x", "y", "z"};
constexpr std::array<std::string_view, 2> stored_words = {"surface", "all"};
constexpr std::array<std::string_view, 2> precision_words = {"float32", "int16"};
constexpr std::int32_t max_levels = 6, max_probes = 100000;

std::vector<Region> readRegions(const TomlSection& root) {
  std::vector<Region> regions;
  if (const toml::node* node = root.find("material")) {
    const TomlSection section = root.inner("material", *node, materialKeys());
    if (section.has("group"))
      throw section.wrong("group",
                          "[material] is the rest of the body; write [[region]] for a group");
    regions.push_back({"", readMaterial(section)});
  }
  if (!root.has("region")) {
    root.require("material",
                 "write a [material] table, or one [[region]] table for each part of the body");
    return regions;
  }
  const toml::array* array = root.find("region")->as_array();
  if (array == nullptr || array->empty())
    throw root.wrong("region",
                     "write [[region]], in double brackets, once for each part of the body");
  for (const toml::node& element : *array) {
    const TomlSection section = root.inner("region", element, materialKeys());
    const std::string group = section.text(
        "group", section.require("group", "the physical group of the mesh that is this region"));
    const auto same = [&](const Region& other) { return other.group == group; };
    if (std::any_of(regions.begin(), regions.end(), same))
      throw section.wrong("group", "two regions are the group \"{}\"", group);
    regions.push_back({group, readMaterial(section)});
  }
  return regions;
}

/// Refuses a pressure space that does not go with the displacement or with the materials.
void checkPressure(const TomlSection& section, const Discretization& d,
                   const std::vector<Region>& regions) {
  const auto has = [&](bool (*property)(const Material&)) {
    return std::any_of(regions.begin(), regions.end(),
                       [&](const Region& r) { return property(r.material); });
  };
  const bool p1 = d.displacement == DisplacementSpace::p1;
  if (p1 && d.pressure == PressureSpace::p2)
    throw section.wrong("pressure",
                        "P2 is of higher order than the displacement: write P1-stabilized or P1");
  if (!p1 && d.pressure == PressureSpace::p1_stabilized)
    throw section.wrong("pressure",
                        "P1-stabilized is for P1 displacement; with P2 displacement P1 is stable");
  if (d.pressure == PressureSpace::none && has(isIncompressible))
    throw section.wrong(
        "pressure",
        "a material is incompressible and needs a pressure: {}; or give it a bulk modulus",
        p1 ? "P1-stabilized or P1" : "P1 or P2");
  if (d.pressure != PressureSpace::none && !has(isMixed))
    throw section.wrong(
        "pressure",
        "the material is compressible and takes no pressure: write none, or leave it out");
}

Discretization readDiscretization(const TomlSection* section, const std::vector<Region>& regions) {
  Discretization d;
  if (section != nullptr)
    if (const toml::node* node = section->find("displacement"))
      d.displacement = static_cast<DisplacementSpace>(
          section->choice("displacement", *node, displacementWords()));
  const bool mixed = std::any_of(regions.begin(), regions.end(),
                                 [](const Region& region) { return isMixed(region.material); });
  d.pressure = !mixed                                    ? PressureSpace::none
               : d.displacement == DisplacementSpace::p1 ? PressureSpace::p1_stabilized
                                                         : PressureSpace::p1;
  if (section == nullptr) return d;
  if (const toml::node* node = section->find("constraint"))
    d.constraint = static_cast<Constraint>(section->choice("constraint", *node, constraintWords()));
  if (const toml::node* node = section->find("pressure"))
    d.pressure = static_cast<PressureSpace>(section->choice("pressure", *node, pressureWords()));
  checkPressure(*section, d, regions);
  return d;
}

Eigen::Vector3d readGravity(const TomlSection& section, const std::vector<Region>& regions) {
  Eigen::Vector3d acceleration = section.vector(
      "acceleration",
      section.require("acceleration", "[x, y, z] in m/s^2, for instance [0, 0, -9.81]"));
  for (const Region& region : regions)
    if (!acceleration.isZero(0) && !region.material.density)
      throw section.wrong(
          "acceleration", "with gravity every material needs a density (kg/m^3), and {} has none",
          region.group.empty() ? "[material]"
                               : fmt::format("the [[region]] of \"{}\"", region.group));
  return acceleration;
}

HalfSpace readHalfSpace(const TomlSection& section, bool below) {
  HalfSpace half;
  half.below = below;
  half.axis = static_cast<int>(
      section.choice("axis", section.require("axis", "write x, y or z"), axis_words));
  if (section.has("fraction") == section.has("at"))
    throw section.wrong("fraction",
                        "give either fraction (of the bounding box, 0 to 1) or at (a coordinate)");
  if (const toml::node* at = section.find("at")) {
    half.at = section.metres(section.number("at", *at));
    return half;
  }
  half.fraction = section.number("fraction", *section.find("fraction"));
  if (!(*half.fraction > 0 && *half.fraction <= 1))
    throw section.wrong("fraction", "{} must be greater than 0 and at most 1", *half.fraction);
  return half;
}

Box readBox(const TomlSection& section) {
  Box box = {
      section.point("lowest",
                    section.require("lowest", "the corner [x, y, z] with the lowest coordinates")),
      section.point(
          "highest",
          section.require("highest", "the corner [x, y, z] with the highest coordinates"))};
  if ((box.lowest.array() > box.highest.array()).any())
    throw section.wrong("lowest", "a coordinate is greater than that of highest");
  return box;
}

Sphere readSphere(const TomlSection& section) {
  return {section.point("center", section.require("center", "[x, y, z]")),
          section.positiveLength("radius", "its radius")};
}

/// The selectors that [fixed] and `surface` share.
template <class Selection>
void readPlaces(const TomlSection& section, Selection& selection) {
  for (const toml::node* node : section.oneOrMany("box"))
    selection.boxes.push_back(readBox(section.inner("box", *node, {"lowest", "highest"})));
  for (const toml::node* node : section.oneOrMany("sphere"))
    selection.spheres.push_back(readSphere(section.inner("sphere", *node, {"center", "radius"})));
  for (const toml::node* node : section.oneOrMany("group"))
    selection.groups.push_back(section.text("group", *node));
}

FixedSelection readFixed(const TomlSection& section) {
  FixedSelection fixed;
  for (const bool below : {true, false}) {
    const std::string_view key = below ? "below" : "above";
    for (const toml::node* node : section.oneOrMany(key))
      fixed.half_spaces.push_back(
          readHalfSpace(section.inner(key, *node, {"axis", "fraction", "at"}), below));
  }
  readPlaces(section, fixed);
  for (const toml::node* node : section.oneOrMany("nodes"))
    fixed.nodes.push_back(section.nodeNumber("nodes", *node));
  return fixed;
}

bool isPlainName(const std::string& name) {
  return std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
           c == '_';
  });
}

SurfaceSelection readSurface(const TomlSection& active, const toml::node& node) {
  SurfaceSelection surface;
  if (!node.is_table()) {
    surface.all = node.is_string() && active.text("surface", node) == "all";
    if (!surface.all)
      throw active.wrong("surface",
                         "write \"all\", or a table of box, sphere and group as in [fixed]");
    return surface;
  }
  const TomlSection section = active.inner("surface", node, {"box", "sphere", "group"});
  readPlaces(section, surface);
  if (surface.boxes.empty() && surface.spheres.empty() && surface.groups.empty())
    throw active.wrong("surface", "give box, sphere or group, or write surface = \"all\"");
  return surface;
}

ActiveSelection readActive(const TomlSection& section) {
  ActiveSelection active;
  active.name = section.text("name", section.require("name", "every active node needs a name"));
  if (!isPlainName(active.name))
    throw section.wrong("name", "\"{}\" may hold letters, digits, - and _ only", active.name);
  if (section.has("near") + section.has("node") + section.has("surface") != 1)
    throw section.wrong("near",
                        "give either near = [x, y, z] (the nearest surface node is taken) "
                        "or node = NUMBER or surface (every node of it is taken)");
  if (const toml::node* near = section.find("near")) active.near = section.point("near", *near);
  if (const toml::node* node = section.find("node"))
    active.node = section.nodeNumber("node", *node);
  if (const toml::node* surface = section.find("surface"))
    active.surface = readSurface(section, *surface);
  if (const toml::node* radius = section.find("radius")) {
    const double value = section.number("radius", *radius);
    if (value < 0) throw section.wrong("radius", "{} must not be negative", value);
    active.radius = section.metres(value);
  }
  if (const toml::node* tool = section.find("tool"))
    active.tool = static_cast<ToolKind>(section.choice("tool", *tool, toolWords()));
  if (active.tool == ToolKind::weighted_average && active.radius == 0)
    throw section.wrong(
        "tool", "weighted-average needs a radius greater than 0, over which it is the mean");
  return active;
}

std::vector<ActiveSelection> readActives(const TomlSection& root) {
  const toml::node& node =
      root.require("active", "write one [[active]] table for each active node");
  const toml::array* array = node.as_array();
  if (array == nullptr || array->empty())
    throw root.wrong("active", "write [[active]], in double brackets, once for each active node");
  std::vector<ActiveSelection> actives;
  for (const toml::node& element : *array) {
    const TomlSection section =
        root.inner("active", element, {"name", "near", "node", "surface", "radius", "tool"});
    actives.push_back(readActive(section));
    const auto same = [&](const ActiveSelection& other) {
      return other.name == actives.back().name;
    };
    if (std::any_of(actives.begin(), actives.end() - 1, same))
      throw section.wrong("name", "two active nodes are called \"{}\"", actives.back().name);
  }
  return actives;
}

std::optional<Device> readDevice(const TomlSection& root) {
  const toml::node* node = root.find("device");
  if (node == nullptr) return std::nullopt;
  const TomlSection section = root.inner("device", *node, {"profile"});
  const std::size_t number = section.choice(
      "profile", section.require("profile", "which device it is, for instance \"touch\""),
      deviceWords());
  return Device{deviceProfiles()[number]};
}

/// The smaller of `limit` and what the scene has, which is kept in `wanted` when it is more.
double atMost(double limit, double value, std::optional<double>& wanted) {
  if (value <= limit) return value;
  wanted = value;
  return limit;
}

/// Nothing of it exceeds the device, if there is one. `given` may be absent (nullptr).
Workspace readWorkspace(const TomlSection* given, std::optional<Device>& device) {
  Workspace workspace;
  if (device) {
    workspace.radius = device->profile.workspace_radius;
    workspace.max_force = device->profile.max_force;
  }
  if (given == nullptr) return workspace;
  const TomlSection& section = *given;
  if (section.has("radius")) workspace.radius = section.positiveLength("radius", "");
  if (section.has("spacing")) workspace.spacing = section.positiveLength("spacing", "");
  if (section.has("max_force")) workspace.max_force = section.positive("max_force", "");
  workspace.reject_inverted = section.flag("reject_inverted", workspace.reject_inverted);
  if (device) {
    const DeviceProfile& profile = device->profile;
    workspace.radius = atMost(profile.workspace_radius, workspace.radius, device->wanted_radius);
    workspace.max_force = atMost(profile.max_force, workspace.max_force, device->wanted_max_force);
  }
  if (workspace.radius < workspace.spacing)
    throw section.wrong(
        "radius",
        "{} m{} is smaller than the spacing of {} m: the lattice would be the rest position alone",
        workspace.radius, device && device->wanted_radius ? ", the device's," : "",
        workspace.spacing);
  return workspace;
}

Accuracy readAccuracy(const TomlSection& section) {
  Accuracy accuracy;
  if (const toml::node* error = section.find("force_error")) {
    accuracy.force_error = section.number("force_error", *error);
    if (!(accuracy.force_error > 0 && accuracy.force_error < 1))
      throw section.wrong("force_error",
                          "{} must be between 0 and 1: 0.03 allows an error of 3 %; "
                          "leave it out for a uniform lattice",
                          accuracy.force_error);
  }
  if (section.has("force_floor")) accuracy.force_floor = section.positive("force_floor", "");
  if (const toml::node* levels = section.find("levels"))
    accuracy.levels = section.integer("levels", *levels, 0, max_levels);
  if (const toml::node* probes = section.find("probes"))
    accuracy.probes = section.integer("probes", *probes, 0, max_probes);
  return accuracy;
}

Storage readStorage(const TomlSection& section) {
  Storage storage;
  if (const toml::node* nodes = section.find("displacement"))
    storage.displacement =
        static_cast<StoredNodes>(section.choice("displacement", *nodes, stored_words));
  if (const toml::node* precision = section.find("precision"))
    storage.precision =
        static_cast<StoredPrecision>(section.choice("precision", *precision, precision_words));
  return storage;
}

Scene readTables(const toml::table& table, const std::string& source) {
  TomlContext context{source};
  constexpr std::array<std::string_view, 14> keys = {
      "name",   "mesh",           "length_unit", "material", "region",   "gravity", "fixed",
      "active", "discretization", "workspace",   "device",   "accuracy", "storage", "contact"};
  const TomlSection root(context, table, "", keys);
  if (const toml::node* unit = root.find("length_unit"))
    context.metres_per_unit = length_units[root.choice("length_unit", *unit, unit_words)].metres;

  Scene scene;
  scene.metres_per_unit = context.metres_per_unit;
  const toml::node* name = root.find("name");
  scene.name = name ? root.text("name", *name) : std::filesystem::path(source).stem().string();
  scene.mesh = root.text("mesh", root.require("mesh", "the mesh file, relative to the scene file"));
  scene.regions = readRegions(root);
  std::optional<TomlSection> discretization;
  if (const toml::node* node = root.find("discretization"))
    discretization.emplace(
        root.inner("discretization", *node, {"displacement", "pressure", "constraint"}));
  scene.discretization =
      readDiscretization(discretization ? &*discretization : nullptr, scene.regions);
  if (const toml::node* node = root.find("gravity"))
    scene.gravity = readGravity(root.inner("gravity", *node, {"acceleration"}), scene.regions);
  scene.fixed = readFixed(root.inner(
      "fixed", root.require("fixed", "write a [fixed] table that says which nodes are held"),
      {"below", "above", "box", "sphere", "group", "nodes"}));
  scene.active = readActives(root);
  scene.device = readDevice(root);
  std::optional<TomlSection> workspace;
  if (const toml::node* node = root.find("workspace"))
    workspace.emplace(
        root.inner("workspace", *node, {"radius", "spacing", "max_force", "reject_inverted"}));
  scene.workspace = readWorkspace(workspace ? &*workspace : nullptr, scene.device);
  if (const toml::node* node = root.find("accuracy"))
    scene.accuracy = readAccuracy(
        root.inner("accuracy", *node, {"force_error", "force_floor", "levels", "probes"}));
  if (const toml::node* node = root.find("storage"))
    scene.storage = readStorage(root.inner("storage", *node, {"displacement", "precision"}));
  if (const toml::node* node = root.find("contact"))
    scene.contact = static_cast<ContactMode>(root.choice("contact", *node, contactWords()));
  return scene;
}

}  // namespace

bool isInfSupStable(const Discretization& discretization) {
  const bool equal_order = discretization.displacement == DisplacementSpace::p1
                               ? discretization.pressure == PressureSpace::p1
                               : discretization.pressure == PressureSpace::p2;
  return !equal_order;
}

std::string_view word(StoredNodes nodes) {
  return stored_words.at(static_cast<std::size_t>(nodes));
}

std::string_view word(StoredPrecision precision) {
  return precision_words.at(static_cast<std::size_t>(precision));
}

Scene parseScene(const std::string& text, const std::string& source) {
  try {
    return readTables(toml::parse(text, source), source);
  } catch (const toml::parse_error& error) {
    throw badInput("{}:{}: not TOML: {}", source, error.source().begin.line, error.description());
  }
}

Scene readScene(const std::filesystem::path& file) {
  Scene scene = parseScene(readText(file, "scene"), file.string());
  scene.mesh = std::filesystem::absolute(file.parent_path() / scene.mesh).lexically_normal();
  return scene;
}

}  // namespace palpate
