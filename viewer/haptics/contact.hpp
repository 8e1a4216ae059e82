#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "viewer/haptics/blended_force.hpp"
#include "viewer/haptics/contact_options.hpp"
#include "viewer/haptics/haptic_model.hpp"

namespace palpate {

/// Contact force of the tissue on the tool, blended from the configuration spaces of the anchor and
/// not yet limited by the guard.
///
/// stiffness is d force / d tool with the anchor held. inside is true if the displacement lies in
/// the computed region of all these spaces; otherwise the force is their continuation.
struct Touch : ForceSample {
  Touch() {  // nothing is touched: a force of zero, which is exact
    energy = error_bound = 0;
    coverage = 1;
    inside = true;
  }
  bool touching = false;
  /// The raw force may change by more than the tool's motion explains. Contact began away from the
  /// surface or ended with a force, or the model or method was switched. The force guard fades such
  /// steps in.
  bool stepped = false;
  SurfacePoint anchor;                                        ///< the material point in contact
  Eigen::Vector3d anchor_position = Eigen::Vector3d::Zero();  ///< at rest, m
  /// outward unit normal of the surface at rest, at the anchor
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  /// displacement of the anchor, m; argument of the spaces' force fields
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();
  SpaceBlend blend;
  double gap = 0;  ///< distance to the body when not touching, m; negative inside it

  /// Returns the part of the displacement beyond the computed region, m. Pictures leave it out, so
  /// the tool and the deformed shape stop at the edge.
  Eigen::Vector3d excess() const noexcept { return excessOf(displacement); }
};

/// Contact of a point tool with a soft body.
///
/// The tool touches when it crosses a touchable triangle from outside. The crossing point, the
/// *anchor*, is the material point that moves with the tool. The displacement is tool - anchor, and
/// the force over the spaces of the anchor's blend is
///   F = sum w_i(anchor) h_i(tool - anchor).
/// Both start at zero, so contact begins without a jump. During contact the deformed surface passes
/// through the tool at the anchor, so the anchor *is* the closest point of the deformed surface.
/// Only a free tool needs a search.
///
/// Sliding. The stored energy of a contact is W(X) = sum w_i(X) E_i(tool - X), where X is the
/// anchor. Moving the anchor along the surface changes W by (F + sum E_i grad w_i) . dX; T is the
/// tangential part of this gradient. Friction holds the anchor while |T| <= friction * F.n.
/// Otherwise the anchor slides against T until this holds again, across the edges of triangles.
/// Sliding therefore never creates energy, and dissipates none without friction. A method without
/// an energy slides by the tangential force alone. The anchor cannot leave the touchable surface
/// and stops at its rim. Per tick it slides at most min(most_slide, 2 x tool motion + the distance
/// that changes the force by most_relaxation) (anchor_slide.cpp); later ticks slide the rest. The
/// anchor moves continuously and the weights are continuous, so the force is continuous too.
///
/// Beyond the computed region each space returns a continuation that only stiffens
/// (fields/answered_region.hpp). It derives from the same energy, so contact needs no special case.
///
/// Release: nothing pulls back a tool that leaves. Contact ends when F.n <= 0 (n: outward normal at
/// rest) and the tool is outside the body at rest and in front of the anchor's tangent plane. F.n
/// <= 0 also occurs elsewhere, on bending lobes; contact goes on there, without friction. A tool
/// that entered where the surface is not touchable feels nothing until it has been outside.
///
/// Glued (the paper's mode): the tool grips the nearest touchable point within grab_distance and
/// keeps it while `hold` is true, also when it pulls. The displacement is measured from the tool
/// position at the grip. After release() it grips again once `hold` was false or the tool was
/// farther than grab_distance.
///
/// One thread. update() and use() are real time: they do not allocate, lock, throw or log.
class Contact {
 public:
  /// The model must outlive this object or be replaced by use().
  explicit Contact(const HapticModel& model, const ContactOptions& options = {});

  /// Updates the contact for one tick. tool: m, scene frame; a position that is not finite ends the
  /// contact. hold: glued mode only.
  const Touch& update(const Eigen::Vector3d& tool, bool hold = true) noexcept;
  const Touch& touch() const noexcept { return touch_; }
  /// Ends the contact; the tool must come from outside again.
  void release() noexcept;
  /// Switches to another model or method. Contact is kept if both surfaces have the same triangles
  /// and vertices and the anchor is touchable in the new model.
  void use(const HapticModel& model, std::size_t method) noexcept;

 private:
  /// | from     | event                                                   | to                 |
  /// | -------- | ------------------------------------------------------- | ------------------ |
  /// | shut     | tool outside; glued: `hold` is false, or tool far away  | ready              |
  /// | ready    | tool enters a touchable triangle; glued: tool grips     | touching           |
  /// | ready    | tool enters elsewhere                                   | shut               |
  /// | touching | the tissue would pull back a tool that leaves           | shut               |
  /// | touching | glued: `hold` is false                                  | ready              |
  /// | any      | release(), or use() of a model with another surface     | shut               |
  /// | any      | tool position not finite                                | shut, glued: ready |
  enum class State : std::uint8_t { shut, ready, touching };

  void seek(const Eigen::Vector3d& tool, bool hold) noexcept;
  void seekEntry(const Eigen::Vector3d& tool, const NearestPoint& nearest) noexcept;
  void seekGrip(const Eigen::Vector3d& tool, bool hold) noexcept;
  bool press(const Eigen::Vector3d& tool) noexcept;
  void end(bool stepped, State next) noexcept;
  void describe(const Eigen::Vector3d& displacement) noexcept;

  const HapticModel* model_;
  std::size_t method_ = 0;
  ContactOptions options_;
  Touch touch_;
  BlendedForce force_;
  SurfacePoint anchor_;
  /// tool - anchor at zero force, m; glued mode only
  Eigen::Vector3d offset_ = Eigen::Vector3d::Zero();
  /// start of the segment for the next entry search, m; not finite: use the next tool position
  Eigen::Vector3d last_tool_;
  State state_;
  bool step_follows_ = false;        ///< value of Touch::stepped for the next update
  std::int32_t near_triangle_ = -1;  ///< triangle of the last nearest point, a search hint
};

}  // namespace palpate
