#pragma once

#include <algorithm>
#include <atomic>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>
#include <vector>

#include "common/dataset/dataset.hpp"
#include "viewer/fields/area_field.hpp"
#include "viewer/fields/displacement_field.hpp"
#include "viewer/fields/force_field.hpp"
#include "viewer/haptics/surface_pressures.hpp"
#include "viewer/haptics/touch_surface.hpp"

namespace palpate {

struct HapticModelOptions {
  /// Methods of interpolation between which a touch can switch; the first is used initially.
  std::vector<std::string> methods = {"potential", "trilinear"};
  double reach = 0;  ///< passed to TouchSurface, m
  /// Whether to keep the pressures of the surface too, if the dataset has them: 4 bytes per vertex
  /// and solved point.
  bool pressures = false;
  /// Whether the constructor prepares everything. If false, the caller prepares each method with
  /// HapticModel::prepare(), and the pressures with preparePressures().
  bool prepare = true;
  /// Whether to replace each unfinished site of a finger by a guess (guessed_sites.hpp). Forces
  /// near such a site are marked as not inside, with an error bound of at least the force itself.
  /// If false, the solved points of unfinished sites are used, and sites without a solved point are
  /// left out.
  bool guess = false;
  /// A stop request ends the reading of the shapes; the constructor then throws an Error with the
  /// exit code of an interrupt.
  std::stop_token stop = {};
};

/// One dataset in memory, ready to be touched. Its file may be replaced or deleted.
///
/// Threads: any thread may read, also while methods are prepared. A method becomes visible when it
/// is complete, and does not change afterwards.
class HapticModel {
 public:
  /// Throws Error if the dataset has no touchable surface or a method is unknown.
  explicit HapticModel(const Dataset& dataset, const HapticModelOptions& options = {});

  /// Prepares one method for all spaces, in parallel on all cores.
  ///
  /// Costs about 0.2 s of processor time for a space of 515 points and `potential`. The first call
  /// also prepares the areas, which all methods share: about 12 s for 315 sites with 37 solved
  /// points each. Does nothing if the method is prepared. Do not prepare one method in two threads
  /// at the same time. If `stop` is requested, the preparation stops; the next call continues with
  /// the remaining spaces, but prepares all areas again. Throws Error for an unknown method.
  /// alone: prepare the spaces in this thread alone; areas still use all cores.
  void prepare(std::size_t method, const std::stop_token& stop = {}, bool alone = false);
  /// Returns the progress of a method, 0 to 1: the fraction of its spaces or the fraction of the
  /// work on the areas, whichever is larger. The areas are shared by all methods. The progress is 1
  /// only if the method isPrepared(), and 0 for a number beyond methods(). Any thread; does not
  /// wait.
  double preparedShare(std::size_t method) const noexcept;
  /// Returns whether field() may be called for this method. Any thread, real time.
  bool isPrepared(std::size_t method) const noexcept {
    return method < fields_.size() &&
           fields_[method].made.load(std::memory_order_acquire) == spaces_.size();
  }

  /// Prepares pressures(), if the options ask for them, in this thread alone until `stop` is
  /// requested. Takes a few milliseconds per space. Do not call it in two threads at the same time.
  void preparePressures(const std::stop_token& stop = {});

  const std::string& name() const { return scene_.name; }  ///< name of the scene
  /// Returns the materials, at least one.
  const std::vector<Region>& regions() const { return scene_.regions; }
  const std::string& file() const { return file_; }
  ContentId contentId() const { return content_; }
  ContentId buildId() const { return build_; }                ///< Dataset::buildId
  ContactMode contactMode() const { return scene_.contact; }  ///< mode that the scene requests
  /// Returns the force limit of the scene, N.
  double maxForce() const { return scene_.workspace.max_force; }
  /// Returns the radius of the tool of a space, m: the radius of the finger or of the patch around
  /// the active node; 0 for a single node.
  double toolRadius(std::size_t space) const { return tool_radii_[space]; }
  const TouchSurface& surface() const { return surface_; }
  const std::vector<SpaceTable>& spaces() const { return spaces_; }
  const std::vector<std::string>& methods() const { return methods_; }
  /// Requires isPrepared(method). Real time.
  const ForceField& field(std::size_t method, std::size_t space) const noexcept {
    return *fields_[method].of_space[space];
  }
  /// Returns the energy of an area of surface(). All methods share the areas. Requires that some
  /// method isPrepared(). Real time.
  const AreaField& area(std::size_t number) const noexcept { return *areas_[number]; }
  /// Returns whether the points of a space are guesses (HapticModelOptions::guess).
  bool isGuess(std::size_t space) const noexcept { return guessed_[space]; }
  /// Returns the number of spaces whose points are guesses.
  std::size_t guesses() const noexcept {
    return static_cast<std::size_t>(std::ranges::count(guessed_, true));
  }
  /// Returns whether the energy of an area at this place, m, depends on a guess. Requires that some
  /// method isPrepared(). Real time.
  bool isGuessAt(const Eigen::Vector3d& place) const noexcept {
    return guessed_places_.isReached(place);
  }
  /// Returns the displacements of the surface's vertices in a space.
  const DisplacementField& shape(std::size_t space) const { return *shapes_[space]; }
  /// Returns the pressures of the surface. They are never prepared unless the options ask for them.
  const SurfacePressures& pressures() const { return pressures_; }

 private:
  /// The force fields of one method, [space]. Several threads make them: each writes different
  /// elements, and counts an element in `made` after writing it.
  struct MethodFields {
    std::vector<std::unique_ptr<const ForceField>> of_space;
    std::atomic<std::size_t> made = 0;
  };
  void guessUnfinished();
  void findGuessedPlaces();
  void make(std::size_t method, std::size_t space);
  bool makeAreas(const std::stop_token& stop);  ///< returns whether the areas are complete
  void readShapes(const Dataset& dataset, bool with_pressures, const std::stop_token& stop);

  Scene scene_;
  std::string file_;
  ContentId content_, build_;
  TouchSurface surface_;
  std::vector<SpaceTable> spaces_;
  std::vector<bool> guessed_;       ///< [space]
  NearPoints guessed_places_;       ///< collocation points that depend on a guess
  std::vector<double> tool_radii_;  ///< m, [space]
  /// Candidates for the collocation points of each area (placesAround): places on the surface
  /// around its sites, m, [area].
  std::vector<std::vector<Eigen::Vector3d>> places_;
  std::mutex making_areas_;
  bool areas_made_ = false;
  std::atomic<double> areas_share_ = 0;                  ///< progress of the work on all areas, 0
                                                         ///< to 1
  std::vector<std::shared_ptr<const AreaField>> areas_;  ///< in the order of surface_.areas()
  std::vector<std::string> methods_;
  std::vector<MethodFields> fields_;
  std::vector<std::unique_ptr<DisplacementField>> shapes_;  ///< [space]
  SurfacePressures pressures_;
};

}  // namespace palpate
