#include "common/scene/scene.hpp"

#include <algorithm>
#include <map>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "common/base/number_text.hpp"
#include "common/base/units.hpp"
#include "common/base/whole_file.hpp"
#include "common/scene/material_toml.hpp"
#include "common/scene/toml_section.hpp"

namespace palpate {
namespace {

constexpr std::array<std::string_view, length_units.size()> unit_words = {
    length_units[0].word, length_units[1].word, length_units[2].word};
constexpr std::array<std::string_view, 3> axis_words = {"x", "y", "z"};
constexpr std::int32_t max_levels = 6, max_probes = 100000;

/// Refuses the last entry of `before` if an earlier entry has the same name.
template <class Entry>
void refuseTwin(const TomlSection& section, const std::vector<Entry>& before,
                std::string Entry::*name, const char* key, const char* what) {
  const auto same = [&](const Entry& other) { return other.*name == before.back().*name; };
  if (std::any_of(before.begin(), before.end() - 1, same))
    throw section.wrong(key, "two {} \"{}\"", what, before.back().*name);
}

Box readBox(const TomlSection& section) {
  Box box = {section.require("lowest", "the corner [x, y, z] with the lowest coordinates",
                             &TomlSection::point),
             section.require("highest", "the corner [x, y, z] with the highest coordinates",
                             &TomlSection::point)};
  if ((box.lowest.array() > box.highest.array()).any())
    throw section.wrong("lowest", "a coordinate is greater than that of highest");
  return box;
}

Sphere readSphere(const TomlSection& section) {
  return {section.require("center", "[x, y, z]", &TomlSection::point),
          section.require("radius", "its radius", &TomlSection::positiveLength)};
}

template <class Selection>
void readBoxesAndSpheres(const TomlSection& section, Selection& selection) {
  for (const toml::node* node : section.oneOrMany("box"))
    selection.boxes.push_back(readBox(section.inner("box", *node, {"lowest", "highest"})));
  for (const toml::node* node : section.oneOrMany("sphere"))
    selection.spheres.push_back(readSphere(section.inner("sphere", *node, {"center", "radius"})));
}

std::vector<Region> readRegions(const TomlSection& root) {
  std::vector<Region> regions;
  if (const toml::node* node = root.find("material")) {
    const TomlSection section = root.inner("material", *node, material_keys);
    for (const char* key : {"group", "box", "sphere"})
      if (section.has(key))
        throw section.wrong(key, "[material] is the rest of the body; write [[region]] for a part");
    regions.push_back({"", readMaterial(section), {}, {}, section.lines()});
  }
  if (!root.has("region")) {
    root.require("material",
                 "write a [material] table, or one [[region]] table for each part of the body");
    return regions;
  }
  for (const toml::node& element : root.tables("region", "part of the body")) {
    const TomlSection section = root.inner("region", element, material_keys);
    Region& region = regions.emplace_back();
    region.lines = section.lines();
    region.group = section.optional("group", &TomlSection::text).value_or("");
    readBoxesAndSpheres(section, region);
    if (region.isRest())
      throw section.wrong("group", "missing: give a physical group of the mesh, a box or a sphere");
    // Check this before the material is read, so that a duplicate group is reported first.
    if (!region.group.empty())
      refuseTwin(section, regions, &Region::group, "group", "regions have the group");
    region.material = readMaterial(section);
  }
  return regions;
}

/// Returns whether the material of any region has the property.
bool anyMaterial(const std::vector<Region>& regions, bool (*property)(const Material&)) {
  return std::ranges::any_of(regions, [&](const Region& r) { return property(r.material); });
}

/// Refuses a pressure space that does not fit the displacement or the materials.
void checkPressure(const TomlSection& section, const Discretization& d,
                   const std::vector<Region>& regions) {
  const bool p1 = d.displacement == DisplacementSpace::p1;
  if (p1 && d.pressure == PressureSpace::p2)
    throw section.wrong("pressure",
                        "P2 is of higher order than the displacement: write P1-stabilized or P1");
  if (!p1 && d.pressure == PressureSpace::p1_stabilized)
    throw section.wrong("pressure",
                        "P1-stabilized is only for displacement P1; with P2, write pressure = P1");
  if (d.pressure == PressureSpace::none && anyMaterial(regions, isIncompressible))
    throw section.wrong(
        "pressure",
        "a material is incompressible and needs a pressure: {}; or give it a bulk modulus",
        p1 ? "P1-stabilized or P1" : "P1 or P2");
  if (d.pressure != PressureSpace::none && !anyMaterial(regions, isMixed))
    throw section.wrong(
        "pressure",
        "the material is compressible and has no pressure: write none, or omit this key");
}

Discretization readDiscretization(const TomlSection& root, const std::vector<Region>& regions) {
  Discretization d;
  const auto section = root.inner("discretization", {"displacement", "pressure", "constraint"});
  // Read the displacement first, because the default pressure depends on it.
  if (section) d.displacement = section->choice("displacement", d.displacement);
  d.pressure = !anyMaterial(regions, isMixed)            ? PressureSpace::none
               : d.displacement == DisplacementSpace::p1 ? PressureSpace::p1_stabilized
                                                         : PressureSpace::p1;
  if (!section) return d;
  d.constraint = section->choice("constraint", d.constraint);
  d.pressure = section->choice("pressure", d.pressure);
  checkPressure(*section, d, regions);
  return d;
}

Eigen::Vector3d readGravity(const TomlSection& root, const std::vector<Region>& regions) {
  const auto section = root.inner("gravity", {"acceleration"});
  if (!section) return Eigen::Vector3d::Zero();
  Eigen::Vector3d acceleration = section->require(
      "acceleration", "[x, y, z] in m/s^2, for instance [0, 0, -9.81]", &TomlSection::vector);
  for (const Region& region : regions)
    if (!acceleration.isZero(0) && !region.material.density)
      throw section->wrong(
          "acceleration", "with gravity every material needs a density (kg/m^3), and {} has none",
          region.isRest() ? "[material]" : fmt::format("the [[region]] of \"{}\"", region.name()));
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
  half.fraction = section.optional("fraction", &TomlSection::number);
  if (half.fraction && !(*half.fraction > 0 && *half.fraction <= 1))
    throw section.wrong("fraction", "must be greater than 0 and at most 1, not {}", *half.fraction);
  if (const auto plane = section.optional("at", &TomlSection::number))
    half.at = section.metres(*plane);
  return half;
}

/// Reads the selectors that [fixed] and `surface` share.
template <class Selection>
void readPlaces(const TomlSection& section, Selection& selection) {
  readBoxesAndSpheres(section, selection);
  for (const toml::node* node : section.oneOrMany("group"))
    selection.groups.push_back(section.text("group", *node));
}

FixedSelection readFixed(const TomlSection& section) {
  FixedSelection fixed;
  fixed.lines = section.lines();
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
  constexpr const char* plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_";
  return name.find_first_not_of(plain) == std::string::npos;
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
  active.lines = section.lines();
  active.name = section.require("name", "every active node needs a name", &TomlSection::text);
  if (!isPlainName(active.name))
    throw section.wrong("name", "\"{}\" is not a valid name; use only letters, digits, - and _",
                        active.name);
  if (section.has("near") + section.has("node") + section.has("surface") != 1)
    throw section.wrong(
        "near",
        "give one of near = [x, y, z] (the nearest surface node), node = NUMBER and surface (all "
        "of its nodes)");
  active.near = section.optional("near", &TomlSection::point);
  active.node = section.optional("node", &TomlSection::nodeNumber);
  if (const toml::node* surface = section.find("surface"))
    active.surface = readSurface(section, *surface);
  const double radius = section.optional("radius", &TomlSection::number).value_or(0);
  if (radius < 0) throw section.wrong("radius", "must not be negative, but is {}", radius);
  active.radius = section.metres(radius);
  active.tool = section.choice("tool", active.tool);
  active.area = section.optional("area", &TomlSection::text).value_or("");
  if (!active.area.empty() && active.surface)
    throw section.wrong(
        "area", "is not allowed together with the key \"surface\", which already makes an area");
  if (!active.area.empty() && (active.tool != ToolKind::finger || !isPlainName(active.area)))
    throw section.wrong(
        "area", "\"{}\" must have only letters, digits, - and _, and needs tool = \"finger\"",
        active.area);
  active.probe_of = section.optional("probe_of", &TomlSection::text).value_or("");
  active.probe = section.optional("probe", &TomlSection::point);
  if (active.probe_of.empty() == active.probe.has_value())
    throw section.wrong(
        "probe", "give both probe_of (an area) and probe (a displacement [x, y, z]), or neither");
  if (active.probe && (active.tool != ToolKind::finger || active.surface || !active.area.empty()))
    throw section.wrong("probe_of", "needs tool = \"finger\", and neither surface nor area");
  if (active.tool != ToolKind::rigid && active.radius == 0)
    throw section.wrong("tool", "{} averages over the radius, which must be greater than 0",
                        word(active.tool));
  return active;
}

/// Error unless all fingers of an area have one radius and no active node has an area's name.
void checkAreas(const TomlSection& root, const std::vector<ActiveSelection>& actives) {
  std::map<std::string, double> radius_of;
  for (const ActiveSelection& active : actives)
    if (!active.area.empty() &&
        radius_of.emplace(active.area, active.radius).first->second != active.radius)
      throw root.wrong("active", "the fingers of the area \"{}\" have different radii",
                       active.area);
  for (const ActiveSelection& active : actives)
    if (radius_of.contains(active.name))
      throw root.wrong("active", "\"{}\" is the name of an active node and of an area; rename one",
                       active.name);
  for (const ActiveSelection& active : actives)
    if (active.surface && active.tool == ToolKind::finger)
      radius_of.emplace(active.name, active.radius);
  for (const ActiveSelection& active : actives) {
    if (!active.isProbe()) continue;
    const auto area = radius_of.find(active.probe_of);
    if (area == radius_of.end() || area->second != active.radius)
      throw root.wrong("active",
                       "\"{}\" is a probe of \"{}\", which is not an area with the same radius",
                       active.name, active.probe_of);
  }
}

std::vector<ActiveSelection> readActives(const TomlSection& root) {
  std::vector<ActiveSelection> actives;
  for (const toml::node& element : root.tables("active", "active node")) {
    const TomlSection section = root.inner(
        "active", element,
        {"name", "near", "node", "surface", "radius", "tool", "area", "probe_of", "probe"});
    actives.push_back(readActive(section));
    refuseTwin(section, actives, &ActiveSelection::name, "name", "active nodes are called");
  }
  checkAreas(root, actives);
  return actives;
}

std::optional<Device> readDevice(const TomlSection& root) {
  const auto section = root.inner("device", {"profile"});
  if (!section) return std::nullopt;
  const toml::node& profile =
      section->require("profile", "the haptic device, for instance \"touch\"");
  return Device{device_profiles[section->choice("profile", profile, device_words)]};
}

/// Returns the smaller of `limit` and `value`. If `value` exceeds the limit, stores it in `wanted`.
double atMost(double limit, double value, std::optional<double>& wanted) {
  if (value <= limit) return value;
  wanted = value;
  return limit;
}

/// Reads [workspace] and limits it to the device, if there is one.
Workspace readWorkspace(const TomlSection& root, std::optional<Device>& device) {
  Workspace workspace;
  if (device) {
    workspace.radius = device->profile.workspace_radius;
    workspace.max_force = device->profile.max_force;
  }
  const auto section =
      root.inner("workspace", {"radius", "spacing", "max_force", "reject_inverted"});
  if (!section) return workspace;
  workspace.lines = section->lines();
  section->read("radius", workspace.radius, &TomlSection::positiveLength);
  section->read("spacing", workspace.spacing, &TomlSection::positiveLength);
  section->read("max_force", workspace.max_force, &TomlSection::positive);
  section->read("reject_inverted", workspace.reject_inverted, &TomlSection::flag);
  if (device) {
    const DeviceProfile& profile = device->profile;
    workspace.radius = atMost(profile.workspace_radius, workspace.radius, device->wanted_radius);
    workspace.max_force = atMost(profile.max_force, workspace.max_force, device->wanted_max_force);
  }
  if (workspace.radius < workspace.spacing)
    throw section->wrong(
        "radius",
        "{} m{} is smaller than the spacing of {} m: the lattice would have only the rest position",
        workspace.radius, device && device->wanted_radius ? ", the limit of the device," : "",
        workspace.spacing);
  return workspace;
}

Accuracy readAccuracy(const TomlSection& root) {
  Accuracy accuracy;
  const auto section = root.inner("accuracy", {"force_error", "force_floor", "levels", "probes"});
  if (!section) return accuracy;
  section->read("force_error", accuracy.force_error, &TomlSection::number);
  if (section->has("force_error") && !(accuracy.force_error > 0 && accuracy.force_error < 1))
    throw section->wrong("force_error",
                         "must be between 0 and 1, not {}: 0.03 allows an error of 3 %; "
                         "omit this key for a uniform lattice",
                         accuracy.force_error);
  section->read("force_floor", accuracy.force_floor, &TomlSection::positive);
  accuracy.levels = section->integer("levels", accuracy.levels, 0, max_levels);
  accuracy.probes = section->integer("probes", accuracy.probes, 0, max_probes);
  return accuracy;
}

Storage readStorage(const TomlSection& root) {
  const auto section = root.inner("storage", {"displacement", "precision"});
  Storage storage;
  if (!section) return storage;
  storage.displacement = section->choice("displacement", storage.displacement);
  storage.precision = section->choice("precision", storage.precision);
  return storage;
}

Scene readTables(const toml::table& table, const std::string& source) {
  // Read length_unit before any length, into the context that all tables share.
  TomlContext context{source};
  constexpr std::array<std::string_view, 14> keys = {
      "name",   "mesh",           "length_unit", "material", "region",   "gravity", "fixed",
      "active", "discretization", "workspace",   "device",   "accuracy", "storage", "contact"};
  const TomlSection root(context, table, "", keys);
  if (const toml::node* unit = root.find("length_unit"))
    context.metres_per_unit = length_units[root.choice("length_unit", *unit, unit_words)].metres;

  Scene scene;
  scene.lines = root.lines();
  scene.metres_per_unit = context.metres_per_unit;
  scene.name = root.optional("name", &TomlSection::text)
                   .value_or(std::filesystem::path(source).stem().string());
  scene.mesh =
      root.require("mesh", "the mesh file, relative to the scene file", &TomlSection::text);
  if (!scene.mesh.has_filename())
    throw root.wrong("mesh", "\"{}\" is a folder; name the mesh file", scene.mesh.string());
  scene.regions = readRegions(root);
  scene.discretization = readDiscretization(root, scene.regions);
  scene.gravity = readGravity(root, scene.regions);
  scene.fixed = readFixed(root.inner(
      "fixed", root.require("fixed", "write a [fixed] table that selects the fixed nodes"),
      {"below", "above", "box", "sphere", "group", "nodes"}));
  scene.active = readActives(root);
  PALPATE_ASSERT(!scene.active.empty() && !scene.regions.empty(),
                 "a scene must have a region and an active node");
  scene.device = readDevice(root);
  scene.workspace = readWorkspace(root, scene.device);
  scene.accuracy = readAccuracy(root);
  scene.storage = readStorage(root);
  scene.contact = root.choice("contact", scene.contact);
  return scene;
}

}  // namespace

std::string Region::name() const {
  const auto place = [](const Eigen::Vector3d& x) { return fmt::format("({})", vectorText(x, 4)); };
  if (!group.empty() || isRest()) return group;
  if (boxes.empty())
    return fmt::format("sphere of {:.4g} m at {}", spheres[0].radius, place(spheres[0].center));
  return fmt::format("box from {} to {} m", place(boxes[0].lowest), place(boxes[0].highest));
}

bool isInfSupStable(const Discretization& discretization) {
  const bool equal_order = discretization.displacement == DisplacementSpace::p1
                               ? discretization.pressure == PressureSpace::p1
                               : discretization.pressure == PressureSpace::p2;
  return !equal_order;
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
  // Make the path absolute, because the current folder may change before the mesh is read.
  scene.mesh = std::filesystem::absolute(file.parent_path() / scene.mesh).lexically_normal();
  return scene;
}

}  // namespace palpate
