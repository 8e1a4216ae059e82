#pragma once

#include "viewer/fields/area_field.hpp"

namespace palpate {

/// The AreaField of some sites, prepared only where a finger is: for a page, which must not make
/// its reader wait, and for commands that ask a few places. Where it is prepared it says what the
/// whole field does, to the last bit.
///
/// One thread.
class GrowingArea : private AreaField {
 public:
  /// `sites` outlive this object. `stations`: those of the whole field (AreaField::stations), at
  /// least one, metres.
  GrowingArea(std::vector<const SpaceTable*> sites, std::vector<Eigen::Vector3d> stations);

  /// Makes one piece of what a finger at s (metres) needs, some milliseconds of work; false when
  /// nothing is lacking there. Error when a site has no solved point.
  bool grow(const Eigen::Vector3d& s);
  /// Makes all that a finger at s (metres) needs, its sites side by side on all cores. Error as
  /// grow().
  void prepare(const Eigen::Vector3d& s);
  /// Makes one site that is not made yet, of all the nearest to s; false when all are. Where sites
  /// are made, growing is quick.
  bool growSites(const Eigen::Vector3d& s);
  /// How many sites are made.
  std::size_t madeSites() const { return made_count_; }

  using AreaField::siteCount;
  using AreaField::siteReach;
  using AreaField::sitesAt;
  /// As AreaField::evaluate, where grow(s) has nothing to do any more; elsewhere the sample is not
  /// inside and has no force.
  AreaSample evaluate(const Eigen::Vector3d& s, const Eigen::Vector3d& p) const;
  const SpaceTable& site(std::size_t number) const { return *sites_[number]; }

 private:
  bool isPrepared(const Eigen::Vector3d& s) const;
  bool makeOneOf(const std::vector<std::size_t>& sites);

  std::vector<const SpaceTable*> sites_;
  std::vector<SiteFits> fits_;  ///< per thread, at least one
  MadeSites made_;
  std::size_t made_count_ = 0;
};

}  // namespace palpate
