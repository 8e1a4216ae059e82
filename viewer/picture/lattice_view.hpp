#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "viewer/picture/lattice_dots.hpp"

class SoAction;
class SoCallback;
class SoSwitch;

namespace palpate {

/// Draws dots in front of everything drawn before it (the body), and in depth among themselves. A
/// Coin node.
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
  static void render(void* view, SoAction* action);

  SoSwitch* node_;
  SoCallback* dots_;
  std::vector<float> places_;          ///< [dot][axis], m
  std::vector<std::uint8_t> colours_;  ///< [dot][red, green, blue]
  float size_ = 4;                     ///< px
};

}  // namespace palpate
