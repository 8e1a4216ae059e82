#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "common/mesh/mesh.hpp"
#include "viewer/picture/surface_rounding.hpp"
#include "viewer/picture/tissue_colours.hpp"

namespace palpate {

/// A surface that is being deformed, as arrays that a graphics card takes: positions, smooth
/// normals and colours of vertices, in float32. A coarse surface is rounded between its vertices
/// (SurfaceRounding), which come first among those of the arrays. Knows no graphics. One thread;
/// what sets something does not allocate.
class SurfaceShape {
 public:
  /// vertices: at rest, metres. triangles: outward, into vertices. touchable: one per triangle.
  SurfaceShape(const std::vector<Eigen::Vector3d>& vertices, const std::vector<Triangle>& triangles,
               const std::vector<bool>& touchable);

  /// [vertex given][axis], metres. What is not finite counts as no displacement. Makes positions
  /// and normals.
  void setDisplacements(std::span<const float> displacements);

  // Colours, all of them over the tissue of the vertex.
  void colourTissue();
  /// By the length of the displacements, 0 to `full` metres: displacementColour.
  void colourDisplacements(double full);
  /// By viridis. places: one per vertex given, 0 to 1; NaN: the tissue is seen.
  void colourPlaces(std::span<const float> places);
  /// By pressureColour, of -full to `full` Pa. pressures: one per vertex given; NaN: the tissue is
  /// seen.
  void colourPressures(std::span<const float> pressures, double full);

  // A column per vertex.
  const Eigen::Matrix3Xf& rest() const { return rest_; }            ///< m
  const Eigen::Matrix3Xf& positions() const { return positions_; }  ///< m
  const Eigen::Matrix3Xf& normals() const { return normals_; }      ///< unit, weighted by area
  /// Bytes red, green, blue, and how wet it looks: 255 tissue, less where a colour covers it, 0
  /// where there is nothing to feel.
  std::span<const std::uint32_t> colours() const { return colours_; }
  /// Three vertices per triangle.
  std::span<const std::uint32_t> corners() const { return corners_; }
  /// Where a vertex can be felt: 1; 0 where there is nothing to feel; in between along the border,
  /// which is not to look like its triangles.
  std::span<const float> felt() const { return felt_; }
  double length(std::size_t vertex) const { return lengths_[vertex]; }  ///< of the displacement, m
  double largest() const { return largest_; }                           ///< of these lengths
  std::size_t size() const { return lengths_.size(); }                  ///< vertices of the arrays

 private:
  void setFelt(const std::vector<Triangle>& triangles, const std::vector<bool>& touchable);
  void setTissue();
  void setNormals();
  void round(std::vector<float>& values) const;

  Eigen::Matrix3Xf rest_, positions_, normals_;
  std::size_t given_;                       ///< vertices
  std::vector<std::uint32_t> coarse_;       ///< corners of the triangles given
  std::vector<SurfaceRounding> roundings_;  ///< one after the other
  std::vector<float> lengths_, felt_, places_;
  /// By vertex, 0 to 255: red, green, blue, wetness.
  std::vector<std::array<float, 4>> tissue_;
  std::vector<std::uint32_t> colours_, corners_;
  double largest_ = 0;
};

}  // namespace palpate
