#include <algorithm>
#include <functional>

#include "viewer/c_api/arguments.hpp"
#include "viewer/c_api/loaded_dataset.hpp"
#include "viewer/fields/field_choice.hpp"

using namespace palpate;

namespace {

bool methodsAreKnown(const char* function, const palpate_open_options& options) {
  for (std::size_t m = 0; m < options.method_count; ++m) {
    if (options.methods == nullptr || options.methods[m] == nullptr)
      return refuse("{}: options->methods[{}] of {} is NULL", function, m, options.method_count);
    const auto& known = forceFieldMethods();
    if (std::ranges::find(known, options.methods[m]) == known.end())
      return refuse("{}: unknown method \"{}\"; known: {}", function, options.methods[m],
                    fmt::join(known, ", "));
  }
  return true;
}

palpate_sample sampleOf(const ForceField& field, const double displacement[3]) {
  palpate_sample sample{};
  giveForce(sample, field.evaluate(vectorOf(displacement)));
  return sample;
}

}  // namespace

palpate_status palpate_dataset_open(const char* file, const palpate_open_options* options,
                                    palpate_dataset** dataset) {
  if (!isThere(__func__, "dataset", dataset)) return PALPATE_INVALID_ARGUMENT;
  *dataset = nullptr;
  if (!isThere(__func__, "file", file)) return PALPATE_INVALID_ARGUMENT;
  palpate_open_options chosen{};
  if (!takeOptions(__func__, options, chosen) ||
      !isFinite(__func__, "options->reach", chosen.reach, Least::zero))
    return PALPATE_INVALID_ARGUMENT;
  bool known = true;
  const char* const function = __func__;
  const palpate_status status = withoutExceptions(function, [&] {
    // Check inside withoutExceptions(), because listing the methods allocates.
    known = methodsAreKnown(function, chosen);
    if (!known) return;
    const std::lock_guard lock(hdf5Mutex());
    HapticModelOptions model_options = {.reach = chosen.reach};
    if (chosen.method_count > 0)
      model_options.methods.assign(chosen.methods, chosen.methods + chosen.method_count);
    *dataset =
        new palpate_dataset{std::make_shared<const LoadedDataset>(Dataset(file), model_options)};
  });
  return known ? status : PALPATE_INVALID_ARGUMENT;
}

void palpate_dataset_close(palpate_dataset* dataset) { delete dataset; }

palpate_status palpate_dataset_describe(const palpate_dataset* dataset,
                                        palpate_dataset_info* info) {
  if (!isThere(__func__, "dataset", dataset) || !sizeIsKnown(__func__, "info", info))
    return PALPATE_INVALID_ARGUMENT;
  give(info, dataset->loaded->info);
  return PALPATE_OK;
}

palpate_status palpate_dataset_space(const palpate_dataset* dataset, std::int32_t space,
                                     palpate_space_info* info) {
  if (!isThere(__func__, "dataset", dataset) || !sizeIsKnown(__func__, "info", info) ||
      !isNumber(__func__, "space", space, dataset->loaded->info.space_count))
    return PALPATE_INVALID_ARGUMENT;
  give(info, dataset->loaded->spaces[at(space)]);
  return PALPATE_OK;
}

palpate_status palpate_dataset_find_space(const palpate_dataset* dataset, const char* name,
                                          std::int32_t* space) {
  if (!isThere(__func__, "dataset", dataset)) return PALPATE_INVALID_ARGUMENT;
  return findNamed(__func__, "active node", name, dataset->loaded->spaces,
                   &palpate_space_info::name, "space", space);
}

const char* palpate_dataset_method(const palpate_dataset* dataset, std::int32_t method) {
  if (!isThere(__func__, "dataset", dataset) ||
      !isNumber(__func__, "method", method, dataset->loaded->info.method_count))
    return nullptr;
  return dataset->loaded->model.methods()[at(method)].c_str();
}

palpate_status palpate_dataset_find_method(const palpate_dataset* dataset, const char* name,
                                           std::int32_t* method) {
  if (!isThere(__func__, "dataset", dataset)) return PALPATE_INVALID_ARGUMENT;
  return findNamed(__func__, "prepared method", name, dataset->loaded->model.methods(),
                   std::identity(), "method", method);
}

palpate_status palpate_dataset_vertices(const palpate_dataset* dataset, double* vertices,
                                        std::size_t capacity) {
  if (!isThere(__func__, "dataset", dataset) || !isThere(__func__, "vertices", vertices) ||
      !isEnough(__func__, capacity, countOf(dataset->loaded->info.vertex_count)))
    return PALPATE_INVALID_ARGUMENT;
  for (const Eigen::Vector3d& vertex : dataset->loaded->model.surface().vertices())
    vertices = std::copy_n(vertex.data(), 3, vertices);
  return PALPATE_OK;
}

palpate_status palpate_dataset_triangles(const palpate_dataset* dataset, std::int32_t* triangles,
                                         std::size_t capacity) {
  if (!isThere(__func__, "dataset", dataset) || !isThere(__func__, "triangles", triangles) ||
      !isEnough(__func__, capacity, countOf(dataset->loaded->info.triangle_count)))
    return PALPATE_INVALID_ARGUMENT;
  for (const Triangle& triangle : dataset->loaded->model.surface().triangles())
    triangles = std::copy(triangle.begin(), triangle.end(), triangles);
  return PALPATE_OK;
}

palpate_status palpate_dataset_touchable(const palpate_dataset* dataset, std::uint8_t* touchable,
                                         std::size_t capacity) {
  if (!isThere(__func__, "dataset", dataset) || !isThere(__func__, "touchable", touchable) ||
      !isEnough(__func__, capacity, at(dataset->loaded->info.triangle_count)))
    return PALPATE_INVALID_ARGUMENT;
  const TouchSurface& surface = dataset->loaded->model.surface();
  for (std::int32_t t = 0; t < dataset->loaded->info.triangle_count; ++t)
    touchable[t] = surface.touchable(t) ? 1 : 0;
  return PALPATE_OK;
}

palpate_status palpate_query(const palpate_dataset* dataset, std::int32_t space,
                             std::int32_t method, const double displacement[3],
                             palpate_sample* sample) {
  if (!isThere(__func__, "dataset", dataset) || !isThere(__func__, "displacement", displacement) ||
      !sizeIsKnown(__func__, "sample", sample) ||
      !isNumber(__func__, "space", space, dataset->loaded->info.space_count) ||
      !isNumber(__func__, "method", method, dataset->loaded->info.method_count))
    return PALPATE_INVALID_ARGUMENT;
  give(sample, sampleOf(dataset->loaded->model.field(at(method), at(space)), displacement));
  return PALPATE_OK;
}

palpate_status palpate_query_many(const palpate_dataset* dataset, std::int32_t space,
                                  std::int32_t method, const double* displacements,
                                  std::size_t count, const palpate_answers* answers) {
  if (!isThere(__func__, "dataset", dataset) ||
      !isThere(__func__, "displacements", displacements) ||
      !sizeIsKnown(__func__, "answers", answers) ||
      !isNumber(__func__, "space", space, dataset->loaded->info.space_count) ||
      !isNumber(__func__, "method", method, dataset->loaded->info.method_count))
    return PALPATE_INVALID_ARGUMENT;
  const palpate_answers wanted = taken(answers, palpate_answers{});
  if (wanted.drives != nullptr || wanted.places != nullptr || wanted.triangles != nullptr ||
      wanted.distances != nullptr)
    return fail(
        PALPATE_INVALID_ARGUMENT,
        "{}: answers->drives, places, triangles and distances are for areas; set them to NULL",
        __func__);
  const ForceField& field = dataset->loaded->model.field(at(method), at(space));
  for (std::size_t n = 0; n < count; ++n)
    giveAnswer(wanted, n, sampleOf(field, displacements + 3 * n));
  return PALPATE_OK;
}

palpate_status palpate_displacements(const palpate_dataset* dataset, std::int32_t space,
                                     const double displacement[3], float* displacements,
                                     std::size_t capacity, std::int32_t* inside) {
  if (!isThere(__func__, "dataset", dataset) || !isThere(__func__, "displacement", displacement) ||
      !isThere(__func__, "displacements", displacements) ||
      !isNumber(__func__, "space", space, dataset->loaded->info.space_count))
    return PALPATE_INVALID_ARGUMENT;
  const std::size_t needed = countOf(dataset->loaded->info.vertex_count);
  if (!isEnough(__func__, capacity, needed)) return PALPATE_INVALID_ARGUMENT;
  const bool in_ball = dataset->loaded->model.shape(at(space)).evaluate(vectorOf(displacement),
                                                                        {displacements, needed});
  if (inside != nullptr) *inside = in_ball ? 1 : 0;
  return PALPATE_OK;
}
