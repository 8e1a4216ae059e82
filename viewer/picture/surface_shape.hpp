#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "common/mesh/mesh.hpp"

namespace palpate {

/// A surface that is being deformed, as arrays that a graphics card takes: positions, smooth
/// normals and colours of the vertices, in float32. Knows no graphics. One thread; setDisplacements
/// and setColours do not allocate.
class SurfaceShape {
 public:
  /// vertices: at rest, metres. triangles: outward, into vertices. touchable: one per triangle; the
  /// vertices of touchable triangles get full colours, the others grey ones.
  SurfaceShape(const std::vector<Eigen::Vector3d>& vertices, const std::vector<Triangle>& triangles,
               const std::vector<bool>& touchable);

  /// [vertex][axis], metres. What is not finite counts as no displacement. Makes positions and
  /// normals.
  void setDisplacements(std::span<const float> displacements);
  /// Colours by the length of the displacements: viridis from 0 to `full` metres.
  void setColours(double full);

  // A column per vertex.
  const Eigen::Matrix3Xf& rest() const { return rest_; }            ///< m
  const Eigen::Matrix3Xf& positions() const { return positions_; }  ///< m
  const Eigen::Matrix3Xf& normals() const { return normals_; }      ///< unit, weighted by area
  /// Bytes red, green, blue, alpha.
  std::span<const std::uint32_t> colours() const { return colours_; }
  /// Three vertices per triangle.
  std::span<const std::uint32_t> corners() const { return corners_; }
  /// Two vertices per edge, each once.
  std::span<const std::uint32_t> edges() const { return edges_; }
  /// Edges between what can be touched and what cannot: two vertices each.
  std::span<const std::uint32_t> rim() const { return rim_; }
  double length(std::size_t vertex) const { return lengths_[vertex]; }  ///< of the displacement, m
  double largest() const { return largest_; }                           ///< of these lengths
  std::size_t size() const { return lengths_.size(); }                  ///< vertices

 private:
  void setEdges(const std::vector<Triangle>& triangles, const std::vector<bool>& touchable);
  void setNormals();

  Eigen::Matrix3Xf rest_, positions_, normals_;
  std::vector<float> lengths_;
  std::vector<std::uint32_t> colours_, corners_, edges_, rim_;
  std::vector<std::uint32_t> vivid_, grey_;  ///< colours by level, touchable or not
  std::vector<bool> touchable_;              ///< by vertex
  double largest_ = 0;
};

}  // namespace palpate
