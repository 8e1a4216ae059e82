#pragma once

#include <Eigen/Core>
#include <span>

#include "viewer/picture/lattice_dots.hpp"

class SoDrawStyle;
class SoSwitch;
class SoVertexProperty;

namespace palpate {

/// Draws dots in front of everything drawn before it (the body), and in depth among themselves. A Coin node.
class LatticeView {
 public:
  LatticeView();
  ~LatticeView();
  LatticeView(const LatticeView&) = delete;
  LatticeView& operator=(const LatticeView&) = delete;

  SoSwitch* node() const { return node_; }
  /// origin: added to the displacements, m, scene frame. size: pixels.
  void setDots(std::span<const LatticeDot> dots, const Eigen::Vector3d& origin, double size);
  void show(bool shown);

 private:
  SoSwitch* node_;
  SoVertexProperty* dots_;
  SoDrawStyle* style_;
};

}  // namespace palpate
