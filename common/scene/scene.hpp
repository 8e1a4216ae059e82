#pragma once

#include <filesystem>

#include "common/scene/device_profile.hpp"
#include "common/scene/formulation.hpp"
#include "common/scene/key_lines.hpp"
#include "common/scene/material.hpp"

namespace palpate {

/// An axis-aligned closed box, metres.
struct Box {
  Eigen::Vector3d lowest, highest;
  bool operator==(const Box&) const = default;
};

/// A closed ball, metres.
struct Sphere {
  Eigen::Vector3d center;
  double radius;
  bool operator==(const Sphere&) const = default;
};

/// A region of the body: the tetrahedra of a physical group, and those with a centroid in one of
/// the boxes or spheres. A region without group, boxes and spheres is [material], to which all
/// remaining tetrahedra belong. No two regions have the same group. Every tetrahedron must be in
/// exactly one region.
struct Region {
  std::string group;  ///< empty if none is given, as in [material]
  Material material;
  std::vector<Box> boxes = {};
  std::vector<Sphere> spheres = {};
  KeyLines lines = {};
  /// Returns whether this is [material], to which the tetrahedra outside all other regions belong.
  bool isRest() const { return group.empty() && boxes.empty() && spheres.empty(); }
  /// Returns a name for messages: the group, or the first box or sphere; empty for [material].
  std::string name() const;
  bool operator==(const Region&) const = default;
};

/// [discretization]. By default the displacement is P1. The pressure is then "none" if no material
/// is mixed, else "P1-stabilized" with P1 and "P1" with P2 displacement. The reader refuses
/// - a pressure of higher order than the displacement;
/// - P1-stabilized with P2 displacement;
/// - no pressure with an incompressible material;
/// - a pressure without any mixed material.
struct Discretization {
  DisplacementSpace displacement = DisplacementSpace::p1;
  PressureSpace pressure = PressureSpace::p1_stabilized;
  Constraint constraint = Constraint::ln_det_F;
  bool operator==(const Discretization&) const = default;
};

/// Returns whether pressure and displacement satisfy the inf-sup condition. True without a
/// pressure.
bool isInfSupStable(const Discretization& discretization);

/// An axis-aligned half space: the nodes below or above a plane. Either `fraction` gives the plane
/// as a fraction of the bounding box, or `at` gives its coordinate in metres.
/// - below: x < xmin + fraction (xmax - xmin)
/// - above: x > xmax - fraction (xmax - xmin)
struct HalfSpace {
  int axis = 0;  ///< 0 x, 1 y, 2 z
  bool below = true;
  std::optional<double> fraction, at;
  bool operator==(const HalfSpace&) const = default;
};

/// [fixed]: the union of all given selectors. `below`, `above`, `box` and `sphere` may be tables or
/// arrays of tables. `group` is a name or an array of names. `nodes` is an array of 0-based node
/// numbers.
struct FixedSelection {
  std::vector<HalfSpace> half_spaces;
  std::vector<Box> boxes;
  std::vector<Sphere> spheres;
  std::vector<std::string> groups;
  std::vector<std::int32_t> nodes;
  KeyLines lines;
  bool operator==(const FixedSelection&) const = default;
};

/// A part of the surface of the body: all of it, or the union of the given selectors, which work as
/// in [fixed].
struct SurfaceSelection {
  bool all = false;  ///< if true, nothing else is given
  std::vector<Box> boxes = {};
  std::vector<Sphere> spheres = {};
  std::vector<std::string> groups = {};
  bool operator==(const SurfaceSelection&) const = default;
};

/// [[active]], with exactly one of `near`, `node` and `surface`. resolve() replaces a table with
/// `surface` by many active nodes or by the sites of a finger (selection.hpp).
struct ActiveSelection {
  std::string name;  ///< unique; letters, digits, '-' and '_'
  /// Metres. Selects the nearest surface node, or for a finger the nearest surface point.
  std::optional<Eigen::Vector3d> near = {};
  std::optional<std::int32_t> node = {};  ///< 0-based; must lie on the surface
  /// Metres. The patch holds all nodes that are at most this far away, except fixed ones.
  double radius = 0;
  ToolKind tool = ToolKind::rigid;  ///< all kinds but rigid require a radius > 0
  /// Selects the vertices in this part of the surface that are not fixed, or for a finger the whole
  /// part.
  std::optional<SurfaceSelection> surface = {};
  /// Name of the area to which a finger belongs. All fingers of an area have the same radius. They
  /// are the sites from which the energy E(s, p) is interpolated for any place s between them.
  /// Empty for a finger that belongs to no area. No active node may have this name.
  std::string area = {};
  /// Set for a finger that is not a site but a probe of the area `probe_of`. The exact solution for
  /// the displacement `probe` (metres) is compared with the interpolated one. Either both are set,
  /// or neither.
  std::string probe_of = {};
  std::optional<Eigen::Vector3d> probe = {};
  KeyLines lines = {};
  bool isProbe() const { return probe.has_value(); }
  bool operator==(const ActiveSelection&) const = default;
};

/// [workspace]: the displacements and forces for which configurations are computed.
struct Workspace {
  double radius = 0.1;     ///< m, r_G in the paper
  double spacing = 0.02;   ///< m
  double max_force = 8.5;  ///< N; configurations with a larger force are terminating
  /// Whether a converged state with min det F <= 0 fails with cause inverted_element.
  bool reject_inverted = true;
  KeyLines lines = {};
  bool operator==(const Workspace&) const = default;
};

/// [device]: the haptic device that renders the forces. Its limits are the defaults of
/// workspace.radius and workspace.max_force, which never exceed them.
struct Device {
  DeviceProfile profile;
  /// The values in [workspace] that exceeded the device's limits and were reduced. The resolved
  /// scene does not contain them.
  std::optional<double> wanted_radius = {}, wanted_max_force = {};
  bool operator==(const Device& other) const { return profile == other.profile; }
};

/// [accuracy]: the allowed error of interpolated forces, and the number of probes that measure it.
/// The resolved scene leaves the table out if all values are defaults.
struct Accuracy {
  /// Allowed error of the force relative to its magnitude, in (0, 1); the build refines the lattice
  /// where the estimated error is larger. 0 for a uniform lattice.
  double force_error = 0;
  double force_floor = 0.01;  ///< N; smaller errors are always allowed
  std::int32_t levels = 3;    ///< largest number of successive splits of a cell, 0..6
  /// Number of probes per active node, 0..100000: exact solutions that interpolation does not use.
  /// If a finger touches a surface, the whole surface has this number of random probe places
  /// (probePlaces, common/problem/sites.hpp).
  std::int32_t probes = 0;
  bool adaptive() const { return force_error > 0; }
  bool operator==(const Accuracy&) const = default;
};

/// Nodes with stored displacements: the vertices on the surface, or all nodes.
enum class StoredNodes : std::uint8_t { surface, all };
template <>
inline constexpr auto words_of<StoredNodes> = std::to_array<std::string_view>({"surface", "all"});
/// Number format of the stored displacements.
enum class StoredPrecision : std::uint8_t { float32, int16 };
template <>
inline constexpr auto words_of<StoredPrecision> = std::to_array<std::string_view>({"float32",
                                                                                   "int16"});

/// [storage]: the part of the nodal fields that the dataset stores. It changes no configuration and
/// no id. The resolved scene leaves the table out if all values are defaults.
struct Storage {
  /// Nodes with stored displacements. "surface" means the vertices on the surface; "all" means all
  /// nodes, and stores the pressures too.
  StoredNodes displacement = StoredNodes::surface;
  /// Format of displacements, "float32" or "int16"; docs/dataset.md gives the error bound.
  StoredPrecision precision = StoredPrecision::float32;
  bool operator==(const Storage&) const = default;
};

/// The key `contact`: how a tool touches the body in the haptic client. It changes configurations
/// and ids only through the reach of fingers (Finger::reach). The resolved scene leaves it out if
/// it is the default.
enum class ContactMode : std::uint8_t {
  unilateral,  ///< the tissue pushes the tool away and never pulls; the tool slides with friction
  glued        ///< the tool holds the surface and can pull it too (the paper's mode)
};
/// Options and recordings use these words too.
template <>
inline constexpr auto words_of<ContactMode> = std::to_array<std::string_view>({"unilateral",
                                                                               "glued"});

/// A scene file, validated, in SI units, with all defaults filled in.
struct Scene {
  std::string name;
  std::filesystem::path mesh;  ///< absolute, or as written if the scene was read from text
  /// Length unit of the mesh file. Every length in this struct is already in metres.
  double metres_per_unit = 1;
  std::vector<Region> regions = {Region{}};  ///< [material] first, if given, then each [[region]]
  Discretization discretization;
  /// m/s^2, the key `acceleration` of [gravity]; length_unit does not apply to it.
  Eigen::Vector3d gravity = {0, 0, 0};
  FixedSelection fixed;
  std::vector<ActiveSelection> active;
  Workspace workspace;
  std::optional<Device> device;
  Accuracy accuracy;
  Storage storage;
  ContactMode contact = ContactMode::unilateral;
  KeyLines lines;  ///< lines of the keys above the first table
  bool operator==(const Scene&) const = default;
};

/// Reads a scene file. Error (bad input) for a missing file, a TOML syntax error, an unknown key, a
/// wrong type or an impossible value. The message names file, line and key, and suggests a similar
/// key if there is one. length_unit ("m", "cm" or "mm") applies to every length in the scene and to
/// the mesh (toMetres in units.hpp). A scene without `name` is named after its file. docs/scene.md
/// describes every key for users.
Scene readScene(const std::filesystem::path& file);

/// Reads a scene from text; `source` is its name in errors. A relative mesh path stays relative.
Scene parseScene(const std::string& text, const std::string& source);

/// Returns the scene as TOML in SI units with all defaults written out. parseScene() of this text
/// returns an equal scene, except that the mesh path is reduced to its file name and
/// metres_per_unit is 1. Numbers round-trip exactly. Equal scenes give equal bytes on every
/// machine.
std::string resolvedToml(const Scene& scene);

}  // namespace palpate
