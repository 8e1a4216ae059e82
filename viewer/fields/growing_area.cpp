#include "viewer/fields/growing_area.hpp"

#include <algorithm>
#include <set>

namespace palpate {

GrowingArea::GrowingArea(std::vector<const SpaceTable*> sites,
                         std::vector<Eigen::Vector3d> stations)
    : AreaField(sites, Stations{std::move(stations)}),
      sites_(std::move(sites)),
      made_(sites_.size()) {
  fits_.emplace_back(sites_.front()->lattice.unit());
}

bool GrowingArea::makeOneOf(const std::vector<std::size_t>& sites) {
  const auto lacking = std::find_if(sites.begin(), sites.end(),
                                    [&](std::size_t site) { return !made_[site].has_value(); });
  if (lacking == sites.end()) return false;
  made_[*lacking].emplace(*sites_[*lacking], fits_.front());
  ++made_count_;
  return true;
}

bool GrowingArea::grow(const Eigen::Vector3d& s) {
  for (const std::size_t station : stationsAt(s)) {
    if (isInterpolated(station)) continue;
    if (makeOneOf(sitesOfStation(station))) return true;
    beginStation(station, sites_);
    interpolateTo(station, made_);
    return true;
  }
  for (const std::size_t site : sitesAt(s)) {
    if (isJudged(site)) continue;
    if (makeOneOf({site}) || makeOneOf(sitesOfJudgement(site))) return true;
    beginJudgement(site, sites_);
    judge(site, sites_, made_);
    return true;
  }
  return false;
}

void GrowingArea::prepare(const Eigen::Vector3d& s) {
  std::set<std::size_t> lacking;
  const auto add = [&](const std::vector<std::size_t>& sites) {
    for (const std::size_t site : sites)
      if (!made_[site]) lacking.insert(site);
  };
  for (const std::size_t station : stationsAt(s))
    if (!isInterpolated(station)) add(sitesOfStation(station));
  const std::vector<std::size_t> judged = sitesAt(s);
  add(judged);
  for (const std::size_t site : judged)
    if (!isJudged(site)) add(sitesOfJudgement(site));
  makeSites(sites_, {lacking.begin(), lacking.end()}, fits_, made_, {});
  made_count_ += lacking.size();
  while (grow(s)) {
  }
}

bool GrowingArea::growSites(const Eigen::Vector3d& s) {
  std::size_t nearest = sites_.size();
  double least = 0;
  for (std::size_t n = 0; n < sites_.size(); ++n) {
    if (made_[n]) continue;
    const double away = (sites_[n]->patch.finger.value().center - s).squaredNorm();
    if (nearest < sites_.size() && away >= least) continue;
    nearest = n;
    least = away;
  }
  return nearest < sites_.size() && makeOneOf({nearest});
}

bool GrowingArea::isPrepared(const Eigen::Vector3d& s) const {
  return std::ranges::all_of(stationsAt(s), [&](std::size_t n) { return isInterpolated(n); }) &&
         std::ranges::all_of(sitesAt(s), [&](std::size_t n) { return isJudged(n); });
}

AreaSample GrowingArea::evaluate(const Eigen::Vector3d& s, const Eigen::Vector3d& p) const {
  return isPrepared(s) ? AreaField::evaluate(s, p) : AreaSample{};
}

}  // namespace palpate
