#pragma once

#include "common/mesh/mesh.hpp"
#include "viewer/plot/figure.hpp"
#include "viewer/report/colour_scale.hpp"

namespace palpate {

/// Something at a place of the surface, drawn as a disc on the sides from which it is seen.
struct OrganMark {
  Eigen::Vector3d place;
  double value;      ///< its colour; NaN: that of what has no value
  std::string note;  ///< shown over it
};

/// A body whose surface has a colour in places.
struct OrganMap {
  /// Per triangle of the mesh's surface; NaN where there is none; empty: nowhere.
  std::vector<double> on_triangles{};
  std::vector<OrganMark> marks{};
  std::vector<std::int32_t> fixed{};  ///< nodes on the surface, drawn as small crosses
  std::string values;                 ///< what the values are, with their unit, for the CSV
};

/// The map from both sides of the axis along which the body is thinnest and from a third at right
/// angles to them, z upwards where that is possible; without perspective, with a bar of a round
/// length. Numbers: centre and value of every coloured triangle, place and value of every mark.
std::vector<Panel> panelsOf(const Mesh& mesh, const OrganMap& map, const ColourScale& scale,
                            ColourUnit unit);

/// The colours and what else is drawn, as HTML. `marks`: what a disc is; empty: there are none.
std::string legendOfMap(const ColourScale& scale, ColourUnit unit, const std::string& marks);

}  // namespace palpate
