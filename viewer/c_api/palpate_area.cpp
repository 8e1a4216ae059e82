#include "viewer/c_api/arguments.hpp"
#include "viewer/c_api/loaded_dataset.hpp"

using namespace palpate;

namespace {

palpate_area_sample sampleOf(const LoadedDataset& dataset, std::int32_t area,
                             const Eigen::Vector3d& near, const Eigen::Vector3d& displacement) {
  const ForceAnswer answer =
      dataset.places[at(area)].answer(dataset.model.area(at(area)), near, displacement);
  palpate_area_sample given{};
  giveForce(given, answer.sample);
  give(given.drive, answer.finger->drive);
  give(given.at, answer.finger->at);
  given.triangle = answer.finger->triangle;
  given.distance = answer.finger->distance;
  return given;
}

}  // namespace

palpate_status palpate_dataset_area_count(const palpate_dataset* dataset, std::int32_t* count) {
  if (!isThere(__func__, "dataset", dataset) || !isThere(__func__, "count", count))
    return PALPATE_INVALID_ARGUMENT;
  *count = static_cast<std::int32_t>(dataset->loaded->areas.size());
  return PALPATE_OK;
}

palpate_status palpate_dataset_area(const palpate_dataset* dataset, std::int32_t area,
                                    palpate_area_info* info) {
  if (!isThere(__func__, "dataset", dataset) || !sizeIsKnown(__func__, "info", info) ||
      !isNumber(__func__, "area", area, std::ssize(dataset->loaded->areas)))
    return PALPATE_INVALID_ARGUMENT;
  give(info, dataset->loaded->areas[at(area)]);
  return PALPATE_OK;
}

palpate_status palpate_dataset_find_area(const palpate_dataset* dataset, const char* name,
                                         std::int32_t* area) {
  if (!isThere(__func__, "dataset", dataset)) return PALPATE_INVALID_ARGUMENT;
  return findNamed(__func__, "area", name, dataset->loaded->areas, &palpate_area_info::name, "area",
                   area);
}

palpate_status palpate_area_query(const palpate_dataset* dataset, std::int32_t area,
                                  const double at[3], const double displacement[3],
                                  palpate_area_sample* sample) {
  if (!isThere(__func__, "dataset", dataset) || !isThere(__func__, "at", at) ||
      !isThere(__func__, "displacement", displacement) ||
      !sizeIsKnown(__func__, "sample", sample) ||
      !isNumber(__func__, "area", area, std::ssize(dataset->loaded->areas)))
    return PALPATE_INVALID_ARGUMENT;
  give(sample, sampleOf(*dataset->loaded, area, vectorOf(at), vectorOf(displacement)));
  return PALPATE_OK;
}

palpate_status palpate_area_query_many(const palpate_dataset* dataset, std::int32_t area,
                                       const double* places, const double* displacements,
                                       std::size_t count, const palpate_answers* answers) {
  if (!isThere(__func__, "dataset", dataset) || !isThere(__func__, "places", places) ||
      !isThere(__func__, "displacements", displacements) ||
      !sizeIsKnown(__func__, "answers", answers) ||
      !isNumber(__func__, "area", area, std::ssize(dataset->loaded->areas)))
    return PALPATE_INVALID_ARGUMENT;
  const palpate_answers wanted = taken(answers, palpate_answers{});
  for (std::size_t n = 0; n < count; ++n) {
    const palpate_area_sample sample =
        sampleOf(*dataset->loaded, area, vectorOf(places + 3 * n), vectorOf(displacements + 3 * n));
    giveAnswer(wanted, n, sample);
    if (wanted.drives != nullptr) std::copy_n(sample.drive, 3, wanted.drives + 3 * n);
    if (wanted.places != nullptr) std::copy_n(sample.at, 3, wanted.places + 3 * n);
    if (wanted.triangles != nullptr) wanted.triangles[n] = sample.triangle;
    if (wanted.distances != nullptr) wanted.distances[n] = sample.distance;
  }
  return PALPATE_OK;
}
