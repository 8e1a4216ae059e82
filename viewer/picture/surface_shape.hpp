#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "common/mesh/mesh.hpp"
#include "viewer/picture/surface_rounding.hpp"
#include "viewer/picture/tissue_colours.hpp"

namespace palpate {

/// A deforming surface as arrays for a graphics card: positions, smooth normals and colours of
/// vertices, in float32. A coarse surface is rounded, which adds vertices between the given ones
/// (SurfaceRounding). The given vertices come first in the arrays. Makes no OpenGL calls. One
/// thread; the setters do not allocate.
class SurfaceShape {
 public:
  /// vertices: at rest, metres. triangles: oriented outward, indices into vertices. touchable:
  /// whether each triangle is touchable.
  SurfaceShape(const std::vector<Eigen::Vector3d>& vertices, const std::vector<Triangle>& triangles,
               const std::vector<bool>& touchable);

  /// Sets the displacements, [given vertex][axis], metres, and computes positions and normals. A
  /// component that is not finite counts as zero.
  void setDisplacements(std::span<const float> displacements);

  // The following set the colours, which cover the tissue of each vertex in part or fully.
  void colourTissue();
  /// Colours by the magnitude of the displacements, from 0 to `full` metres (displacementColour).
  void colourDisplacements(double full);
  /// Colours by viridis. places: one per given vertex, 0 to 1; NaN shows the tissue.
  void colourPlaces(std::span<const float> places);
  /// Colours by pressureColour(), from -full to `full` Pa. pressures: one per given vertex; NaN
  /// shows the tissue.
  void colourPressures(std::span<const float> pressures, double full);

  // The following matrices have one column per vertex.
  const Eigen::Matrix3Xf& rest() const { return rest_; }            ///< m
  const Eigen::Matrix3Xf& positions() const { return positions_; }  ///< m
  const Eigen::Matrix3Xf& normals() const { return normals_; }      ///< unit, weighted by area
  /// Returns red, green, blue and wetness of each vertex, packed as four bytes. Wetness is 255 for
  /// tissue, less under a colour, and 0 for parts that are not touchable.
  std::span<const std::uint32_t> colours() const { return colours_; }
  /// Returns the corners of all triangles, three vertices per triangle.
  std::span<const std::uint32_t> corners() const { return corners_; }
  /// Returns a value per vertex: 1 if it is touchable, 0 if not. Values between 0 and 1 along the
  /// border hide the edges of its triangles.
  std::span<const float> felt() const { return felt_; }
  double length(std::size_t vertex) const { return lengths_[vertex]; }  ///< of its displacement, m
  double largest() const { return largest_; }                           ///< of these lengths, m
  std::size_t size() const { return lengths_.size(); }  ///< number of vertices in the arrays

 private:
  void setFelt(const std::vector<Triangle>& triangles, const std::vector<bool>& touchable);
  void setTissue();
  void setNormals();
  void round(std::vector<float>& values) const;

  Eigen::Matrix3Xf rest_, positions_, normals_;
  std::size_t given_;                       ///< number of given vertices
  std::vector<std::uint32_t> coarse_;       ///< corners of the given triangles
  std::vector<SurfaceRounding> roundings_;  ///< applied in this order
  std::vector<float> lengths_, felt_, places_;
  /// Per vertex, 0 to 255: red, green, blue, wetness.
  std::vector<std::array<float, 4>> tissue_;
  std::vector<std::uint32_t> colours_, corners_;
  double largest_ = 0;
};

}  // namespace palpate
