#include "viewer/report/organ_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "common/base/index.hpp"
#include "common/mesh/surface_point.hpp"
#include "viewer/plot/csv.hpp"
#include "viewer/plot/round_numbers.hpp"
#include "viewer/plot/widest_view.hpp"
#include "viewer/report/report_words.hpp"

namespace palpate {
namespace {

constexpr double map_width = 420, map_margin = 12, bar_height = 30;  // user units
/// Triangles beyond which a note over each would make files that browsers do not save.
constexpr std::size_t most_notes = 4000;

/// How a body is looked at: rows are right, up and towards the eye.
struct MapView {
  const char* title;
  Eigen::Matrix3d axes;
};

std::array<MapView, 3> mapViews(const Mesh& mesh) {
  const Eigen::Vector3d eye = widestView(mesh.nodes);
  const Eigen::Vector3d up_hint =
      std::abs(eye.z()) < 0.9 ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitY();
  const auto axesFrom = [](const Eigen::Vector3d& towards, const Eigen::Vector3d& hint) {
    Eigen::Matrix3d axes;
    const Eigen::Vector3d right = hint.cross(towards).normalized();
    axes << right.transpose(), towards.cross(right).transpose(), towards.transpose();
    return axes;
  };
  const Eigen::Matrix3d front = axesFrom(eye, up_hint);
  const Eigen::Vector3d above = front.row(1).transpose();
  return {MapView{"from the front", front}, MapView{"from behind", axesFrom(-eye, up_hint)},
          MapView{"from above", axesFrom(above, -eye)}};
}

/// A body on paper.
class MapDrawing {
 public:
  MapDrawing(const Mesh& mesh, const OrganMap& map, const ColourScale& scale, ColourUnit unit,
             const MapView& view)
      : mesh_(mesh), map_(map), scale_(scale), unit_(unit), view_(view) {
    for (const Eigen::Vector3d& node : mesh.nodes) {
      seen_.emplace_back(view.axes * node);
      box_.extend(seen_.back());
    }
    per_metre_ = (map_width - 2 * map_margin) / box_.sizes().x();
  }

  std::string svg() const {
    const double height = per_metre_ * box_.sizes().y() + 2 * map_margin + bar_height;
    return fmt::format(
               "<svg viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" aria-label=\"the body {}\">\n",
               map_width, height, view_.title) +
           triangles() + fixedNodes() + marks() + lengthBar(height) + "</svg>\n";
  }

 private:
  double x(const Eigen::Vector3d& p) const {
    return map_margin + per_metre_ * (p.x() - box_.min().x());
  }
  double y(const Eigen::Vector3d& p) const {
    return map_margin + per_metre_ * (box_.max().y() - p.y());
  }
  std::string text(double value) const {
    return unit_ == ColourUnit::share ? formatShare(value) : formatNumber(value) + " N";
  }

  /// Of a triangle without a value: grey, the lighter the more it faces the eye.
  static std::string shade(double facing) {
    const auto level = std::lround(176 + 58 * facing);
    return fmt::format("#{0:02x}{1:02x}{1:02x}", level, level + 3);
  }

  /// Those that face the eye, the farthest first.
  std::string triangles() const {
    std::vector<std::size_t> order(mesh_.surface.size());
    std::iota(order.begin(), order.end(), 0);
    std::ranges::stable_sort(order, {}, [&](std::size_t t) {
      const Triangle& c = mesh_.surface[t];
      return seen_[at(c[0])].z() + seen_[at(c[1])].z() + seen_[at(c[2])].z();
    });
    // Stroked alike, so that no seam shows between neighbours.
    std::string svg = "<g stroke-width=\".6\" stroke-linejoin=\"round\">\n";
    for (const std::size_t t : order) svg += triangle(t);
    return svg + "</g>\n";
  }

  std::string triangle(std::size_t t) const {
    const Triangle& c = mesh_.surface[t];
    const Eigen::Vector3d &p = seen_[at(c[0])], &q = seen_[at(c[1])], &r = seen_[at(c[2])];
    const Eigen::Vector3d normal = (q - p).cross(r - p).normalized();
    if (!(normal.z() > 0)) return "";
    const double value = map_.on_triangles.empty() ? not_measured : map_.on_triangles[t];
    const bool has_value = std::isfinite(value);
    const std::string colour = has_value ? scale_.colourOf(value) : shade(normal.z());
    const std::string path = fmt::format(
        "<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}L{:.1f} {:.1f}z\" fill=\"{}\" "
        "stroke=\"{}\"",
        x(p), y(p), x(q), y(q), x(r), y(r), colour, colour);
    return has_value && mesh_.surface.size() <= most_notes
               ? path + "><title>" + text(value) + "</title></path>\n"
               : path + "/>\n";
  }

  /// Whether a triangle that the place lies in, on an edge or at a corner of, faces the eye.
  bool isSeen(const Eigen::Vector3d& place) const {
    const SurfacePoint on_surface = nearestOnSurface(mesh_, place);
    const Triangle& nearest = mesh_.surface[at(on_surface.triangle)];
    return std::ranges::any_of(mesh_.surface, [&](const Triangle& c) {
      for (int corner = 0; corner < 3; ++corner)
        if (on_surface.barycentric[corner] > 0 &&
            std::ranges::find(c, nearest[at(corner)]) == c.end())
          return false;
      const Eigen::Vector3d &p = seen_[at(c[0])], &q = seen_[at(c[1])], &r = seen_[at(c[2])];
      return (q - p).cross(r - p).z() > 0;
    });
  }

  std::string fixedNodes() const {
    std::string path;
    for (const std::int32_t node : map_.fixed)
      if (isSeen(mesh_.nodes[at(node)]))
        path += fmt::format("M{:.1f} {:.1f}l4 4m0 -4l-4 4", x(seen_[at(node)]) - 2,
                            y(seen_[at(node)]) - 2);
    return path.empty() ? "" : fmt::format("<path class=\"fixed\" d=\"{}\"/>\n", path);
  }

  std::string marks() const {
    std::string svg;
    for (const OrganMark& mark : map_.marks) {
      if (!isSeen(mark.place)) continue;
      const Eigen::Vector3d place = view_.axes * mark.place;
      svg += fmt::format(
          "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\" fill=\"{}\" stroke=\"#fff\" "
          "stroke-width=\"1.2\"><title>{}</title></circle>\n",
          x(place), y(place), map_.marks.size() > 1 ? 4 : 7,
          std::isfinite(mark.value) ? scale_.colourOf(mark.value) : std::string("#ffffff"),
          escaped(mark.note));
    }
    return svg;
  }

  std::string lengthBar(double height) const {
    const double length = roundUp(box_.sizes().x() / 10);
    return fmt::format(
        "<path class=\"bar\" d=\"M{0} {1:.1f}v6h{2:.1f}v-6\"/>"
        "<text class=\"tick\" x=\"{3:.1f}\" y=\"{4:.1f}\">{5:g} mm</text>\n",
        map_margin, height - 18, per_metre_ * length, map_margin + per_metre_ * length + 8,
        height - 9, 1e3 * length);
  }

  const Mesh& mesh_;
  const OrganMap& map_;
  const ColourScale& scale_;
  ColourUnit unit_;
  const MapView& view_;
  std::vector<Eigen::Vector3d> seen_;  ///< nodes: right, up, towards the eye, m
  Eigen::AlignedBox3d box_;
  double per_metre_ = 1;
};

std::string csvOf(const Mesh& mesh, const OrganMap& map) {
  const auto line = [](const char* what, const Eigen::Vector3d& place, double value) {
    std::vector<std::string> cells = {what};
    for (const double coordinate : place) cells.push_back(csvNumber(1e3 * coordinate, 5));
    cells.push_back(csvNumber(value, 4));
    return csvLine(cells);
  };
  std::string text = csvLine({"place", "x (mm)", "y (mm)", "z (mm)", map.values});
  for (std::size_t t = 0; t < map.on_triangles.size(); ++t) {
    const Triangle& c = mesh.surface[t];
    text +=
        line("triangle", (mesh.nodes[at(c[0])] + mesh.nodes[at(c[1])] + mesh.nodes[at(c[2])]) / 3,
             map.on_triangles[t]);
  }
  for (const OrganMark& mark : map.marks) text += line("mark", mark.place, mark.value);
  return text;
}

}  // namespace

std::vector<Panel> panelsOf(const Mesh& mesh, const OrganMap& map, const ColourScale& scale,
                            ColourUnit unit) {
  std::vector<Panel> panels;
  for (const MapView& view : mapViews(mesh))
    panels.push_back({.svg = MapDrawing(mesh, map, scale, unit, view).svg(),
                      .caption = view.title,
                      .key = colourBar(scale, unit)});
  // All views are of the same numbers.
  panels.front().data = {{"CSV", ".csv", csvOf(mesh, map)}};
  return panels;
}

std::string legendOfMap(const ColourScale& scale, ColourUnit unit, const std::string& marks) {
  std::string html = "<p class=\"legend\"><span>" + colourBarHtml(scale, unit) + "</span> ";
  const auto entry = [&](const char* drawing, const std::string& text) {
    html += fmt::format(
        "<span><svg class=\"swatch\" viewBox=\"0 0 14 14\" aria-hidden=\"true\">{}</svg> "
        "{}</span> ",
        drawing, escaped(text));
  };
  entry("<rect width=\"14\" height=\"14\" fill=\"#d6d9d9\"/>", "no value");
  entry("<path class=\"fixed\" d=\"M5 5l4 4m0 -4l-4 4\"/>", "fixed node");
  if (!marks.empty())
    entry("<circle cx=\"7\" cy=\"7\" r=\"5\" fill=\"#21918c\" stroke=\"#fff\"/>", marks);
  return html + "</p>\n";
}

}  // namespace palpate
