#pragma once

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
  /// Prepared for switching between them while touching; the first is the one to start with.
  std::vector<std::string> methods = {"potential", "trilinear"};
  double reach = 0;  ///< m, TouchSurface
  /// Keep the pressures of the surface too, where the dataset has them: 4 bytes per vertex and
  /// solved point.
  bool pressures = false;
  /// In the constructor, all of them; else each by HapticModel::prepare(), and preparePressures().
  bool prepare = true;
  /// Ends the reading of what is seen: the constructor throws an Error of an interrupt then.
  std::stop_token stop = {};
};

/// All of one dataset that a hand needs, in memory: the file may be replaced or go.
///
/// Threads: any may read. Methods can be prepared while others read: one becomes visible when it is
/// whole, and stays as it is from then on.
class HapticModel {
 public:
  /// Error when the dataset has nothing to touch, or a method is unknown.
  explicit HapticModel(const Dataset& dataset, const HapticModelOptions& options = {});

  /// Makes the fields of one method for all spaces, side by side on all cores: some 0.2 s of
  /// processor time for a space of 515 points and `potential`, some 12 s for the area of 315 sites
  /// on 37 solved points each, with the first method. Does nothing for a method that is prepared.
  /// Not twice at once for a method. Until it is done or `stop` is requested; the next call goes on
  /// from there, but begins areas anew. Error for an unknown method.
  void prepare(std::size_t method, const std::stop_token& stop = {});
  /// The same in this thread alone, but for areas.
  void prepareAlone(std::size_t method, const std::stop_token& stop);
  /// How far a method is prepared, 0 to 1, and 1 only when it isPrepared(): the share of its
  /// spaces, or of the work on areas, which all methods share; 0 for one that is not in methods().
  /// Any thread; waits for nothing.
  double preparedShare(std::size_t method) const noexcept;
  /// Whether field() may be asked for a method. Any thread, real time.
  bool isPrepared(std::size_t method) const noexcept {
    return method < fields_.size() &&
           fields_[method].made.load(std::memory_order_acquire) == spaces_.size();
  }

  /// Makes pressures() ready, if they were asked for, in this thread alone, until it is done or
  /// `stop` is requested: some milliseconds a space. Not twice at once.
  void preparePressures(const std::stop_token& stop = {});

  const std::string& name() const { return name_; }                ///< of the scene
  const std::vector<Region>& regions() const { return regions_; }  ///< materials, at least one
  const std::string& file() const { return file_; }
  ContentId contentId() const { return content_; }
  ContactMode contactMode() const { return contact_; }  ///< what the scene asks for
  double maxForce() const { return max_force_; }  ///< N, of the scene: nothing beyond it was solved
  /// m, of the tool that a space was computed with: a finger's, or how far its patch reaches around
  /// the active node; 0 of a single node.
  double toolRadius(std::size_t space) const { return tool_radii_[space]; }
  const TouchSurface& surface() const { return surface_; }
  const std::vector<SpaceTable>& spaces() const { return spaces_; }
  const std::vector<std::string>& methods() const { return methods_; }
  /// Only of a method that isPrepared(). Real time.
  const ForceField& field(std::size_t method, std::size_t space) const noexcept {
    return *fields_[method].of_space[space];
  }
  /// The energy of one of surface().areas(), of any method: between sites there is one only. Once
  /// some method isPrepared(). Real time.
  const AreaField& area(std::size_t number) const noexcept { return *areas_[number]; }
  /// Displacements of the surface's vertices.
  const DisplacementField& shape(std::size_t space) const { return *shapes_[space]; }
  /// Never prepared where they were not asked for.
  const SurfacePressures& pressures() const { return pressures_; }

 private:
  /// One method in all spaces. Threads write different elements, each before it counts it in
  /// `made`.
  struct MethodFields {
    std::vector<std::unique_ptr<const ForceField>> of_space;
    std::atomic<std::size_t> made = 0;
  };
  void make(std::size_t method, std::size_t space);
  bool makeAreas(const std::stop_token& stop);  ///< whether they are there
  void readShapes(const Dataset& dataset, bool with_pressures, const std::stop_token& stop);

  std::string name_, file_;
  std::vector<Region> regions_;
  ContentId content_;
  ContactMode contact_;
  double max_force_;
  TouchSurface surface_;
  std::vector<SpaceTable> spaces_;
  std::vector<double> tool_radii_;                    ///< m, [space]
  std::vector<std::vector<Eigen::Vector3d>> places_;  ///< m, per area, for its collocation points
  std::mutex making_areas_;
  bool areas_made_ = false;
  std::atomic<double> areas_share_ = 0;                  ///< of the work on areas
  std::vector<std::shared_ptr<const AreaField>> areas_;  ///< as surface_.areas()
  std::vector<std::int32_t> area_of_space_;              ///< -1: none
  std::vector<std::string> methods_;
  std::vector<MethodFields> fields_;
  std::vector<std::unique_ptr<DisplacementField>> shapes_;  ///< [space]
  SurfacePressures pressures_;
};

}  // namespace palpate
