#include "common/problem/problem_warnings.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <limits>
#include <set>

#include "common/base/assertion.hpp"
#include "common/base/index.hpp"
#include "common/mesh/mesh_text.hpp"
#include "common/mesh/node_set.hpp"
#include "common/problem/finger.hpp"

namespace palpate {
namespace {

/// Range of Young's modulus of soft tissue, Pa, from brain and fat to cartilage.
constexpr double softest_tissue = 100, stiffest_tissue = 1e6;
/// A stretch far beyond the range that tissue endures or max_force allows.
constexpr double largest_stretch = 3;
/// Smallest ratio of the bulk modulus to the larger of the moduli of matrix and fibres. The energy
/// of fibres depends on their isochoric stretch, which differs from their actual stretch if the
/// bulk modulus is smaller. With a bulk modulus of 2, 10 and 50 times k1, the measured force on a
/// cube pulled along its fibres is 29, 11 and 3 % too small.
constexpr double fibres_need_bulk = 50;
/// A region whose Young's modulus is more than this multiple of the smallest shear modulus of all
/// regions holds its neighbours as fixed nodes do.
constexpr double rigid_contrast = 1e3;

/// Lists names for a message, such as `"a", "b" and 398 more`.
std::string listOf(const std::vector<std::string>& names) {
  const std::size_t shown = names.size() <= listed_names + 1 ? names.size() : listed_names;
  std::string text = fmt::format(
      "\"{}\"",
      fmt::join(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(shown), "\", \""));
  if (shown < names.size()) text += fmt::format(" and {} more", names.size() - shown);
  return text;
}

/// Collects the warnings about a problem.
class Warnings {
 public:
  explicit Warnings(const Problem& problem)
      : problem_(problem),
        scene_(problem.scene),
        quality_(measure(problem.mesh)),
        distance_to_fixed_(usualDistanceToFixed()) {
    PALPATE_ASSERT(problem.active.size() == scene_.active.size(), "areas must be split into sites");
    warnings_ = unjoinedText(problem.mesh, quality_, scene_.mesh.string());
    warnOfMaterials();
    warnOfStability();
    warnOfDiscretization();
    warnOfLayers();
    warnOfShapes();
    warnOfPlaces();
    warnOfWorkspace();
    warnOfSingleNodes();
    warnOfFingers();
    warnOfTwins();
  }

  std::vector<std::string> take() { return std::move(warnings_); }

 private:
  template <class... Args>
  void warn(fmt::format_string<Args...> format, Args&&... args) {
    warnings_.push_back(fmt::format(format, std::forward<Args>(args)...));
  }

  static std::string named(const Region& region) {
    return region.isRest() ? "material" : fmt::format("region \"{}\"", region.name());
  }

  /// Warns about numbers that suggest a unit other than Pa or kg/m^3.
  void warnOfNumbers(const Region& region) {
    const Material& material = region.material;
    const double shear = shearModulus(material);
    if (material.bulk && poissonRatio(material) < 0)
      warn(
          "{}: bulk = {:.4g} Pa with a shear modulus of {:.4g} Pa gives Poisson's ratio {:.3g}; "
          "use bulk = 1e4 to 2e9 Pa, as in tissue, or leave it out",
          named(region), *material.bulk, shear, poissonRatio(material));
    if (material.density && !(*material.density >= 500 && *material.density <= 3000))
      warn("{}: density = {:.4g} kg/m^3, but tissue has 900 to 2000{}", named(region),
           *material.density,
           *material.density >= 0.5 && *material.density <= 3 ? "; if it is in g/cm^3, convert it"
                                                              : "");
    if (material.law != LawName::holzapfel_gasser_ogden) return;
    if (material.k1 < 0.1 * material.mu)
      warn(
          "{}: k1 = {:.4g} Pa is less than a tenth of mu = {:.4g} Pa, so the fibres carry almost "
          "no load; if k1 is in {}, convert it",
          named(region), material.k1, material.mu,
          material.k1 * 1e3 < 0.1 * material.mu ? "MPa" : "kPa");
    if (material.bulk && *material.bulk < fibres_need_bulk * std::max(material.mu, material.k1))
      warn(
          "{}: with bulk = {:.4g} Pa the fibres are too soft where the volume changes, because "
          "their energy ignores that change; make bulk {:.2g} Pa or more, or leave it out",
          named(region), *material.bulk, fibres_need_bulk * std::max(material.mu, material.k1));
  }

  /// Warns about laws that are unstable at the strains of the workspace. At the edge of the
  /// workspace, the strain below the tool is about the workspace radius divided by the distance to
  /// the fixed nodes.
  void warnOfStability() {
    const double strain = scene_.workspace.radius / distance_to_fixed_;
    for (const Region& region : scene_.regions)
      if (const auto softening = softeningOf(region.material);
          softening && softening->strain < strain)
        warn(
            "{}: law \"{}\" with these numbers is unstable beyond a {} of {:.2g}, but the "
            "workspace radius of {:.3g} m strains the body by about {:.2g}; many configurations "
            "will not be solved",
            named(region), word(region.material.law), softening->kind, softening->strain,
            scene_.workspace.radius, strain);
  }

  void warnOfMaterials() {
    constexpr std::array<std::pair<const char*, double>, 3> units = {
        {{"kPa", 1e3}, {"MPa", 1e6}, {"GPa", 1e9}}};
    const auto isTissue = [](double young) {
      return young >= softest_tissue && young <= stiffest_tissue;
    };
    for (const Region& region : scene_.regions) {
      warnOfNumbers(region);
      // There is a separate warning about the bulk modulus, so leave its effect out here.
      const double young =
          region.material.bulk ? 3 * shearModulus(region.material) : youngModulus(region.material);
      if (isTissue(young)) continue;
      const auto meant = std::ranges::find_if(
          units, [&](const auto& unit) { return isTissue(young * unit.second); });
      warn("{}: Young's modulus at rest is {:.3g} Pa, {} than soft tissue (0.1 to 1000 kPa); {}",
           named(region), young, young < softest_tissue ? "softer" : "stiffer",
           meant == units.end()
               ? std::string("moduli are in Pa")
               : fmt::format("its numbers look like {}, but moduli are in Pa", meant->first));
    }
  }

  void warnOfDiscretization() {
    const Discretization& d = scene_.discretization;
    const bool linear = d.displacement == DisplacementSpace::p1;
    if (!isInfSupStable(d))
      warn(
          "pressure = \"{0}\" with {0} displacement violates the inf-sup condition: the body is "
          "too stiff, and pressures oscillate; use it only for comparison; {1} is stable",
          word(d.pressure), linear ? "P1-stabilized" : "pressure = \"P1\"");
    for (const Region& region : scene_.regions) {
      const Material& material = region.material;
      const bool has_pressure = d.pressure != PressureSpace::none && isMixed(material);
      if (has_pressure || !isNearlyIncompressible(material)) continue;
      const std::string number = material.bulk ? fmt::format("bulk = {:.4g} Pa", *material.bulk)
                                               : fmt::format("poisson = {}", *material.poisson);
      warn(
          "law \"{}\" with {} is nearly incompressible, and {} displacement without a pressure "
          "locks: the body is {} too stiff; remove pressure = \"none\"",
          word(material.law), number, word(d.displacement), linear ? "much" : "at least 20 %");
    }
  }

  /// Returns for each region whether it is nearly rigid compared with the softest one.
  std::vector<bool> rigidRegions() const {
    double softest = std::numeric_limits<double>::infinity();
    for (const Region& region : scene_.regions)
      softest = std::min(softest, shearModulus(region.material));
    return mapped(scene_.regions, [&](const Region& region) {
      return youngModulus(region.material) > rigid_contrast * softest;
    });
  }

  /// Warns about single layers of linear elements between the tool and nodes that are fixed or
  /// belong to a nearly rigid region, because the elements of such a layer cannot bulge.
  void warnOfLayers() {
    if (scene_.discretization.displacement != DisplacementSpace::p1) return;
    const std::vector<Tetrahedron>& elements = problem_.mesh.tetrahedra;
    const std::vector<bool> rigid = rigidRegions();
    std::set<std::int32_t> held(problem_.fixed.begin(), problem_.fixed.end()), beside_held;
    for (std::size_t e = 0; e < elements.size(); ++e)
      if (rigid[problem_.region_of[e]]) held.insert(elements[e].begin(), elements[e].end());
    for (std::size_t e = 0; e < elements.size(); ++e)
      if (!rigid[problem_.region_of[e]] &&
          std::ranges::any_of(elements[e], [&](std::int32_t n) { return held.contains(n); }))
        beside_held.insert(elements[e].begin(), elements[e].end());
    std::vector<std::string> thin;
    for (const ActivePatch& patch : problem_.active)
      if (beside_held.contains(patch.node) && !held.contains(patch.node))
        thin.push_back(patch.name);
    // Warn only if most active nodes are affected, because among many active nodes some always lie
    // beside fixed nodes.
    if (2 * thin.size() > problem_.active.size())
      warn(
          "active {}: the single element between the tool and fixed nodes or a nearly rigid region "
          "cannot bulge, so forces are a third too large; refine the mesh there, or use "
          "displacement = \"P2\"",
          listOf(thin));
  }

  void warnOfShapes() {
    if (quality_.nearly_flat > 0)
      warn(
          "{} of {} tetrahedra are nearly flat (shape < {}, "
          "the worst is element {} with {:.3g}): they invert first; "
          "re-mesh or optimise (gmsh -optimize_netgen)",
          quality_.nearly_flat, problem_.mesh.tetrahedra.size(), near_flat_shape,
          quality_.worst_element, quality_.worst_shape);
  }

  void warnOfPlaces() {
    for (std::size_t i = 0; i < problem_.active.size(); ++i) {
      const auto& near = scene_.active[i].near;
      if (!near) continue;
      const auto& finger = problem_.active[i].finger;
      const Eigen::Vector3d& node =
          finger ? finger->center : problem_.mesh.nodes[problem_.active[i].node];
      if (const double distance = (node - *near).norm(); distance > quality_.mean_edge)
        warn(
            "active \"{}\": near = {} is {:.4g} m away from the nearest {} at {}, "
            "more than an edge ({:.4g} m): is it inside the body, or in another unit or frame?",
            problem_.active[i].name, placeText(*near), distance,
            finger ? "surface point" : "surface node", placeText(node), quality_.mean_edge);
    }
  }

  double distanceToFixed(const ActivePatch& patch) const {
    const std::vector<Eigen::Vector3d>& nodes = problem_.mesh.nodes;
    PALPATE_ASSERT(!problem_.fixed.empty(), "a body must have fixed nodes");
    const auto distance = [&](std::int32_t n) { return (nodes[n] - nodes[patch.node]).norm(); };
    return distance(*std::ranges::min_element(problem_.fixed, {}, distance));
  }

  /// Returns the median, over the active nodes, of the distance to the nearest fixed node, m. The
  /// minimum would be misleading, because among many active nodes some lie beside fixed nodes.
  double usualDistanceToFixed() const {
    auto distances = mapped(problem_.active, [&](const auto& p) { return distanceToFixed(p); });
    PALPATE_ASSERT(!distances.empty(), "a scene must have an active node");
    const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
    std::nth_element(distances.begin(), middle, distances.end());
    return *middle;
  }

  void warnOfWorkspace() {
    const double radius = scene_.workspace.radius;
    const double diagonal = (quality_.highest - quality_.lowest).norm();
    if (radius > diagonal) {
      warn(
          "workspace.radius = {:.4g} m is more than the body's diagonal of {:.4g} m; few "
          "configurations will be reached",
          radius, diagonal);
      return;
    }
    if (radius > (largest_stretch - 1) * distance_to_fixed_)
      warn(
          "workspace.radius = {:.4g} m, but the nearest fixed node is {:.4g} m away from {}: the "
          "tissue between them would be stretched to {:.2g} times its length, so most "
          "configurations will not be reached",
          radius, distance_to_fixed_,
          problem_.active.size() == 1 ? "the active node" : "a typical active node",
          1 + radius / distance_to_fixed_);
  }

  void warnOfSingleNodes() {
    std::vector<std::string> single, lonely;
    for (std::size_t i = 0; i < problem_.active.size(); ++i) {
      const ActivePatch& patch = problem_.active[i];
      if (scene_.active[i].radius == 0)
        single.push_back(patch.name);
      else if (patch.nodes.size() == 1)
        lonely.push_back(patch.name);
    }
    if (!single.empty())
      warn(
          "active {}: the tool is a single node (radius = 0), whose force depends on the mesh and "
          "does not converge as the mesh is refined; give the radius of the contact",
          listOf(single));
    if (!lonely.empty())
      warn(
          "active {}: no other node lies within the radius (edges are {:.4g} m on average), so the "
          "tool is a single node and its force depends on the mesh",
          listOf(lonely), quality_.mean_edge);
  }

  void warnOfFingers() {
    std::set<double> small;
    std::vector<std::string> around;
    for (const ActivePatch& patch : problem_.active) {
      if (!patch.finger || patch.probe) continue;
      if (patch.finger->radius < quality_.mean_edge) small.insert(patch.finger->radius);
      if (isOnBothSides(problem_.mesh, *patch.finger)) around.push_back(patch.name);
    }
    for (const double radius : small)
      warn(
          "a finger of radius {:.4g} m is smaller than an edge ({:.4g} m on average): its force "
          "depends on its place in the element; make radius at least two edges, or refine the mesh",
          radius, quality_.mean_edge);
    if (!around.empty())
      warn(
          "active {}: the finger reaches around a thin lobe and moves both sides of it; make "
          "radius smaller there if this is not intended",
          listOf(around));
  }

  void warnOfTwins() {
    std::map<std::int32_t, std::string> name_of;
    std::vector<std::string> twins;
    for (const ActivePatch& patch : problem_.active) {
      if (patch.finger) continue;  // two fingers may have the same nearest node
      const auto [first, is_new] = name_of.emplace(patch.node, patch.name);
      if (!is_new) twins.push_back(fmt::format("{}\" and \"{}", first->second, patch.name));
    }
    if (!twins.empty()) warn("active {}: these are the same node", listOf(twins));
  }

  const Problem& problem_;
  const Scene& scene_;
  const MeshQuality quality_;
  const double distance_to_fixed_;  ///< m, median over the active nodes
  std::vector<std::string> warnings_;
};

}  // namespace

std::vector<std::string> warningsOf(const Problem& problem) { return Warnings(problem).take(); }

void logWarnings(const Problem& problem) {
  for (const std::string& warning : warningsOf(problem)) spdlog::warn(warning);
}

}  // namespace palpate
