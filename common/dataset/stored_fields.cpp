#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/assertion.hpp"
#include "common/dataset/dataset_format.hpp"

namespace palpate {
namespace {

constexpr const char *displacement_path = "/points/displacement",
                     *step_path = "/points/displacement_step", *pressure_path = "/points/pressure",
                     *hash_path = "/points/stored_id";
/// Value of all fields at points that are not solved.
constexpr float unsolved = std::numeric_limits<float>::quiet_NaN();

/// Largest error of a quantized displacement, in quantization steps: a half, plus a margin for
/// rounding to float32.
constexpr double quantization_error = 0.51;

/// Displacements as 16-bit integers: a displacement is step * value. The largest magnitude has the
/// value 32767.
struct Quantized {
  float step = 0;  ///< metres
  std::vector<std::int16_t> values;
};

Quantized quantize(std::span<const float> displacement) {
  constexpr double largest_integer = 32767;
  double largest = 0;
  for (const float value : displacement)
    largest = std::max(largest, std::abs(static_cast<double>(value)));
  Quantized quantized;
  quantized.step = static_cast<float>(largest / largest_integer);
  quantized.values.reserve(displacement.size());
  for (const float value : displacement) {
    // The step is zero if all displacements are zero, or so small that it underflows as a float.
    const double steps = quantized.step > 0 ? value / static_cast<double>(quantized.step) : 0;
    quantized.values.push_back(static_cast<std::int16_t>(
        std::clamp(std::round(steps), -largest_integer, largest_integer)));
  }
  return quantized;
}

/// Returns the hash of one row. It covers the bytes of the stored displacements, the quantization
/// step (null if they are not quantized), and the pressures if there are any.
ContentId rowHash(std::string_view displacement, const float* step,
                  std::span<const float> pressure) {
  ContentHasher hasher;
  hasher.add(displacement);
  if (step != nullptr) hasher.add(bytesOf(std::span(step, 1)));
  hasher.add(bytesOf(pressure));
  return hasher.finish();
}

bool isQuantized(const Scene& scene) { return scene.storage.precision == StoredPrecision::int16; }

hdf5::Element elementOf(bool quantized) {
  return quantized ? hdf5::Element::int16 : hdf5::Element::float32;
}

/// Returns the displacements of the stored nodes.
std::vector<float> displacementsOf(const NodalFields& fields,
                                   const std::vector<std::int32_t>& stored) {
  std::vector<float> displacement;
  for (const std::int32_t node : stored) {
    const float* const u = &fields.displacement[3 * static_cast<std::size_t>(node)];
    displacement.insert(displacement.end(), u, u + 3);
  }
  return displacement;
}

}  // namespace

void writeFields(hdf5::Writer& out, const Problem& problem, const SpaceRowsList& spaces,
                 const std::function<NodalFields(std::size_t, std::int32_t)>& fields) {
  const std::vector<std::int32_t> stored = storedNodes(problem.scene, problem.mesh);
  const hsize_t n_pressures = storedPressures(problem);
  const bool quantized = isQuantized(problem.scene);
  const std::size_t bytes_each = storedBytes(problem);
  hsize_t n_rows = 0;
  for (const auto& space : spaces) n_rows += static_cast<hsize_t>(space->points());
  hdf5::RowWriter displacements(out, displacement_path, elementOf(quantized),
                                {n_rows, stored.size(), 3}, quantized ? "1" : "m",
                                hdf5::RowLayout::compressed);
  std::optional<hdf5::RowWriter> pressures;
  if (n_pressures > 0)
    pressures.emplace(out, pressure_path, hdf5::Element::float32, hdf5::Shape{n_rows, n_pressures},
                      "Pa", hdf5::RowLayout::compressed);
  std::vector<float> steps;  // quantization steps, m
  std::vector<ContentId> hashes;
  for (std::size_t s = 0; s < spaces.size(); ++s)
    for (std::int32_t n = 0; n < spaces[s]->points(); ++n) {
      if (!isSolved(spaces[s]->tag(n))) {
        displacements.skip();
        if (pressures) pressures->skip();
        steps.push_back(unsolved);
        hashes.emplace_back();
        continue;
      }
      const NodalFields given = fields(s, n);
      // Check the fields again, because they may have been on a disk for weeks.
      if (given.id() != spaces[s]->point(n).fields ||
          given.displacement.size() != 3 * problem.mesh.nodes.size() ||
          given.pressure.size() != problem.pressures.count())
        throw failure("{}: space {}: the nodal fields of lattice point {} do not match its result",
                      out.name(), spaces[s]->patch().name, n);
      const std::vector<float> displacement = displacementsOf(given, stored);
      const Quantized integers = quantized ? quantize(displacement) : Quantized();
      const std::string_view bytes =
          quantized ? bytesOf(std::span(integers.values)) : bytesOf(std::span(displacement));
      const auto pressure = pressures ? std::span(given.pressure) : std::span<const float>();
      PALPATE_ASSERT(bytes.size() + pressure.size_bytes() == bytes_each,
                     "storedBytes() must match the bytes written");
      if (pressures) pressures->addBytes(bytesOf(pressure));
      displacements.addBytes(bytes);
      steps.push_back(integers.step);
      hashes.push_back(rowHash(bytes, quantized ? &integers.step : nullptr, pressure));
    }
  // Keep the order of these calls, because the bytes of the file depend on it.
  if (!quantized) displacements.finish();
  if (pressures) pressures->finish();
  out.writeList(hash_path, hashes, "1");
  if (!quantized) return;
  displacements.finish();
  out.writeList(step_path, steps, "m");
  float largest = 0;
  for (const float step : steps) largest = std::fmax(largest, step);  // fmax skips NaN
  out.setNumber(displacement_path, "error_bound", quantization_error * largest);
}

FieldsReader::FieldsReader(const hdf5::Reader& in, const Scene& scene, const Mesh& mesh,
                           const std::vector<SpaceTable>& spaces)
    : in_(in),
      n_values_(3 * storedNodes(scene, mesh).size()),
      n_pressures_(scene.storage.displacement == StoredNodes::all
                       ? pressureNodes(scene.discretization.pressure, mesh)
                       : 0),
      quantized_(isQuantized(scene)) {
  std::size_t n_rows = 0;
  for (const SpaceTable& space : spaces) {
    first_rows_.push_back(n_rows);
    n_rows += space.points.size();
  }
  in.array(displacement_path, elementOf(quantized_), {n_rows, n_values_ / 3, 3});
  if (n_pressures_ > 0) {
    // Accept more columns than nodes, because nodes between materials have several pressures
    // (PressureSlots). The exact number is unknown here, because it depends on the regions.
    const hdf5::Shape& shape = in.array(pressure_path).shape;
    stored_pressures_ = shape.size() == 2 ? std::max<std::size_t>(shape[1], n_pressures_) : 0;
    in.array(pressure_path, hdf5::Element::float32, {n_rows, stored_pressures_});
  }
  hashes_ = in.readList<ContentId>(hash_path, n_rows);
  if (quantized_) steps_ = in.readList<float>(step_path, n_rows);
}

NodalFields FieldsReader::read(std::size_t space, const SpaceTable& table, std::size_t first,
                               std::size_t count) const {
  const std::vector<PointRecord>& points = table.points;
  PALPATE_ASSERT(first + count <= points.size(), "the rows must belong to the space");
  const std::size_t first_row = first_rows_.at(space) + first;
  NodalFields rows;
  rows.pressure.resize(count * n_pressures_);
  std::vector<float> pressures(count * stored_pressures_);
  if (n_pressures_ > 0) in_.readRows<float>(in_.array(pressure_path), first_row, pressures);
  rows.displacement.resize(count * n_values_);
  std::vector<std::int16_t> integers(quantized_ ? rows.displacement.size() : 0);
  if (quantized_)
    in_.readRows<std::int16_t>(in_.array(displacement_path), first_row, integers);
  else
    in_.readRows<float>(in_.array(displacement_path), first_row, rows.displacement);
  for (std::size_t i = 0; i < count; ++i) {
    const auto values = std::span(rows.displacement).subspan(i * n_values_, n_values_);
    const auto pressure = std::span(rows.pressure).subspan(i * n_pressures_, n_pressures_);
    const auto of_row = std::span(pressures).subspan(i * stored_pressures_, stored_pressures_);
    std::ranges::copy(of_row.first(n_pressures_), pressure.begin());
    if (!isSolved(points[first + i].tag)) {
      std::ranges::fill(values, unsolved);
      std::ranges::fill(pressure, unsolved);
      continue;
    }
    const std::size_t row = first_row + i;
    std::string_view stored = bytesOf(values);
    if (quantized_) {
      const auto steps = std::span(integers).subspan(i * n_values_, n_values_);
      stored = bytesOf(steps);
      std::ranges::transform(steps, values.begin(),
                             [step = steps_[row]](std::int16_t n) { return step * n; });
    }
    if (rowHash(stored, quantized_ ? &steps_[row] : nullptr, of_row) != hashes_[row])
      throw in_.damaged(fmt::format("{} or the pressure in row {} (point {} of {})",
                                    displacement_path, row, first + i, table.patch.name),
                        "does not match stored_id");
  }
  return rows;
}

}  // namespace palpate
