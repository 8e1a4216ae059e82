#pragma once

#include <filesystem>

#include "common/scene/device_profile.hpp"
#include "common/scene/formulation.hpp"
#include "common/scene/key_lines.hpp"
#include "common/scene/material.hpp"

namespace palpate {

/// Closed; metres.
struct Box {
  Eigen::Vector3d lowest, highest;
  bool operator==(const Box&) const = default;
};

/// Closed; metres.
struct Sphere {
  Eigen::Vector3d center;
  double radius;
  bool operator==(const Sphere&) const = default;
};

/// A part of the body: the tetrahedra of a physical group and those whose middle is in one of the
/// places, or, with none of them, all that no other region takes. No two have the same group; every
/// tetrahedron must be in exactly one.
struct Region {
  std::string group;  ///< empty: none, or [material]
  Material material;
  std::vector<Box> boxes = {};
  std::vector<Sphere> spheres = {};
  KeyLines lines = {};
  /// [material]: what no other region takes.
  bool isRest() const { return group.empty() && boxes.empty() && spheres.empty(); }
  /// The group, or the first place, for people; empty for [material].
  std::string name() const;
  bool operator==(const Region&) const = default;
};

/// [discretization]. Defaults: displacement P1; pressure "none" when no material is mixed, else
/// "P1-stabilized" with P1 and "P1" with P2 displacements. Refused: a pressure of higher order than
/// the displacement, P1-stabilized with P2, none with an incompressible material, one without any
/// mixed material.
struct Discretization {
  DisplacementSpace displacement = DisplacementSpace::p1;
  PressureSpace pressure = PressureSpace::p1_stabilized;
  Constraint constraint = Constraint::ln_det_F;
  bool operator==(const Discretization&) const = default;
};

/// Whether pressure and displacement satisfy the inf-sup condition (or there is no pressure).
bool isInfSupStable(const Discretization& discretization);

/// Axis-aligned half space: nodes with coordinate below (or above) a plane, given as `fraction` of
/// the bounding box or as `at` in metres.
/// - below: x < xmin + fraction (xmax - xmin)
/// - above: x > xmax - fraction (xmax - xmin)
struct HalfSpace {
  int axis = 0;  ///< 0 x, 1 y, 2 z
  bool below = true;
  std::optional<double> fraction, at;
  bool operator==(const HalfSpace&) const = default;
};

/// [fixed]: the union of everything given. `below`, `above`, `box`, `sphere` may be one table or an
/// array of tables; `group` a name or an array of names; `nodes` an array of 0-based node numbers.
struct FixedSelection {
  std::vector<HalfSpace> half_spaces;
  std::vector<Box> boxes;
  std::vector<Sphere> spheres;
  std::vector<std::string> groups;
  std::vector<std::int32_t> nodes;
  KeyLines lines;
  bool operator==(const FixedSelection&) const = default;
};

/// Places on the surface of the body: all of it, or the union of those given, which are like those
/// of [fixed].
struct SurfaceSelection {
  bool all = false;  ///< then nothing else is given
  std::vector<Box> boxes = {};
  std::vector<Sphere> spheres = {};
  std::vector<std::string> groups = {};
  bool operator==(const SurfaceSelection&) const = default;
};

/// [[active]]: exactly one of `near`, `node` and `surface`. One with `surface` stands for many
/// active nodes, or for the sites of a finger, until resolve() has replaced it by them
/// (selection.hpp).
struct ActiveSelection {
  std::string name;  ///< unique; letters, digits, '-' and '_'
  /// Metres: the nearest surface node; of a finger the nearest point of the surface.
  std::optional<Eigen::Vector3d> near = {};
  std::optional<std::int32_t> node = {};  ///< 0-based; must lie on the surface
  double radius = 0;  ///< metres: every node within it (<=) is in the patch, fixed ones excepted
  ToolKind tool = ToolKind::rigid;  ///< all but rigid need a radius > 0
  /// Every vertex of the surface in it that is not fixed; of a finger all of the surface in it.
  std::optional<SurfaceSelection> surface = {};
  /// Of a finger: those of one area have one radius and are sites of one energy E(s, p), which
  /// answers between them too. Empty: by itself. Is the name of no active node.
  std::string area = {};
  /// Of a finger that is no site but measures them: where the exact solution of the displacement
  /// `probe` (metres) is compared with what the area `probe_of` answers. Both or none.
  std::string probe_of = {};
  std::optional<Eigen::Vector3d> probe = {};
  KeyLines lines = {};
  bool isProbe() const { return probe.has_value(); }
  bool operator==(const ActiveSelection&) const = default;
};

/// [workspace].
struct Workspace {
  double radius = 0.1;     ///< m, r_G
  double spacing = 0.02;   ///< m
  double max_force = 8.5;  ///< N; beyond it a configuration is terminating
  /// A converged state with min det F <= 0 is failed, cause inverted_element.
  bool reject_inverted = true;
  KeyLines lines = {};
  bool operator==(const Workspace&) const = default;
};

/// [device]: the haptic device that the forces are for. workspace.radius and max_force are already
/// the smaller of the device's and the scene's, and the device's where the scene gives none.
struct Device {
  DeviceProfile profile;
  /// What [workspace] asked for where that was more than the device has. Forgotten in the resolved
  /// scene.
  std::optional<double> wanted_radius = {}, wanted_max_force = {};
  bool operator==(const Device& other) const { return profile == other.profile; }
};

/// [accuracy]: what interpolated forces are to keep to, and how that is measured. A scene that says
/// nothing has no such table when it is resolved either.
struct Accuracy {
  /// Allowed error of the force relative to its magnitude, in (0, 1); the build then refines the
  /// lattice where the estimated error is larger. 0: the lattice is uniform.
  double force_error = 0;
  double force_floor = 0.01;  ///< N: an error below it is always allowed
  std::int32_t levels = 3;    ///< cells are halved at most so often, 0..6
  /// 0..100000; exact solutions at held-out positions, per active node; of a surface that a finger
  /// touches at so many random places of it (probePlaces, common/problem/sites.hpp).
  std::int32_t probes = 0;
  bool adaptive() const { return force_error > 0; }
  bool operator==(const Accuracy&) const = default;
};

/// What is kept of the displacements: those of the vertices on the surface, or of all nodes.
enum class StoredNodes : std::uint8_t { surface, all };
template <>
inline constexpr auto words_of<StoredNodes> = std::to_array<std::string_view>({"surface", "all"});
/// And as what numbers.
enum class StoredPrecision : std::uint8_t { float32, int16 };
template <>
inline constexpr auto words_of<StoredPrecision> = std::to_array<std::string_view>({"float32",
                                                                                   "int16"});

/// [storage]: what the dataset keeps of the nodal fields. It changes no configuration, and no id.
/// Like [accuracy], it is left out of a resolved scene that says nothing.
struct Storage {
  /// "surface": of its vertices; "all": pressures too.
  StoredNodes displacement = StoredNodes::surface;
  /// "float32" or "int16", of displacements; docs/dataset.md has the bound.
  StoredPrecision precision = StoredPrecision::float32;
  bool operator==(const Storage&) const = default;
};

/// `contact`, the key: how a tool touches the body in the haptic client. It changes no
/// configuration and no id, but through the reach of fingers (Finger::reach), and is left out of a
/// resolved scene that says nothing.
enum class ContactMode : std::uint8_t {
  unilateral,  ///< the tissue pushes the tool away and never pulls; the tool slides with friction
  glued        ///< the tool holds the surface and can pull it too (the paper's mode)
};
/// In options and recordings too.
template <>
inline constexpr auto words_of<ContactMode> = std::to_array<std::string_view>({"unilateral",
                                                                               "glued"});

/// One scene file, validated, in SI units, every default filled in.
struct Scene {
  std::string name;
  std::filesystem::path mesh;  ///< absolute, or as in the file when read from text
  /// Of the *mesh file*; every length in this struct is metres already.
  double metres_per_unit = 1;
  std::vector<Region> regions = {Region{}};  ///< [material] first, if given, then each [[region]]
  Discretization discretization;
  /// m/s^2; [gravity] acceleration = [x, y, z], in no length_unit.
  Eigen::Vector3d gravity = {0, 0, 0};
  FixedSelection fixed;
  std::vector<ActiveSelection> active;
  Workspace workspace;
  std::optional<Device> device;
  Accuracy accuracy;
  Storage storage;
  ContactMode contact = ContactMode::unilateral;
  KeyLines lines;  ///< of the keys above the first table
  bool operator==(const Scene&) const = default;
};

/// Reads a scene file. Error (bad input) for a missing file, TOML syntax, an unknown key, a wrong
/// type or an impossible value, naming file, line and key, with the nearest known key when one is
/// close. length_unit ("m", "cm" or "mm") applies to every length in the scene and to the mesh
/// (toMetres in units.hpp). A scene without `name` is called like its file. docs/scene.md describes
/// every key for users.
Scene readScene(const std::filesystem::path& file);

/// The same from text; `source` names it in errors. A relative mesh path stays relative.
Scene parseScene(const std::string& text, const std::string& source);

/// The scene as TOML in SI with all defaults written out, to stand beside the mesh in metres:
/// parseScene(resolvedToml(s)) == s with the mesh path reduced to its file name and metres_per_unit
/// = 1. Numbers round-trip exactly. The same scene gives the same bytes on every machine.
std::string resolvedToml(const Scene& scene);

}  // namespace palpate
