#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "viewer/haptics/blended_force.hpp"
#include "viewer/haptics/contact_options.hpp"
#include "viewer/haptics/haptic_model.hpp"

namespace palpate {

/// Contact force of the tissue on the tool, blended from the configuration spaces of the anchor.
/// The force guard has not limited this force yet.
///
/// stiffness is d force / d tool while the anchor stays in place. inside is true if the
/// displacement lies in the computed region of all these spaces; otherwise the force is a
/// continuation, or the tool's position was not finite.
struct Touch : ForceSample {
  Touch() {  // if nothing is touched, the force is exactly zero
    energy = error_bound = 0;
    coverage = 1;
    inside = true;
  }
  bool touching = false;
  /// The raw force may have changed by more than the tool's motion explains, because contact ended
  /// while there was a force, or the model or method was switched during contact. The force guard
  /// fades in such a step.
  bool stepped = false;
  SurfacePoint anchor;                                        ///< the material point in contact
  Eigen::Vector3d anchor_position = Eigen::Vector3d::Zero();  ///< rest position of the anchor, m
  /// outward unit normal of the surface at rest, at the anchor
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  /// displacement of the anchor, m, at which the force fields of the spaces are evaluated
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();
  SpaceBlend blend;
  /// N, tangential part of an area's -dE/ds at the anchor, which slides the anchor against
  /// friction; zero outside of areas
  Eigen::Vector3d drive = Eigen::Vector3d::Zero();
  double followed = 0;  ///< share of the live solver's equilibria in the force, 0 to 1
  double gap = 0;       ///< distance to the body while not touching, m; negative inside the body

  /// Returns the part of the displacement that lies beyond the computed region, m. The drawn tool
  /// and shape leave it out, so they stop at the edge of the region.
  Eigen::Vector3d excess() const noexcept { return excessOf(displacement); }
};

/// Contact of a point tool with a soft body.
///
/// The tool touches when it crosses a touchable triangle from outside. The crossing point, the
/// *anchor*, is the material point that moves with the tool. The displacement is tool - anchor. The
/// force is the sum over the spaces i of the anchor's blend, with their weights w_i and forces h_i:
///   F = sum w_i(anchor) h_i(tool - anchor).
/// Displacement and force start at zero, so contact begins without a jump. During contact the
/// deformed surface passes through the tool at the anchor, so the anchor *is* the closest point of
/// the deformed surface. Only a tool that is not in contact needs a search.
///
/// Sliding. The stored energy of a contact is W(X) = sum w_i(X) E_i(tool - X), where X is the
/// anchor. Moving the anchor along the surface changes W by (F + sum E_i grad w_i) . dX; T is the
/// tangential part of this gradient. Friction holds the anchor while |T| <= friction * F.n.
/// Otherwise the anchor slides against T until this inequality holds again, across the edges of
/// triangles. Sliding therefore never creates energy, and dissipates none without friction. If a
/// method has no energy, the anchor slides by the tangential force alone. The anchor cannot leave
/// the touchable surface and stops at its rim. Per tick it slides at most most_slide, and at most
/// twice the tool's motion plus the distance that changes the force by most_relaxation
/// (anchor_slide.cpp); later ticks continue. The anchor moves continuously and the weights are
/// continuous, so the force is continuous too.
///
/// Beyond the computed region each space returns a continuation of its force, which only becomes
/// stiffer (fields/answered_region.hpp). The continuation derives from the same energy, so contact
/// needs no special case.
///
/// Release: the tissue never pulls back a tool that leaves. Contact ends when F.n <= 0 (n: outward
/// normal at rest) and the tool is outside the body at rest and in front of the anchor's tangent
/// plane. F.n <= 0 can also occur while the tool presses on a lobe that bends away; contact then
/// continues, without friction. A tool that enters the body where the surface is not touchable
/// feels nothing until it has left the body.
///
/// Glued (the paper's mode): the tool grips the nearest touchable point within grab_distance. The
/// tool keeps this point while `hold` is true, also when it pulls. The displacement is measured
/// from the tool position at the grip. After release() the tool can grip again once `hold` was
/// false or the tool was farther away than grab_distance.
///
/// One thread. update(), setFriction(), use() and replace() are real time: they do not allocate,
/// lock, throw or log.
class Contact {
 public:
  /// The model must stay valid until use() or replace() ends its use or this object is destroyed.
  explicit Contact(const HapticModel& model, const ContactOptions& options = {});

  /// Updates the contact for one tick. tool: m, scene frame; a position that is not finite ends the
  /// contact. hold: for glued mode only. If true, the tool may grip and keeps its grip; if false,
  /// it lets go.
  const Touch& update(const Eigen::Vector3d& tool, bool hold = true) noexcept;
  const Touch& touch() const noexcept { return touch_; }
  std::size_t method() const noexcept { return method_; }
  /// Returns whether the live solver corrects the model in use.
  bool follows() const noexcept { return options_.live && model_ == options_.live_model; }
  /// Ends the contact. Before the tool can touch again, it must be outside; glued: it must let go
  /// or be farther away than grab_distance.
  void release() noexcept;
  /// Sets the friction coefficient for later updates, >= 0.
  void setFriction(double friction) noexcept { options_.friction = friction; }
  /// Ends the touch; later ones are corrected by a live solver (ContactOptions::live, live_model
  /// and period), or by none if `live` is null.
  void correctBy(LiveTouch* live, const HapticModel* live_model, double period);
  /// Switches to another model or method. Contact is kept if both surfaces have the same triangles
  /// and vertices and the anchor is touchable in the new model.
  void use(const HapticModel& model, std::size_t method) noexcept;
  /// Replaces the model `old` by `model`; `old` may then be destroyed. If `old` is in use, `model`
  /// is used instead, with the current method if `model` has prepared it, otherwise with its first
  /// method. If the live solver corrects `old`, it then corrects `model`.
  void replace(const HapticModel& old, const HapticModel& model) noexcept;

 private:
  /// | from     | event                                                   | to                 |
  /// | -------- | ------------------------------------------------------- | ------------------ |
  /// | shut     | tool outside; glued: `hold` is false, or tool far away  | ready              |
  /// | ready    | tool enters a touchable triangle; glued: tool grips     | touching           |
  /// | ready    | tool enters elsewhere                                   | shut               |
  /// | touching | the tissue would pull back a tool that leaves           | shut               |
  /// | touching | glued: `hold` is false                                  | ready              |
  /// | touching | use() of a model in which contact cannot continue       | shut               |
  /// | any      | release(); unilateral: use() with another surface       | shut               |
  /// | any      | tool position not finite                                | shut, glued: ready |
  enum class State : std::uint8_t { shut, ready, touching };

  void follow(const Eigen::Vector3d& tool, bool hold) noexcept;
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
  /// tool position at which the displacement is zero, minus the anchor, m; zero unless glued
  Eigen::Vector3d offset_ = Eigen::Vector3d::Zero();
  /// start of the segment in which the next entry is searched, m; if not finite, the next tool
  /// position is used
  Eigen::Vector3d last_tool_;
  State state_;
  bool step_follows_ = false;  ///< value that Touch::stepped gets in the next update
  std::uint64_t updates_ = 0;
  std::int32_t near_triangle_ = -1;  ///< triangle of the last nearest point, where the next search
                                     ///< begins
};

}  // namespace palpate
