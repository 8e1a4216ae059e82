#include "viewer/haptics/touch_surface.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <queue>
#include <utility>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "common/scene/active_choice.hpp"
#include "viewer/fields/area_field.hpp"

namespace palpate {
namespace {

/// Smaller barycentric coordinates are taken as zero, so the point lies on an edge or vertex.
constexpr double rounding = 1e-9;

struct Candidate {
  std::int32_t space;
  double distance, reach;  ///< m
};

/// Returns the weights of the nearest candidates, three at most; they sum to 1. Sorts and truncates
/// the candidates.
std::vector<SpaceWeight> sharesFrom(std::vector<Candidate>& candidates) {
  PALPATE_ASSERT(!candidates.empty(), "an active node must be within reach of the vertex");
  std::ranges::sort(candidates, [](const Candidate& a, const Candidate& b) {
    return std::pair(a.distance, a.space) < std::pair(b.distance, b.space);
  });
  if (candidates.size() > most_spaces_of_vertex) candidates.resize(most_spaces_of_vertex);
  if (candidates.front().distance == 0)
    std::erase_if(candidates, [](const Candidate& candidate) { return candidate.distance > 0; });
  std::vector<SpaceWeight> shares;
  double sum = 0;
  for (const Candidate& candidate : candidates) {
    // Without a lower limit, a vertex exactly at the reach would have no weight. The far end of an
    // active node's longest edge is such a vertex if the reach is 0.
    const double taper = std::max(1 - candidate.distance / candidate.reach, 1e-3);
    const double weight = candidate.distance > 0 ? taper * taper / candidate.distance : 1;
    shares.push_back({candidate.space, weight});
    sum += weight;
  }
  for (SpaceWeight& share : shares) share.weight /= sum;
  return shares;
}

/// Returns the areas. unsolved: whether to include sites that have no solved point.
std::vector<TouchArea> touchAreas(const Dataset& dataset, bool unsolved) {
  const std::vector<SpaceTable>& spaces = dataset.spaces();
  std::vector<TouchArea> areas;
  for (ActiveChoice& area : areasOf(dataset.scene())) {
    const double radius = spaces.at(area.spaces.front()).patch.finger.value().radius;
    if (!unsolved)
      std::erase_if(area.spaces, [&](std::size_t s) { return !hasSolvedPoint(spaces[s]); });
    if (area.spaces.empty())
      throw failure("{}: no site of {} has a solved point yet; seal the build again later",
                    dataset.file().string(), area.name);
    areas.push_back({std::move(area.name), radius, std::move(area.spaces)});
  }
  return areas;
}

}  // namespace

TouchSurface::TouchSurface(const Dataset& dataset, double reach, bool unsolved) {
  const std::vector<std::int32_t>& nodes = dataset.surfaceNodes();
  const auto vertexOf = [&nodes](std::int32_t node) {
    const auto place = std::ranges::lower_bound(nodes, node);
    return place != nodes.end() && *place == node ? static_cast<std::int32_t>(place - nodes.begin())
                                                  : -1;
  };
  for (const std::int32_t node : nodes) vertices_.push_back(dataset.mesh().nodes[at(node)]);
  for (const Triangle& t : dataset.mesh().surface)
    triangles_.push_back({vertexOf(t[0]), vertexOf(t[1]), vertexOf(t[2])});
  for (const Triangle& t : triangles_)
    PALPATE_ASSERT(*std::ranges::min_element(t) >= 0,
                   "a dataset must store every node of its surface");
  setFaces();
  setNeighbors();

  areas_ = touchAreas(dataset, unsolved);
  area_of_space_.assign(dataset.spaces().size(), -1);
  std::int32_t number = 0;
  for (const ActiveChoice& area : areasOf(dataset.scene())) {
    for (const std::size_t space : area.spaces) {
      PALPATE_ASSERT(area_of_space_[space] < 0, "a site must belong to only one area");
      area_of_space_[space] = number;
    }
    ++number;
  }
  std::vector<ActivePatch> patches;
  for (const SpaceTable& space : dataset.spaces()) {
    ActivePatch patch = space.patch;
    patch.node = vertexOf(patch.node);
    for (std::int32_t& node : patch.nodes) node = vertexOf(node);
    std::erase(patch.nodes, -1);  // nodes that are not surface vertices: inside the body, or in the
                                  // middle of an edge
    active_vertices_.push_back(patch.node);
    // A site belongs to its area, and has no patch of its own.
    if (areaOfSpace(patches.size()) >= 0) patch.node = -1;
    patches.push_back(patch);
  }
  if (!(std::isfinite(reach) && reach >= 0))
    throw badInput("invalid reach of {} m around active nodes; it must be finite and at least 0",
                   reach);
  setShares(patches, reach);
  std::vector<std::int32_t> fixed = mapped(dataset.fixedNodes(), vertexOf);
  std::ranges::sort(fixed);
  setAreas(dataset.spaces(), fixed);
  setTouchable();
  if (touch_triangles_.empty())
    throw failure(
        "{}: nothing can be touched: no triangle of the surface "
        "has three corners near active nodes; give a larger reach than {} m",
        dataset.file().string(), reach);
  tree_ = SurfaceTree(vertices_, triangles_);
}

void TouchSurface::setFaces() {
  normals_.assign(vertices_.size(), Eigen::Vector3d::Zero());
  longest_edges_.assign(vertices_.size(), 0);
  for (const Triangle& t : triangles_) {
    Face face;
    std::array<Eigen::Vector3d, 3> edges;  // opposite to each corner
    for (std::size_t c = 0; c < 3; ++c)
      edges[c] = vertices_[at(t[(c + 2) % 3])] - vertices_[at(t[(c + 1) % 3])];
    const Eigen::Vector3d twice_area = edges[0].cross(edges[1]);
    face.normal = twice_area.normalized();
    for (std::size_t c = 0; c < 3; ++c) {
      face.gradients.col(static_cast<Eigen::Index>(c)) =
          face.normal.cross(edges[c]) / twice_area.norm();
      const Eigen::Vector3d &before = edges[(c + 1) % 3], &after = edges[(c + 2) % 3];
      normals_[at(t[c])] +=
          std::atan2(before.cross(after).norm(), -before.dot(after)) * face.normal;
      longest_edges_[at(t[c])] = std::max({longest_edges_[at(t[c])], before.norm(), after.norm()});
    }
    faces_.push_back(face);
  }
  for (Eigen::Vector3d& normal : normals_) normal.normalize();
}

void TouchSurface::setNeighbors() {
  // Maps a directed edge (start, end) to its triangle and the corner opposite to the edge.
  std::multimap<std::pair<std::int32_t, std::int32_t>, std::pair<std::int32_t, std::size_t>> edges;
  for (std::size_t n = 0; n < triangles_.size(); ++n)
    for (std::size_t c = 0; c < 3; ++c)
      edges.insert({{triangles_[n][(c + 1) % 3], triangles_[n][(c + 2) % 3]},
                    {static_cast<std::int32_t>(n), c}});
  neighbors_.assign(triangles_.size(), {-1, -1, -1});
  while (!edges.empty()) {
    const auto [edge, place] = *edges.begin();
    edges.erase(edges.begin());
    const auto opposite = edges.find({edge.second, edge.first});
    if (opposite == edges.end()) continue;
    neighbors_[at(place.first)][place.second] = opposite->second.first;
    neighbors_[at(opposite->second.first)][opposite->second.second] = place.first;
    edges.erase(opposite);
  }
  around_.resize(vertices_.size());
  for (std::size_t n = 0; n < triangles_.size(); ++n)
    for (const std::int32_t vertex : triangles_[n])
      around_[at(vertex)].push_back(static_cast<std::int32_t>(n));
}

/// Returns the vertices within `reach` (m) of the sources along edges, with their distances, by
/// Dijkstra's algorithm.
std::map<std::int32_t, double> TouchSurface::distancesFrom(const std::vector<std::int32_t>& sources,
                                                           double reach) const {
  using Item = std::pair<double, std::int32_t>;
  std::priority_queue<Item, std::vector<Item>, std::greater<>> open;
  std::map<std::int32_t, double> distances;
  for (const std::int32_t vertex : sources) {
    distances[vertex] = 0;
    open.push({0, vertex});
  }
  while (!open.empty()) {
    const auto [distance, vertex] = open.top();
    open.pop();
    if (distance > distances[vertex]) continue;
    for (const std::int32_t triangle : trianglesAt(vertex))
      for (const std::int32_t other : triangles_[at(triangle)]) {
        const double through = distance + (vertices_[at(other)] - vertices_[at(vertex)]).norm();
        if (through > reach) continue;
        const auto [place, is_new] = distances.try_emplace(other, through);
        if (!is_new && place->second <= through) continue;
        place->second = through;
        open.push({through, other});
      }
  }
  return distances;
}

void TouchSurface::setShares(const std::vector<ActivePatch>& patches, double reach) {
  std::vector<std::vector<Candidate>> candidates(vertices_.size());
  for (std::size_t s = 0; s < patches.size(); ++s) {
    const ActivePatch& patch = patches[s];
    if (patch.node < 0) continue;
    double own_reach = reach;
    if (reach == 0) {
      own_reach = longest_edges_[at(patch.node)];
      for (const std::int32_t vertex : patch.nodes)
        own_reach = std::max(own_reach, (vertices_[at(vertex)] - vertices_[at(patch.node)]).norm());
    }
    for (const auto& [vertex, distance] : distancesFrom(patch.nodes, own_reach))
      candidates[at(vertex)].push_back({static_cast<std::int32_t>(s), distance, own_reach});
  }
  for (std::vector<Candidate>& of_vertex : candidates)
    shares_.push_back(of_vertex.empty() ? std::vector<SpaceWeight>() : sharesFrom(of_vertex));
}

/// Assigns to each area the vertices near its sites, and the triangles whose three corners are such
/// vertices. A triangle whose corners are all fixed belongs to no area.
void TouchSurface::setAreas(const std::vector<SpaceTable>& spaces,
                            const std::vector<std::int32_t>& fixed) {
  area_of_vertex_.assign(vertices_.size(), -1);
  for (std::size_t a = 0; a < areas_.size(); ++a) {
    const double distance = answered_distance * areas_[a].radius;
    const NearPoints sites(centersOf(chosenOf(spaces, areas_[a].spaces)), distance);
    for (std::size_t v = 0; v < vertices_.size(); ++v) {
      if (!sites.isReached(vertices_[v])) continue;
      std::vector<Candidate> near;
      for (const std::size_t space : areas_[a].spaces) {
        const double away = (spaces[space].patch.finger->center - vertices_[v]).norm();
        if (away < 2 * distance)
          near.push_back({static_cast<std::int32_t>(space), away, 2 * distance});
      }
      area_of_vertex_[v] = static_cast<std::int32_t>(a);
      shares_[v] = sharesFrom(near);
    }
  }
  for (const Triangle& t : triangles_) {
    const std::int32_t area = area_of_vertex_[at(t[0])];
    const bool is_in_it =
        std::ranges::all_of(t, [&](auto vertex) { return area_of_vertex_[at(vertex)] == area; });
    const bool is_fixed = std::ranges::all_of(
        t, [&](auto vertex) { return std::ranges::binary_search(fixed, vertex); });
    area_of_.push_back(is_in_it && !is_fixed ? area : -1);
  }
}

void TouchSurface::setTouchable() {
  PALPATE_ASSERT(shares_.size() == vertices_.size(), "each vertex must have a list of weights");
  PALPATE_ASSERT(area_of_.size() == triangles_.size(), "each triangle needs an area number or -1");
  corner_shares_.resize(triangles_.size());
  std::vector<Triangle> touchable;
  for (std::size_t n = 0; n < triangles_.size(); ++n) {
    const Triangle& t = triangles_[n];
    if (!std::ranges::all_of(t, [this](std::int32_t v) { return !sharesOf(v).empty(); })) continue;
    // A triangle across the rim of an area is not touchable. An area gives forces in its own
    // triangles only, and these forces are not blended with others.
    const bool at_its_rim =
        std::ranges::any_of(t, [this](std::int32_t v) { return area_of_vertex_[at(v)] >= 0; });
    if (at_its_rim && area_of_[n] < 0) continue;
    touchable.push_back(t);
    touch_triangles_.push_back(static_cast<std::int32_t>(n));
    std::map<std::int32_t, Eigen::Vector3d> weights;
    for (std::size_t c = 0; c < 3; ++c)
      for (const SpaceWeight& share : sharesOf(t[c]))
        weights.try_emplace(share.space, Eigen::Vector3d::Zero())
            .first->second[static_cast<Eigen::Index>(c)] = share.weight;
    PALPATE_ASSERT(weights.size() <= most_blended_spaces,
                   "a triangle must not blend too many spaces");
    for (const auto& [space, corners] : weights) corner_shares_[n].push_back({space, corners});
  }
  touch_tree_ = SurfaceTree(vertices_, touchable);
}

Eigen::Vector3d TouchSurface::position(const SurfacePoint& point) const noexcept {
  return combined(cornersOf(vertices_, triangles_[at(point.triangle)]), point.barycentric);
}

SurfacePoint TouchSurface::seenFrom(std::int32_t triangle,
                                    const SurfacePoint& point) const noexcept {
  SurfacePoint seen{triangle, Eigen::Vector3d::Zero()};
  const Triangle &own = triangles_[at(point.triangle)], &other = triangles_[at(triangle)];
  for (Eigen::Index c = 0; c < 3; ++c)
    for (Eigen::Index d = 0; d < 3; ++d)
      if (own[at(c)] == other[at(d)]) seen.barycentric[d] = point.barycentric[c];
  return seen;
}

SurfacePoint TouchSurface::preferTouchable(const SurfacePoint& point) const noexcept {
  if (point.triangle < 0 || touchable(point.triangle)) return point;
  SurfacePoint exact = point;
  for (double& share : exact.barycentric)
    if (share < rounding) share = 0;
  exact.barycentric /= exact.barycentric.sum();
  // A triangle that shares the edge or vertex has a corner at each share that is not zero.
  Eigen::Index corner = 0;
  exact.barycentric.maxCoeff(&corner);
  for (const std::int32_t triangle : trianglesAt(triangles_[at(exact.triangle)][at(corner)])) {
    if (!touchable(triangle)) continue;
    SurfacePoint seen = seenFrom(triangle, exact);
    if (seen.barycentric.sum() > 1 - rounding) return seen;
  }
  return point;
}

Eigen::Vector3d TouchSurface::normal(const SurfacePoint& point) const noexcept {
  const Triangle& t = triangles_[at(point.triangle)];
  const Eigen::Vector3d sum = combined(cornersOf(normals_, t), point.barycentric);
  const double length = sum.norm();
  return length > 1e-6 ? Eigen::Vector3d(sum / length) : faceNormal(point.triangle);
}

SpaceBlend TouchSurface::blendAt(const SurfacePoint& point) const noexcept {
  SpaceBlend blend;
  for (const CornerShares& corners : cornerSharesOf(point.triangle)) {
    const double weight = corners.weights.dot(point.barycentric);
    if (weight > 0) blend.shares[at(blend.size++)] = {corners.space, weight};
  }
  return blend;
}

NearestPoint TouchSurface::nearestTouchable(const Eigen::Vector3d& point) const noexcept {
  NearestPoint nearest = touch_tree_.nearest(point);
  if (nearest.triangle >= 0) nearest.triangle = touch_triangles_[at(nearest.triangle)];
  return nearest;
}

bool sameSurface(const TouchSurface& a, const TouchSurface& b) noexcept {
  return &a == &b || (a.triangles() == b.triangles() && a.vertices() == b.vertices());
}

}  // namespace palpate
