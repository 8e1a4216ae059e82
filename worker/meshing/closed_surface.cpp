#include "worker/meshing/closed_surface.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <numbers>
#include <set>
#include <tuple>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "common/base/index.hpp"
#include "common/base/joined_sets.hpp"
#include "common/base/number_text.hpp"
#include "common/base/program.hpp"
#include "common/base/whole_file.hpp"
#include "common/mesh/node_set.hpp"
#include "common/mesh/self_intersections.hpp"

namespace palpate {
namespace {

/// Maximum number of bodies listed with their sizes in an error.
constexpr std::size_t listed_bodies = 5;

/// Widths of gaps, in diagonals of the body's bounding box. Gaps up to closed_gap (a hundredth of a
/// millimetre for an organ) are closed. If most open edges belong to gaps up to told_gap, the error
/// asks the user to merge corners, otherwise to close holes.
constexpr double closed_gap = 1e-4, told_gap = 1e-2;

/// One edge of one triangle. `low` and `high` are the numbers of its ends, the lower one first.
struct Side {
  std::int32_t low, high, triangle;
  bool upward;  ///< the triangle runs from low to high
};

std::vector<Side> sidesOf(const std::vector<Triangle>& triangles) {
  std::vector<Side> sides;
  sides.reserve(3 * triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (int i = 0; i < 3; ++i) {
      const std::int32_t a = triangles[t][i], b = triangles[t][(i + 1) % 3];
      sides.push_back({std::min(a, b), std::max(a, b), static_cast<std::int32_t>(t), a < b});
    }
  std::ranges::sort(sides, {}, [](const Side& s) { return std::tie(s.low, s.high, s.triangle); });
  return sides;
}

/// Calls visit(span) once per edge, with all sides of that edge. `sides` must be sorted as by
/// sidesOf().
template <class Visit>
void forEachEdge(const std::vector<Side>& sides, Visit visit) {
  for (std::size_t first = 0, next; first < sides.size(); first = next) {
    next = first + 1;
    while (next < sides.size() && sides[next].low == sides[first].low &&
           sides[next].high == sides[first].high)
      ++next;
    visit(std::span(sides).subspan(first, next - first));
  }
}

/// Edges with one triangle (open), and edges with more than two (crowded). Each edge is given by
/// one of its sides.
struct OddEdges {
  std::vector<Side> open, crowded;
};

OddEdges oddEdgesOf(const std::vector<Triangle>& triangles) {
  OddEdges odd;
  forEachEdge(sidesOf(triangles), [&](std::span<const Side> edge) {
    if (edge.size() != 2) (edge.size() == 1 ? odd.open : odd.crowded).push_back(edge[0]);
  });
  return odd;
}

/// A connected part of the surface.
struct SurfaceShell {
  std::vector<std::int32_t> triangles;
  Eigen::AlignedBox3d box = {};
  double volume = 0;  ///< positive if the shell faces outward
  double area = 0;
  std::int64_t open_edges = 0;
  int depth = 0;             ///< number of shells around it
  std::int32_t around = -1;  ///< the smallest of these shells; -1 if there is none
};

class SurfaceRepair {
 public:
  SurfaceRepair(TriangleSoup soup, const std::string& source, Bodies bodies,
                const Fineness& fineness)
      : points_(std::move(soup.points)),
        triangles_(std::move(soup.triangles)),
        source_(source),
        bodies_(bodies),
        fineness_(fineness) {}

  ClosedSurface make() {
    refuseNumbers();
    mergePoints();
    dropIdleTriangles();
    closeGaps();
    cutBesideFlatTriangles();
    findShells();
    if (bodies_ == Bodies::largest) leaveOutOpenScraps();
    refuseEdges();
    turnAlike();
    measureShells();
    nest();
    chooseBody();
    turnOutward();
    refuseCuts();
    return result();
  }

 private:
  template <class... Args>
  void note(fmt::format_string<Args...> format, Args&&... args) {
    notes_.push_back(fmt::format(format, std::forward<Args>(args)...));
  }

  template <class... Args>
  [[nodiscard]] Error wrong(fmt::format_string<Args...> format, Args&&... args) const {
    return badInput("{}: {}", source_, fmt::format(format, std::forward<Args>(args)...));
  }

  void refuseNumbers() {
    if (triangles_.empty()) throw wrong("there are no triangles");
    for (const Eigen::Vector3d& point : points_) {
      if (!(point.array().abs() <= farthest_node).all())
        throw wrong("a corner at {} is not finite, or too far away", placeText(point));
    }
    for (const Triangle& triangle : triangles_)
      for (const std::int32_t corner : triangle) {
        if (corner < 0 || at(corner) >= points_.size())
          throw wrong("a triangle uses corner {}, but there are only {}", corner, points_.size());
        box_.extend(points_[corner]);
      }
  }

  /// Merges equal corners, because an STL file repeats a corner in each of its triangles. Then
  /// merges nearly equal corners.
  void mergePoints() {
    const auto less = [this](std::int32_t a, std::int32_t b) {
      const Eigen::Vector3d &p = points_[a], &q = points_[b];
      return std::tie(p[0], p[1], p[2]) < std::tie(q[0], q[1], q[2]);
    };
    std::vector<std::int32_t> order = countUp(points_.size()), same_as(points_.size());
    std::ranges::sort(order, less);
    std::vector<Eigen::Vector3d> distinct;
    for (const std::int32_t point : order) {
      if (distinct.empty() || distinct.back() != points_[point]) distinct.push_back(points_[point]);
      same_as[point] = static_cast<std::int32_t>(distinct.size()) - 1;
    }
    points_ = std::move(distinct);
    renumber(triangles_, same_as);
    mergeNearPoints();
  }

  void mergeNearPoints() {
    const double reach = coincident_distance * box_.diagonal().norm();
    if (!(reach > 0)) throw wrong("all its corners coincide");
    const auto merged = coincidentNodes(points_, reach);
    if (merged.empty()) return;
    std::vector<std::int32_t> same_as = countUp(points_.size());
    for (const auto& [point, lowest] : merged) same_as[point] = lowest;
    renumber(triangles_, same_as);
    note("merged: {} within {:.2g} of others", counted(merged.size(), "corner"), reach);
  }

  static void renumber(std::vector<Triangle>& triangles, const std::vector<std::int32_t>& same_as) {
    for (Triangle& triangle : triangles)
      for (std::int32_t& corner : triangle) corner = same_as[corner];
  }

  static bool hasRepeatedCorner(const Triangle& t) {
    return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
  }

  /// Drops triangles with two equal corners, and repeated triangles.
  void dropIdleTriangles() {
    const auto flat = std::erase_if(triangles_, hasRepeatedCorner);
    if (flat > 0)
      note("left out: {}", counted(flat, "triangle without area", "triangles without area"));
    std::set<Triangle> known;
    const auto repeated = std::erase_if(triangles_, [&](Triangle corners) {
      std::ranges::sort(corners);
      return !known.insert(corners).second;
    });
    if (repeated > 0) note("left out: {}", counted(repeated, "repeated triangle"));
    if (triangles_.empty()) throw wrong("all its triangles have zero area");
  }

  /// The result of merging nearby corners of open edges. `left` has the odd edges that remain.
  struct JoinedCorners {
    std::vector<std::int32_t> same_as;
    std::int64_t count = 0;
    double farthest = 0;  ///< largest distance of a merged corner from its target
    OddEdges left;
  };

  /// Finds the corners of open edges to merge: those at most `reach` apart, and at most a quarter
  /// of the mean length of these edges, so that holes remain. Does not change the surface.
  JoinedCorners joinedCorners(const std::vector<Side>& open, double reach) const {
    std::vector<std::int32_t> corners;
    double length = 0;
    for (const Side& side : open) {
      corners.insert(corners.end(), {side.low, side.high});
      length += (points_[side.high] - points_[side.low]).norm();
    }
    sortUnique(corners);
    const auto places = mapped(corners, [&](std::int32_t corner) { return points_[corner]; });
    JoinedCorners joined;
    joined.same_as = countUp(points_.size());
    for (const auto& [place, lowest] :
         coincidentNodes(places, std::min(reach, length / static_cast<double>(open.size()) / 4))) {
      joined.same_as[corners[place]] = corners[lowest];
      joined.farthest = std::max(joined.farthest, (places[place] - places[lowest]).norm());
      ++joined.count;
    }
    std::vector<Triangle> triangles = triangles_;
    renumber(triangles, joined.same_as);
    std::erase_if(triangles, hasRepeatedCorner);
    joined.left = oddEdgesOf(triangles);
    return joined;
  }

  /// Closes gaps too narrow to be visible. Programs leave gaps when they cut a surface, or when
  /// they round the coordinates of a corner differently in each of its triangles.
  void closeGaps() {
    const OddEdges before = oddEdgesOf(triangles_);
    if (before.open.empty()) return;
    const JoinedCorners joined = joinedCorners(before.open, closed_gap * box_.diagonal().norm());
    if (joined.left.open.size() >= before.open.size() ||
        joined.left.crowded.size() > before.crowded.size())
      return;
    renumber(triangles_, joined.same_as);
    note("gaps were closed: {} at open edges merged with others up to {:.2g} away",
         counted(joined.count, "corner"), joined.farthest);
    dropIdleTriangles();
  }

  /// Removes triangles without area. Programs insert such a triangle to close a crack between a
  /// corner on one side and the middle of an edge on the other side. Here, the triangle at that
  /// edge is cut in two at that corner instead.
  void cutBesideFlatTriangles() {
    bool cut = false;
    while (cutBesideOneEach()) cut = true;
    if (cut) note("triangles with three corners on a line were removed");
  }

  /// Removes each flat triangle and cuts its neighbour, unless that neighbour is flat too or was
  /// already cut in this pass. Returns false if nothing could be cut.
  bool cutBesideOneEach() {
    std::vector<bool> done(triangles_.size());
    std::vector<Triangle> more;
    forEachEdge(sidesOf(triangles_), [&](std::span<const Side> edge) {
      if (edge.size() != 2) return;
      for (const auto& [flat, other] : {std::pair(edge[0].triangle, edge[1].triangle),
                                        std::pair(edge[1].triangle, edge[0].triangle)}) {
        const std::int32_t middle = middleCorner(flat);
        if (done[flat] || done[other] || middle < 0 || middle == edge[0].low ||
            middle == edge[0].high || middleCorner(other) >= 0)
          continue;
        done[flat] = done[other] = true;
        for (const std::int32_t end : {edge[0].low, edge[0].high}) {
          Triangle part = triangles_[other];
          std::ranges::replace(part, end, middle);
          more.push_back(part);
        }
      }
    });
    if (more.empty()) return false;
    remove(done);
    triangles_.insert(triangles_.end(), more.begin(), more.end());
    return true;
  }

  /// Returns the corner of triangle t that lies on the opposite edge; -1 if t is not flat.
  std::int32_t middleCorner(std::int32_t t) const {
    const Triangle& corners = triangles_[t];
    int first = 0;  // first corner of the longest edge
    double longest = 0;
    for (int i = 0; i < 3; ++i)
      if (const double length = (points_[corners[(i + 1) % 3]] - points_[corners[i]]).norm();
          length > longest) {
        longest = length;
        first = i;
      }
    const double height = crossOf(t).norm() / longest;
    return height <= coincident_distance * box_.diagonal().norm() ? corners[(first + 2) % 3] : -1;
  }

  /// Finds the shells, which are the connected parts of the surface: triangles that share an edge
  /// belong to one shell.
  void findShells() {
    JoinedSets shells(triangles_.size());
    const std::vector<Side> sides = sidesOf(triangles_);
    forEachEdge(sides, [&](std::span<const Side> edge) {
      for (const Side& side : edge.subspan(1)) shells.join(edge[0].triangle, side.triangle);
    });
    shells_.clear();
    std::map<std::int32_t, std::size_t> shell_of;
    for (std::int32_t t = 0; t < static_cast<std::int32_t>(triangles_.size()); ++t) {
      const auto [found, is_new] = shell_of.emplace(shells.lowest(t), shells_.size());
      if (is_new) shells_.emplace_back();
      SurfaceShell& shell = shells_[found->second];
      shell.triangles.push_back(t);
      for (const std::int32_t corner : triangles_[t]) shell.box.extend(points_[corner]);
      shell.area += crossOf(t).norm() / 2;
    }
    forEachEdge(sides, [&](std::span<const Side> edge) {
      if (edge.size() == 1) ++shells_[shell_of.at(shells.lowest(edge[0].triangle))].open_edges;
    });
  }

  Eigen::Vector3d crossOf(std::int32_t t) const {
    const auto& [a, b, c] = triangles_[t];
    return (points_[b] - points_[a]).cross(points_[c] - points_[a]);
  }

  /// Drops every open piece that is smaller than the largest piece. Only the largest body is
  /// wanted, so small open pieces are not an error.
  void leaveOutOpenScraps() {
    const double largest = std::ranges::max(shells_, {}, &SurfaceShell::area).area;
    const std::size_t count = leaveOut(
        [&](const SurfaceShell& shell) { return shell.area < largest && shell.open_edges > 0; });
    if (count > 0) note("left out: {} besides the largest", counted(count, "open piece"));
  }

  /// Drops the shells for which `idle` returns true. Returns the number of dropped shells.
  template <class Idle>
  std::size_t leaveOut(Idle idle) {
    std::vector<bool> gone(triangles_.size());
    std::size_t count = 0;
    for (const SurfaceShell& shell : shells_) {
      if (!idle(shell)) continue;
      ++count;
      for (const std::int32_t t : shell.triangles) gone[t] = true;
    }
    if (count > 0) {
      remove(gone);
      findShells();
    }
    return count;
  }

  void remove(const std::vector<bool>& gone) {
    std::size_t number = 0;
    std::erase_if(triangles_, [&](const Triangle&) { return gone[number++]; });
  }

  Eigen::Vector3d middleOf(const Side& side) const {
    return (points_[side.low] + points_[side.high]) / 2;
  }

  void refuseEdges() const {
    const auto& [open, crowded] = oddEdgesOf(triangles_);
    if (!open.empty())
      throw wrong(
          "the surface is open: {} of its edges have only one triangle, the first at {}; {}",
          open.size(), placeText(middleOf(open.front())), remedyOf(open));
    if (!crowded.empty())
      throw wrong(
          "{} of its edges have more than two triangles, the first at {}: there are walls inside "
          "the body, or bodies touch; keep only the outer surface (MeshLab: Remove Non Manifold "
          "Edges; Blender: 3D-Print Toolbox, Make Manifold)",
          crowded.size(), placeText(middleOf(crowded.front())));
  }

  std::string remedyOf(const std::vector<Side>& open) const {
    const JoinedCorners joined = joinedCorners(open, told_gap * box_.diagonal().norm());
    const std::size_t left = joined.left.open.size();
    if (2 * left <= open.size())
      return fmt::format(
          "corners that should coincide lie up to {:.2g} apart: merge them (MeshLab: Merge Close "
          "Vertices; Blender: Merge by Distance){} and save it again",
          joined.farthest,
          left > 0 ? fmt::format(", close the remaining holes ({} open edges),", left) : "");
    return fmt::format(
        "close its holes (MeshLab: Close Holes; Blender: 3D-Print Toolbox, Make Manifold) and save "
        "it again{}",
        shells_.size() > 1 && bodies_ == Bodies::only
            ? fmt::format(" (there are {} separate pieces; --largest keeps one)", shells_.size())
            : "");
  }

  /// Turns triangles until neighbours run through their common edge in opposite directions. Starts
  /// from the first triangle of each shell and proceeds from neighbour to neighbour.
  void turnAlike() {
    const std::vector<Side> sides = sidesOf(triangles_);
    // The neighbours of each triangle, and whether they face the same way.
    std::vector<std::vector<std::pair<std::int32_t, bool>>> neighbours(triangles_.size());
    forEachEdge(sides, [&](std::span<const Side> edge) {
      PALPATE_ASSERT(edge.size() == 2, "each edge must join two triangles");
      for (const int one : {0, 1})
        neighbours[edge[one].triangle].emplace_back(edge[1 - one].triangle,
                                                    edge[0].upward != edge[1].upward);
    });
    std::vector<std::int8_t> turned(triangles_.size(), -1);
    std::int64_t total = 0;
    for (const SurfaceShell& shell : shells_) {
      std::int64_t in_shell = 0;
      std::vector<std::int32_t> open = {shell.triangles.front()};
      turned[open[0]] = 0;
      while (!open.empty()) {
        const std::int32_t t = open.back();
        open.pop_back();
        in_shell += turned[t];
        for (const auto& [next, is_alike] : neighbours[t]) {
          const std::int8_t wanted = is_alike ? turned[t] : 1 - turned[t];
          if (turned[next] < 0) {
            turned[next] = wanted;
            open.push_back(next);
          } else if (turned[next] != wanted) {
            throw wrong(
                "the surface has only one side at {}, like a Moebius strip, and encloses nothing; "
                "repair it in the program that made it",
                placeText(points_[triangles_[t][0]]));
          }
        }
      }
      total += std::min(in_shell, static_cast<std::int64_t>(shell.triangles.size()) - in_shell);
    }
    for (std::size_t t = 0; t < triangles_.size(); ++t)
      if (turned[t] == 1) std::swap(triangles_[t][1], triangles_[t][2]);
    if (total > 0)
      note("reversed: {} of {}, whose neighbours faced the opposite way", total,
           counted(triangles_.size(), "triangle"));
  }

  void measureShells() {
    for (SurfaceShell& shell : shells_) {
      const Eigen::Vector3d origin = shell.box.center();
      for (const std::int32_t t : shell.triangles)
        shell.volume += (points_[triangles_[t][0]] - origin).dot(crossOf(t)) / 6;
    }
    // Shells with a smaller ratio |volume| / area^1.5 are dropped. A sphere has 0.094.
    constexpr double flat = 1e-6;
    const std::size_t left_out = leaveOut([](const SurfaceShell& shell) {
      return std::abs(shell.volume) <= flat * std::pow(shell.area, 1.5);
    });
    if (left_out == 0) return;
    if (triangles_.empty())
      throw wrong("the surface encloses no volume: it is flat or folded onto itself");
    note("left out: {} without a volume", counted(left_out, "piece"));
    measureShells();
  }

  /// Returns whether a point lies inside a shell. The shell's solid angle is 4 pi at points inside,
  /// zero outside.
  bool isInside(const Eigen::Vector3d& point, const SurfaceShell& shell) const {
    if (!shell.box.contains(point)) return false;
    double angle = 0;
    for (const std::int32_t t : shell.triangles) {
      std::array<Eigen::Vector3d, 3> r;
      for (int i = 0; i < 3; ++i) r[i] = points_[triangles_[t][i]] - point;
      const double a = r[0].norm(), b = r[1].norm(), c = r[2].norm();
      // Van Oosterom and Strackee, IEEE Trans. Biomed. Eng. 30 (1983).
      angle +=
          2 * std::atan2(r[0].dot(r[1].cross(r[2])),
                         a * b * c + r[0].dot(r[1]) * c + r[1].dot(r[2]) * a + r[2].dot(r[0]) * b);
    }
    return std::abs(angle) > 2 * std::numbers::pi;
  }

  void nest() {
    for (std::size_t inner = 0; inner < shells_.size(); ++inner) {
      endWhenInterrupted();
      for (std::size_t outer = 0; outer < shells_.size(); ++outer) {
        SurfaceShell &in = shells_[inner], &out = shells_[outer];
        if (inner == outer || !out.box.contains(in.box)) continue;
        if (!isInside(points_[triangles_[in.triangles[0]][0]], out)) continue;
        ++in.depth;
        if (in.around < 0 || std::abs(out.volume) < std::abs(shells_[in.around].volume))
          in.around = static_cast<std::int32_t>(outer);
      }
    }
  }

  static bool isBody(const SurfaceShell& shell) { return shell.depth % 2 == 0; }

  void chooseBody() {
    std::vector<std::int32_t> bodies;
    for (std::int32_t s = 0; s < static_cast<std::int32_t>(shells_.size()); ++s)
      if (isBody(shells_[s])) bodies.push_back(s);
    // If shells intersect, each may seem to be inside another.
    if (bodies.empty())
      throw wrong(
          "its {} pieces intersect each other; join them in the program that made them (Blender: "
          "Boolean union)",
          shells_.size());
    std::ranges::sort(bodies, [this](std::int32_t a, std::int32_t b) {
      return std::abs(shells_[a].volume) > std::abs(shells_[b].volume);
    });
    if (bodies.size() > 1 && bodies_ == Bodies::only) {
      std::string sizes;
      for (std::size_t i = 0; i < std::min(bodies.size(), listed_bodies); ++i) {
        const Eigen::Vector3d size = shells_[bodies[i]].box.sizes();
        sizes += fmt::format("{}{:.4g} x {:.4g} x {:.4g} at {}", i == 0 ? "" : ", ", size[0],
                             size[1], size[2], placeText(shells_[bodies[i]].box.center()));
      }
      throw wrong(
          "there are {} separate bodies: {}{}; keep the largest with --largest, or join them in "
          "the program that made them",
          bodies.size(), sizes, bodies.size() > listed_bodies ? ", ..." : "");
    }
    const std::int32_t body = bodies.front();
    if (bodies.size() > 1) note("the largest of {} bodies was kept", bodies.size());
    std::erase_if(shells_, [&, number = 0](const SurfaceShell& shell) mutable {
      const std::int32_t s = number++;
      return s != body && !(shell.around == body && !isBody(shell));
    });
    fillSpecks();
    if (shells_.size() > 1) note("cavities (shells inside the body): {}", shells_.size() - 1);
  }

  /// Fills cavities narrower than an element edge, such as the specks that scans leave inside a
  /// body. A mesh cannot resolve them, and would spend a dozen nodes on each.
  void fillSpecks() {
    const SurfaceShell& body = *std::ranges::find_if(shells_, isBody);
    const double whole = std::abs(body.volume),
                 edge = fineness_.size.value_or(edgeFor(whole, body.area, fineness_.nodes));
    double volume = 0;
    const auto count = std::erase_if(shells_, [&](const SurfaceShell& shell) {
      const bool is_speck = !isBody(shell) && shell.box.sizes().maxCoeff() < edge;
      if (is_speck) volume += std::abs(shell.volume);
      return is_speck;
    });
    if (count > 0)
      note(
          "filled: {} narrower than an element edge of {:.3g}, {:.2g} % of the volume; more "
          "nodes or a smaller --size would keep them",
          counted(count, "cavity", "cavities"), edge, 100 * volume / whole);
  }

  void turnOutward() {
    std::vector<Triangle> chosen;
    for (SurfaceShell& shell : shells_) {
      const bool inward = (shell.volume < 0) == isBody(shell);
      if (inward && isBody(shell)) note("the surface faced inward and was reversed");
      if (inward) shell.volume = -shell.volume;
      for (std::int32_t& t : shell.triangles) {
        Triangle triangle = triangles_[t];
        if (inward) std::swap(triangle[1], triangle[2]);
        t = static_cast<std::int32_t>(chosen.size());
        chosen.push_back(triangle);
      }
    }
    triangles_ = std::move(chosen);
    dropIdlePoints();
  }

  void dropIdlePoints() {
    std::vector<std::int32_t> number(points_.size(), -1);
    std::vector<Eigen::Vector3d> kept;
    for (Triangle& triangle : triangles_)
      for (std::int32_t& corner : triangle) {
        if (number[corner] < 0) {
          number[corner] = static_cast<std::int32_t>(kept.size());
          kept.push_back(points_[corner]);
        }
        corner = number[corner];
      }
    points_ = std::move(kept);
  }

  void refuseCuts() const {
    const SelfIntersections cuts = selfIntersectionsOf(points_, triangles_);
    if (cuts.count == 0) return;
    const Triangle& triangle = triangles_[cuts.first[0]];
    throw wrong(
        "the surface intersects itself: {} pairs of its triangles cross, overlap or touch, the "
        "first at {}; repair it (Blender: Remesh modifier, or Boolean union; MeshLab: Uniform Mesh "
        "Resampling) and save it again",
        cuts.count,
        placeText((points_[triangle[0]] + points_[triangle[1]] + points_[triangle[2]]) / 3));
  }

  /// Returns a point inside a cavity: halfway between its largest triangle and the opposite wall.
  Eigen::Vector3d pointInside(const SurfaceShell& shell) const {
    const std::int32_t largest = *std::ranges::max_element(
        shell.triangles, {}, [this](std::int32_t t) { return crossOf(t).norm(); });
    const Triangle& from = triangles_[largest];
    const Eigen::Vector3d start = (points_[from[0]] + points_[from[1]] + points_[from[2]]) / 3;
    // The normals of a cavity point into it.
    const Eigen::Vector3d along = crossOf(largest).normalized();
    double nearest = box_.diagonal().norm();
    for (const std::int32_t t : shell.triangles) {
      if (t == largest) continue;
      const Eigen::Vector3d a = points_[triangles_[t][0]], u = points_[triangles_[t][1]] - a,
                            v = points_[triangles_[t][2]] - a, normal = u.cross(v);
      const double slope = normal.dot(along);
      if (slope == 0) continue;
      const double distance = normal.dot(a - start) / slope;
      const Eigen::Vector3d hit = start + distance * along - a;
      const double x = normal.dot(hit.cross(v)), y = normal.dot(u.cross(hit)),
                   all = normal.squaredNorm();
      if (distance > 0 && x >= 0 && y >= 0 && x + y <= all) nearest = std::min(nearest, distance);
    }
    return start + nearest / 2 * along;
  }

  ClosedSurface result() {
    ClosedSurface surface;
    for (const SurfaceShell& shell : shells_) {
      surface.volume += shell.volume;
      surface.area += shell.area;
      if (!isBody(shell)) surface.cavities.push_back(pointInside(shell));
    }
    surface.points = std::move(points_);
    surface.triangles = std::move(triangles_);
    surface.notes = std::move(notes_);
    return surface;
  }

  std::vector<Eigen::Vector3d> points_;
  std::vector<Triangle> triangles_;
  const std::string& source_;
  Bodies bodies_;
  const Fineness fineness_;
  Eigen::AlignedBox3d box_;
  std::vector<SurfaceShell> shells_;
  std::vector<std::string> notes_;
};

}  // namespace

TriangleSoup readTriangles(const std::filesystem::path& file) {
  const std::string bytes = readText(file, "surface");
  std::size_t at = 0;
  const auto take = [&](void* to, std::size_t count) {
    if (count > bytes.size() - at)
      throw failure("{}: the converted surface is incomplete", file.string());
    std::memcpy(to, bytes.data() + at, count);
    at += count;
  };
  std::array<std::int64_t, 2> counts{};
  take(counts.data(), sizeof counts);
  const auto limit = static_cast<std::int64_t>(bytes.size());
  if (counts[0] < 0 || counts[1] < 0 || counts[0] > limit || counts[1] > limit)
    throw failure("{}: the converted surface is incomplete", file.string());
  TriangleSoup soup;
  soup.points.resize(static_cast<std::size_t>(counts[0]));
  soup.triangles.resize(static_cast<std::size_t>(counts[1]));
  static_assert(sizeof(Eigen::Vector3d) == 3 * sizeof(double) && sizeof(Triangle) == 12);
  take(soup.points.data(), 3 * sizeof(double) * soup.points.size());
  take(soup.triangles.data(), sizeof(Triangle) * soup.triangles.size());
  return soup;
}

double edgeFor(double volume, double area, double nodes) {
  PALPATE_ASSERT(volume > 0 && area > 0 && nodes > 0, "volume, area and nodes must be positive");
  // The number of nodes falls with the edge length h, so bisection finds h.
  double low = 0, high = std::cbrt(std::numbers::sqrt2 * volume) + std::sqrt(area);
  for (int n = 0; n < 60; ++n) {
    const double h = (low + high) / 2;
    const double made =
        std::numbers::sqrt2 * volume / (h * h * h) + area / (std::numbers::sqrt3 * h * h);
    (made > nodes ? low : high) = h;
  }
  return high;
}

ClosedSurface closedSurface(TriangleSoup soup, const std::string& source, Bodies bodies,
                            const Fineness& fineness) {
  return SurfaceRepair(std::move(soup), source, bodies, fineness).make();
}

}  // namespace palpate
