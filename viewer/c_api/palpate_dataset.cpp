#include <algorithm>
#include <functional>

#include "viewer/c_api/loaded_dataset.hpp"
#include "viewer/fields/field_choice.hpp"

using namespace palpate;

namespace {

/// Returns the chosen methods; empty for all.
std::vector<std::string> methodsOf(const palpate_open_options& options) {
  const auto& known = forceFieldMethods();
  std::vector<std::string> methods;
  for (std::size_t m = 0; m < options.method_count; ++m) {
    if (options.methods == nullptr || options.methods[m] == nullptr)
      refuse("options->methods[{}] of {} is NULL", m, options.method_count);
    if (std::ranges::find(known, options.methods[m]) == known.end())
      refuse("unknown method \"{}\"; known: {}", options.methods[m], fmt::join(known, ", "));
    methods.emplace_back(options.methods[m]);
  }
  return methods;
}

palpate_sample sampleOf(const ForceField& field, const Eigen::Vector3d& displacement) {
  palpate_sample sample{};
  giveForce(sample, field.evaluate(displacement));
  return sample;
}

std::size_t spaceOf(const LoadedDataset& dataset, std::int32_t space) {
  return indexOf("space", space, dataset.spaces.size());
}

const ForceField& fieldOf(const palpate_dataset* dataset, std::int32_t space, std::int32_t method) {
  const LoadedDataset& loaded = loadedOf(dataset);
  const std::size_t chosen = indexOf("method", method, loaded.model.methods().size());
  return loaded.model.field(chosen, spaceOf(loaded, space));
}

}  // namespace

palpate_status palpate_dataset_open(const char* file, const palpate_open_options* options,
                                    palpate_dataset** dataset) {
  return answered(__func__, [&] {
    need("dataset", dataset) = nullptr;
    need("file", file);
    const palpate_open_options chosen = takenOptions(options, palpate_open_options{});
    HapticModelOptions prepared = {.reach = finite("options->reach", chosen.reach, Least::zero)};
    if (chosen.method_count > 0) prepared.methods = methodsOf(chosen);
    const std::lock_guard lock(hdf5Mutex());
    *dataset = new palpate_dataset{std::make_shared<const LoadedDataset>(Dataset(file), prepared)};
  });
}

void palpate_dataset_close(palpate_dataset* dataset) { delete dataset; }

palpate_status palpate_dataset_describe(const palpate_dataset* dataset,
                                        palpate_dataset_info* info) {
  return answered(__func__, [&] { give("info", info, loadedOf(dataset).info); });
}

palpate_status palpate_dataset_space(const palpate_dataset* dataset, std::int32_t space,
                                     palpate_space_info* info) {
  return answered(__func__, [&] {
    const LoadedDataset& loaded = loadedOf(dataset);
    give("info", info, loaded.spaces[spaceOf(loaded, space)]);
  });
}

palpate_status palpate_dataset_find_space(const palpate_dataset* dataset, const char* name,
                                          std::int32_t* space) {
  return answered(__func__, [&] {
    need("space", space) =
        numberOf("active node", name, loadedOf(dataset).spaces, &palpate_space_info::name);
  });
}

const char* palpate_dataset_method(const palpate_dataset* dataset, std::int32_t method) {
  const char* name = nullptr;
  answered(__func__, [&] {
    const auto& methods = loadedOf(dataset).model.methods();
    name = methods[indexOf("method", method, methods.size())].c_str();
  });
  return name;
}

palpate_status palpate_dataset_find_method(const palpate_dataset* dataset, const char* name,
                                           std::int32_t* method) {
  return answered(__func__, [&] {
    need("method", method) =
        numberOf("prepared method", name, loadedOf(dataset).model.methods(), std::identity());
  });
}

palpate_status palpate_dataset_vertices(const palpate_dataset* dataset, double* vertices,
                                        std::size_t capacity) {
  return answered(__func__, [&] {
    const auto& given = loadedOf(dataset).model.surface().vertices();
    double* to = roomIn("vertices", vertices, capacity, 3 * given.size()).data();
    for (const Eigen::Vector3d& vertex : given) to = std::copy_n(vertex.data(), 3, to);
  });
}

palpate_status palpate_dataset_triangles(const palpate_dataset* dataset, std::int32_t* triangles,
                                         std::size_t capacity) {
  return answered(__func__, [&] {
    const auto& given = loadedOf(dataset).model.surface().triangles();
    std::int32_t* to = roomIn("triangles", triangles, capacity, 3 * given.size()).data();
    for (const Triangle& triangle : given) to = std::ranges::copy(triangle, to).out;
  });
}

palpate_status palpate_dataset_touchable(const palpate_dataset* dataset, std::uint8_t* touchable,
                                         std::size_t capacity) {
  return answered(__func__, [&] {
    const TouchSurface& surface = loadedOf(dataset).model.surface();
    std::int32_t t = 0;
    for (auto& one : roomIn("touchable", touchable, capacity, surface.triangles().size()))
      one = surface.touchable(t++) ? 1 : 0;
  });
}

palpate_status palpate_query(const palpate_dataset* dataset, std::int32_t space,
                             std::int32_t method, const double displacement[3],
                             palpate_sample* sample) {
  return answered(__func__, [&] {
    const ForceField& field = fieldOf(dataset, space, method);
    give("sample", sample, sampleOf(field, vectorOf("displacement", displacement)));
  });
}

palpate_status palpate_query_many(const palpate_dataset* dataset, std::int32_t space,
                                  std::int32_t method, const double* displacements,
                                  std::size_t count, const palpate_answers* answers) {
  return answered(__func__, [&] {
    const ForceField& field = fieldOf(dataset, space, method);
    need("displacements", displacements);
    const palpate_answers wanted = taken("answers", answers, palpate_answers{});
    if (wanted.drives != nullptr || wanted.places != nullptr || wanted.triangles != nullptr ||
        wanted.distances != nullptr)
      refuse("answers->drives, places, triangles and distances are for areas; set them to NULL");
    for (std::size_t n = 0; n < count; ++n)
      giveAnswer(wanted, n, sampleOf(field, vectorOf(displacements + 3 * n)));
  });
}

palpate_status palpate_displacements(const palpate_dataset* dataset, std::int32_t space,
                                     const double displacement[3], float* displacements,
                                     std::size_t capacity, std::int32_t* inside) {
  return answered(__func__, [&] {
    const LoadedDataset& loaded = loadedOf(dataset);
    const auto& shape = loaded.model.shape(spaceOf(loaded, space));
    const auto filled = roomIn("displacements", displacements, capacity,
                               3 * loaded.model.surface().vertices().size());
    const bool in_ball = shape.evaluate(vectorOf("displacement", displacement), filled);
    if (inside != nullptr) *inside = in_ball ? 1 : 0;
  });
}
