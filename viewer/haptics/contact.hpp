#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "viewer/haptics/blended_force.hpp"
#include "viewer/haptics/contact_options.hpp"
#include "viewer/haptics/haptic_model.hpp"

namespace palpate {

/// What the tissue does to the tool: the force on it, not limited yet, with what is known of it,
/// blended from the spaces of the anchor. stiffness: d force / d tool with the anchor held. inside:
/// all of these spaces were computed as deep; else the force is that of their continuation.
struct Touch : ForceSample {
  Touch() {  // nothing is touched: a force of zero, which is exact
    energy = error_bound = 0;
    coverage = 1;
    inside = true;
  }
  bool touching = false;
  /// The raw force may differ from the last one by more than motion explains: contact began away
  /// from the surface, ended with a force, or model or method were switched. The force guard fades
  /// such steps in.
  bool stepped = false;
  SurfacePoint anchor;                                        ///< the material point in contact
  Eigen::Vector3d anchor_position = Eigen::Vector3d::Zero();  ///< at rest, m
  /// outward, of the surface at rest in the anchor
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  /// of the anchor, m: what the spaces are asked
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();
  SpaceBlend blend;
  double gap = 0;  ///< m, when not touching: distance to the body, negative inside of it

  /// m, what of the displacement lies beyond what was computed. Pictures leave it out: the tool
  /// stops at the edge, and so does the shape.
  Eigen::Vector3d excess() const noexcept { return excessOf(displacement); }
};

/// A point tool on a soft body.
///
/// The tool touches when it crosses a touchable triangle from outside; where it does, the *anchor*,
/// is the material point that moves with it: the displacement is tool - anchor, and the force
///   F = sum w_i(anchor) h_i(tool - anchor)
/// over the spaces of the anchor's blend. The displacement, and with it the force, is zero at
/// first: contact begins without a jump. While it lasts the deformed surface passes through the
/// tool at the anchor, so the anchor *is* the closest point of the deformed surface, and only a
/// free tool needs a search.
///
/// Sliding. The stored energy of a contact is W(X) = sum w_i(X) E_i(tool - X), X the anchor. Moving
/// it along the surface changes W by (F + sum E_i grad w_i) . dX; call the tangential part of that
/// T. Friction holds the anchor while |T| <= friction * F.n, else it slides against T until that
/// holds again, walking over the edges of triangles. So sliding never creates energy, and takes
/// none without friction. A method that has no energy slides by the tangential force alone. The
/// anchor cannot leave the touchable surface: at its rim it stays. In one tick it slides no further
/// than most_slide, than twice the tool's motion and what changes the force by most_relaxation
/// (anchor_slide.cpp); what is left is slid in the next ticks. Since the anchor moves continuously
/// and the weights are continuous, so is the force.
///
/// Beyond the region that was computed the spaces go on with a continuation that only stiffens
/// (fields/answered_region.hpp), of the same energy: nothing else changes here.
///
/// Release: nothing pulls back a tool that leaves. When F.n <= 0 (n outward, at rest), and the tool
/// is outside of the body at rest and in front of the anchor's tangent plane, the contact ends. F.n
/// may be <= 0 elsewhere too, on lobes that bend: there it goes on, and friction holds nothing. A
/// tool that came in where nothing is touchable feels nothing until it has been outside.
///
/// Glued (the paper's mode): the tool takes hold of the nearest touchable point within
/// grab_distance, and keeps it, pulling too, as long as `hold`; the displacement counts from where
/// it was taken. After release() it takes hold again when `hold` was false or the tool farther than
/// grab_distance in between.
///
/// One thread. update() and use() are real time: they do not allocate, lock, throw or log.
class Contact {
 public:
  /// The model must outlive this object, or its replacement by use().
  explicit Contact(const HapticModel& model, const ContactOptions& options = {});

  /// tool: m, scene frame. Not finite: contact ends. hold: glued mode only.
  const Touch& update(const Eigen::Vector3d& tool, bool hold = true) noexcept;
  const Touch& touch() const noexcept { return touch_; }
  /// Ends the contact; the tool must come from outside again.
  void release() noexcept;
  /// Goes on with another model or method. Contact is kept where the surfaces have the same
  /// triangles, vertex for vertex, and the anchor is touchable in the new one.
  void use(const HapticModel& model, std::size_t method) noexcept;

 private:
  /// | from     | what happens                                            | to                 |
  /// | -------- | ------------------------------------------------------- | ------------------ |
  /// | shut     | the tool is outside; glued: hold is false, or it is far | ready              |
  /// | ready    | it comes in where it can touch; glued: it takes hold    | touching           |
  /// | ready    | it comes in elsewhere                                   | shut               |
  /// | touching | the tissue would pull back a tool that leaves           | shut               |
  /// | touching | glued: hold is false                                    | ready              |
  /// | any      | release(), or use() of another surface                  | shut               |
  /// | any      | the tool is nowhere                                     | shut, glued: ready |
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
  /// of the tool from the anchor at zero force; glued
  Eigen::Vector3d offset_ = Eigen::Vector3d::Zero();
  /// where the search for an entry goes on from; not finite: from the next tool
  Eigen::Vector3d last_tool_;
  State state_;
  bool step_follows_ = false;        ///< Touch::stepped of the next update
  std::int32_t near_triangle_ = -1;  ///< where the nearest point was last
};

}  // namespace palpate
