#include "viewer/c_api/loaded_dataset.hpp"

using namespace palpate;

namespace {

palpate_area_sample sampleOf(const LoadedDataset& dataset, std::size_t area,
                             const Eigen::Vector3d& near, const Eigen::Vector3d& displacement) {
  const ForceAnswer answer =
      dataset.places[area].answer(dataset.model.area(area), near, displacement);
  palpate_area_sample given{};
  giveForce(given, answer.sample);
  give(given.drive, answer.finger->drive);
  give(given.at, answer.finger->at);
  given.triangle = answer.finger->triangle;
  given.distance = answer.finger->distance;
  return given;
}

std::size_t areaOf(const LoadedDataset& dataset, std::int32_t area) {
  return indexOf("area", area, dataset.areas.size());
}

}  // namespace

palpate_status palpate_dataset_area_count(const palpate_dataset* dataset, std::int32_t* count) {
  return answered(__func__, [&] {
    need("count", count) = static_cast<std::int32_t>(loadedOf(dataset).areas.size());
  });
}

palpate_status palpate_dataset_area(const palpate_dataset* dataset, std::int32_t area,
                                    palpate_area_info* info) {
  return answered(__func__, [&] {
    const LoadedDataset& loaded = loadedOf(dataset);
    give("info", info, loaded.areas[areaOf(loaded, area)]);
  });
}

palpate_status palpate_dataset_find_area(const palpate_dataset* dataset, const char* name,
                                         std::int32_t* area) {
  return answered(__func__, [&] {
    need("area", area) = numberOf("area", name, loadedOf(dataset).areas, &palpate_area_info::name);
  });
}

palpate_status palpate_area_query(const palpate_dataset* dataset, std::int32_t area,
                                  const double at[3], const double displacement[3],
                                  palpate_area_sample* sample) {
  return answered(__func__, [&] {
    const LoadedDataset& loaded = loadedOf(dataset);
    give("sample", sample,
         sampleOf(loaded, areaOf(loaded, area), vectorOf("at", at),
                  vectorOf("displacement", displacement)));
  });
}

palpate_status palpate_area_query_many(const palpate_dataset* dataset, std::int32_t area,
                                       const double* places, const double* displacements,
                                       std::size_t count, const palpate_answers* answers) {
  return answered(__func__, [&] {
    const LoadedDataset& loaded = loadedOf(dataset);
    const std::size_t touched = areaOf(loaded, area);
    need("places", places);
    need("displacements", displacements);
    const palpate_answers wanted = taken("answers", answers, palpate_answers{});
    for (std::size_t n = 0; n < count; ++n) {
      const palpate_area_sample sample =
          sampleOf(loaded, touched, vectorOf(places + 3 * n), vectorOf(displacements + 3 * n));
      giveAnswer(wanted, n, sample);
      if (wanted.drives != nullptr) std::copy_n(sample.drive, 3, wanted.drives + 3 * n);
      if (wanted.places != nullptr) std::copy_n(sample.at, 3, wanted.places + 3 * n);
      if (wanted.triangles != nullptr) wanted.triangles[n] = sample.triangle;
      if (wanted.distances != nullptr) wanted.distances[n] = sample.distance;
    }
  });
}
