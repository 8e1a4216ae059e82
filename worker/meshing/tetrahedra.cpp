#include "worker/meshing/tetrahedra.hpp"

#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <map>
#include <numbers>
#include <sstream>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/base/whole_file.hpp"
#include "common/mesh/mesh_reader.hpp"
#include "worker/meshing/mesh_conversion.hpp"

namespace palpate {
namespace {

/// Maximum number of edge lengths that are tried to reach the requested number of nodes.
constexpr int most_tries = 5;
/// Exponent of the number of nodes as a function of the edge length. It is -3 in the interior and
/// -2 on the surface.
constexpr double nodes_by_size = -2.5;
/// Relative differences between the volumes of the mesh and the surface. Above lost_volume the mesh
/// is rejected; above told_volume a note reports the difference.
constexpr double lost_volume = 0.25, told_volume = 0.05;
/// An edge is a crease of the body if its two triangles form at least this angle (degrees between
/// the normals), and if such edges form lines (hasCreases).
constexpr double crease = 40;

/// Returns the line in which a program reports an error, or its last line.
std::string decisiveLine(const Ran& ran) {
  std::string last, error;
  std::istringstream lines(ran.out + "\n" + ran.err);
  for (std::string line; std::getline(lines, line);) {
    if (line.find_first_not_of(" -\r") == std::string::npos) continue;
    last = line;
    const bool speaks = line.starts_with("Error") || line.find("rror:") != std::string::npos ||
                        line.find("intersect") != std::string::npos;
    const bool says_more = line.find("error summary") == std::string::npos &&
                           line.find("Check the full log") == std::string::npos &&
                           line.find("----") == std::string::npos &&
                           line.find("error") != line.size() - 5;
    if (speaks && says_more && error.empty()) error = line;
  }
  if (last.empty()) return fmt::format("ended with exit code {} and no message", ran.exit_code);
  return printable(error.empty() ? last : error, longest_reason);
}

std::string coordinates(const Eigen::Vector3d& x) {
  return fmt::format("{:.17g} {:.17g} {:.17g}", x[0], x[1], x[2]);
}

/// Returns the triangles, and a point in each cavity, in tetgen's format .smesh.
std::string trianglesAsSmesh(const ClosedSurface& surface) {
  std::string text;
  auto out = std::back_inserter(text);
  fmt::format_to(out, "{} 3 0 0\n", surface.points.size());
  for (std::size_t n = 0; n < surface.points.size(); ++n)
    fmt::format_to(out, "{} {}\n", n, coordinates(surface.points[n]));
  fmt::format_to(out, "{} 0\n", surface.triangles.size());
  for (const auto& [a, b, c] : surface.triangles) fmt::format_to(out, "3 {} {} {}\n", a, b, c);
  fmt::format_to(out, "{}\n", surface.cavities.size());
  for (std::size_t h = 0; h < surface.cavities.size(); ++h)
    fmt::format_to(out, "{} {}\n", h, coordinates(surface.cavities[h]));
  return text + "0\n";
}

/// Returns a file of Gmsh's format 2.2. Triangles belong to the physical group `surface` (0: none),
/// tetrahedra to group 2.
std::string asMsh(const char* group_names, const std::vector<Eigen::Vector3d>& points,
                  const std::vector<Triangle>& triangles, int surface,
                  const std::vector<Tetrahedron>& tetrahedra) {
  std::string text = fmt::format("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n{}$Nodes\n{}\n",
                                 group_names, points.size());
  auto out = std::back_inserter(text);
  for (std::size_t n = 0; n < points.size(); ++n)
    fmt::format_to(out, "{} {}\n", n + 1, coordinates(points[n]));
  fmt::format_to(out, "$EndNodes\n$Elements\n{}\n", triangles.size() + tetrahedra.size());
  std::size_t element = 0;
  for (const auto& [a, b, c] : triangles)
    fmt::format_to(out, "{} 2 2 {} 1 {} {} {}\n", ++element, surface, a + 1, b + 1, c + 1);
  for (const auto& [a, b, c, d] : tetrahedra)
    fmt::format_to(out, "{} 4 2 2 1 {} {} {} {}\n", ++element, a + 1, b + 1, c + 1, d + 1);
  return text + "$EndElements\n";
}

/// Returns a file with the mesh and its groups "surface" and "body".
std::string meshAsMsh(const Mesh& mesh) {
  return asMsh("$PhysicalNames\n2\n2 1 \"surface\"\n3 2 \"body\"\n$EndPhysicalNames\n", mesh.nodes,
               mesh.surface, 1, mesh.tetrahedra);
}

/// Returns whether the sharp edges of the surface form lines, like the edges of a box. The noise of
/// a coarse or scanned surface has sharp edges too, but they end after a triangle or two.
bool hasCreases(const ClosedSurface& surface) {
  std::map<Edge, Eigen::Vector3d> normal_of;
  std::map<std::int32_t, int> sharp_at;
  const double limit = std::cos(crease * std::numbers::pi / 180);
  for (const Triangle& t : surface.triangles) {
    const Eigen::Vector3d a = surface.points[t[0]];
    const Eigen::Vector3d normal =
        (surface.points[t[1]] - a).cross(surface.points[t[2]] - a).stableNormalized();
    for (int i = 0; i < 3; ++i) {
      const Edge edge = {std::min(t[i], t[(i + 1) % 3]), std::max(t[i], t[(i + 1) % 3])};
      const auto [other, is_first] = normal_of.emplace(edge, normal);
      if (is_first || other->second.dot(normal) > limit) continue;
      ++sharp_at[edge[0]];
      ++sharp_at[edge[1]];
    }
  }
  const auto ends = std::ranges::count_if(sharp_at, [](const auto& at) { return at.second == 1; });
  return 10 * ends < static_cast<std::ptrdiff_t>(sharp_at.size());
}

constexpr const char* gmsh_settings = R"(
Mesh.MeshSizeMin = {0:.17g};
Mesh.MeshSizeMax = {0:.17g};
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.Algorithm = 6;
Mesh.Algorithm3D = 1;
Mesh.Optimize = 1;
Mesh.OptimizeThreshold = 0.4;
Mesh.Smoothing = 10;
Mesh.Binary = 0;
Mesh.MshFileVersion = 2.2;
General.NumThreads = 1;
)";

constexpr const char* gmsh_body = R"(
faces() = Surface{:};
Surface Loop(1) = faces();
Volume(1) = {1};
Physical Surface("surface") = faces();
Physical Volume("body") = {1};
)";

class Filling {
 public:
  Filling(const ClosedSurface& surface, std::filesystem::path folder)
      : surface_(surface), folder_(std::move(folder)) {}

  // Each of these functions returns the text of a .msh file with edges of about `size`. Error with
  // the reason if a program is missing or fails.

  /// Makes new triangles of this edge length, and then tetrahedra.
  std::string byGmsh(double size) const {
    const double angle = (hasCreases(surface_) ? crease : 180) * std::numbers::pi / 180;
    return runGmsh(fmt::format("ClassifySurfaces{{{:.6g}, 1, 1, Pi}};\nCreateGeometry;", angle),
                   size);
  }

  /// Makes tetrahedra and keeps the given triangles.
  std::string byGmshOnTriangles(double size) const { return runGmsh("", size); }

  std::string byTetgen(double size) const {
    replaceFile(folder_ / "surface.smesh", trianglesAsSmesh(surface_), "surface");
    // The upper limit that tetgen gets for the volume of a tetrahedron is the volume of a regular
    // tetrahedron with this edge length. Without -Y, tetgen splits the triangles, which gives five
    // times as many nodes on a sphere, with worse shapes.
    const double volume = size * size * size / (6 * std::numbers::sqrt2);
    const std::filesystem::path node = folder_ / "surface.1.node";
    run({"tetgen", fmt::format("-pYq1.4a{:.6g}", volume), (folder_ / "surface.smesh").string()},
        node);
    return meshAsMsh(readGmsh(convertMesh(node, folder_).file));
  }

 private:
  /// Runs a program that makes the file `output`.
  static void run(const std::vector<std::string>& words, const std::filesystem::path& output) {
    std::error_code ignored;
    std::filesystem::remove(output, ignored);
    const Ran ran = runMeshing({.words = words, .package = words.front()});
    if (ran.exit_code != 0 || !std::filesystem::exists(output, ignored))
      throw failure("{}: {}", words.front(), decisiveLine(ran));
  }

  std::string runGmsh(const std::string& remesh, double size) const {
    replaceFile(folder_ / "surface.msh", asMsh("", surface_.points, surface_.triangles, 0, {}),
                "surface");
    const std::string geo = "Merge \"surface.msh\";\n" + remesh + gmsh_body +
                            fmt::format(fmt::runtime(gmsh_settings), size);
    replaceFile(folder_ / "body.geo", geo, "geometry");
    const std::filesystem::path body = folder_ / "body.msh";
    // Otherwise, options that the user saved in gmsh would change the mesh.
    setenv("GMSH_HOME", folder_.c_str(), 1);
    run({"gmsh", "-3", (folder_ / "body.geo").string(), "-format", "msh22", "-o", body.string(),
         "-v", "3"},
        body);
    return readText(body, "mesh");
  }

  const ClosedSurface& surface_;
  std::filesystem::path folder_;
};

/// Reads the mesh that a program has made. Error if it is unreadable or its volume is wrong.
Tetrahedra accepted(std::string msh, const ClosedSurface& surface) {
  Tetrahedra made{std::move(msh), {}};
  made.mesh = parseGmsh(made.msh, "its output");
  const double change = measure(made.mesh).volume / surface.volume - 1;
  if (std::abs(change) > lost_volume)
    throw failure("its tetrahedra have {:.3g} times the volume of the surface", 1 + change);
  if (std::abs(change) > told_volume)
    made.notes.push_back(
        fmt::format("the mesh has {:.2g} % {} volume than the surface; with more nodes the "
                    "difference is smaller",
                    100 * std::abs(change), change < 0 ? "less" : "more"));
  return made;
}

/// Refuses sizes that would keep the machine busy for hours, or give no element. The user has
/// probably given the size in another unit than the file's.
void refuseSize(double size, const ClosedSurface& surface, const std::string& source) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& point : surface.points) box.extend(point);
  const double extent = box.sizes().maxCoeff();
  const double nodes = std::numbers::sqrt2 * surface.volume / (size * size * size);
  if (size < extent && nodes < most_nodes) return;
  throw badInput(
      "{}: --size {:.4g} gives {}: the body is {:.4g} wide; is the size in the unit of the file?",
      source, size,
      size < extent ? fmt::format("about {:.2g} nodes", nodes) : std::string("no element"), extent);
}

/// Fills a surface by one program, and adapts the edge length until the number of nodes is near
/// enough to the requested one. Returns the best mesh. Throws the first Error if there is none, and
/// the Error of an interrupt.
template <class Fill>
Tetrahedra nearest(const ClosedSurface& surface, const Fineness& fineness, Fill fill) {
  double size =
      fineness.size.value_or(edgeFor(surface.volume, surface.area, double(fineness.nodes)));
  std::optional<Tetrahedra> best;
  double best_off = 0, best_change = 0;
  for (int n = 0; n < most_tries; ++n) {
    Tetrahedra made;
    try {
      made = accepted(fill(size), surface);
    } catch (const Error& error) {
      if (!best || error.exitCode() == ExitCode::interrupted) throw;
      break;
    }
    const auto nodes = static_cast<double>(made.mesh.nodes.size());
    const double off = std::abs(std::log(nodes / fineness.nodes)),
                 change = std::abs(measure(made.mesh).volume / surface.volume - 1);
    spdlog::info("{} nodes with edges of {:.3g}", made.mesh.nodes.size(), size);
    // Fine details of the surface need many nodes, whatever the edge length. If a coarser mesh
    // loses volume of the body, the finer mesh is kept.
    if (best && change > told_volume && best_change <= told_volume) break;
    if (!best || off < best_off) {
      best_change = change;
      best = std::move(made);
      best_off = off;
    }
    if (fineness.size || off < std::log(1 + near_enough)) break;
    size *= std::pow(fineness.nodes / nodes, 1 / nodes_by_size);
  }
  return std::move(*best);
}

}  // namespace

Tetrahedra fillWithTetrahedra(const ClosedSurface& surface, const Fineness& fineness, Mesher mesher,
                              const std::filesystem::path& folder, const std::string& source) {
  PALPATE_ASSERT(surface.volume > 0 && !surface.triangles.empty(), "the surface must face outward");
  if (fineness.size) refuseSize(*fineness.size, surface, source);
  const Filling filling(surface, folder);
  struct Way {
    bool wanted;
    const char* program;
    std::string (Filling::*fill)(double size) const;
    const char* how;
  };
  const bool again = mesher == Mesher::automatic && isInstalled("gmsh");
  const std::array<Way, 3> ways = {
      {{mesher != Mesher::tetgen, "gmsh", &Filling::byGmsh, nullptr},
       {again, "gmsh", &Filling::byGmshOnTriangles,
        "filled by gmsh within the given triangles, because it could not make new ones of the "
        "wanted size"},
       {mesher != Mesher::gmsh, "tetgen", &Filling::byTetgen,
        "filled by tetgen within the given triangles"}}};
  std::vector<std::string> problems;
  bool all_missing = true;
  for (const Way& way : ways) {
    if (!way.wanted) continue;
    try {
      Tetrahedra made =
          nearest(surface, fineness, [&](double size) { return (filling.*way.fill)(size); });
      made.notes.insert(made.notes.end(), problems.begin(), problems.end());
      if (way.how != nullptr) made.notes.emplace_back(way.how);
      const auto nodes = static_cast<double>(made.mesh.nodes.size());
      if (!fineness.size && std::abs(std::log(nodes / fineness.nodes)) > std::log(1 + near_enough))
        made.notes.push_back(
            fmt::format("{} nodes were requested; --size sets the edge length", fineness.nodes));
      return made;
    } catch (const Error& error) {
      if (error.exitCode() == ExitCode::interrupted) throw;
      problems.emplace_back(error.what());
      all_missing = all_missing && !isInstalled(way.program);
    }
  }
  throw failure(
      "{}: cannot fill the surface with tetrahedra: {}. {}", source, fmt::join(problems, "; "),
      all_missing
          ? (problems.size() > 1 ? "Install one of them" : "Install it")
          : "Make its triangles more even (MeshLab: Isotropic Remeshing; Blender: Remesh), or "
            "change --size or --mesher");
}

}  // namespace palpate
