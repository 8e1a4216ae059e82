#include "common/dataset/dataset.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>

#include "common/base/assertion.hpp"
#include "common/dataset/dataset_format.hpp"
#include "common/problem/selection.hpp"

namespace palpate {
namespace {

using hdf5::Reader;

void refuseOtherFormats(const Reader& in, const std::string& file) {
  if (!in.hasAttribute(layout::format_attribute) || !in.hasAttribute(layout::version_attribute) ||
      in.text(layout::format_attribute) != layout::format)
    throw badInput("{}: is an HDF5 file, but not a Palpate dataset (no attribute format = \"{}\")",
                   file, layout::format);
  const std::vector<std::int32_t> version = in.integers(layout::version_attribute);
  if (version.size() != 2) throw in.damaged(layout::version_attribute, "must be (major, minor)");
  // Check for older versions first, because the user can seal those datasets again.
  if (version[0] > 0 && version[0] < layout::oldest_major_version)
    throw badInput(
        "{}: has format version {}.{}, which is no longer supported; seal it again with `palpate "
        "build SCENE.toml --replace`, which uses the results in the state directory",
        file, version[0], version[1]);
  if (version[0] < 1 || version[0] > layout::major_version)
    throw badInput(
        "{}: has format version {}.{}, but this program reads {}.x to {}.x; use the program that "
        "made it: {}",
        file, version[0], version[1], layout::oldest_major_version, layout::major_version,
        in.text(layout::generator_attribute));
}

/// Moves the probe places out of `spaces`, where they come last, and returns them.
std::vector<SpaceTable> splitOff(std::vector<SpaceTable>& spaces) {
  const auto first = std::ranges::find_if(
      spaces, [](const SpaceTable& space) { return space.patch.probe.has_value(); });
  std::vector<SpaceTable> places(std::make_move_iterator(first),
                                 std::make_move_iterator(spaces.end()));
  spaces.erase(first, spaces.end());
  return places;
}

ContentId idIn(const Reader& in, const char* attribute) {
  const auto id = ContentId::fromHex(in.text(attribute));
  if (!id) throw in.damaged(attribute, "is not 64 hexadecimal digits");
  return *id;
}

Scene sceneIn(const Reader& in, const std::string& text, const std::string& file) {
  try {
    return parseScene(text, file + ": scene_toml");
  } catch (const Error& error) {
    throw in.damaged(layout::scene_attribute, error.what());
  }
}

/// Checks the format and the content hash, which covers the hashes of all arrays, and returns the
/// scene as text. Every array that is read later and matches its hash is therefore unchanged since
/// the dataset was sealed.
std::string openedText(Reader& in, const std::string& file) {
  refuseOtherFormats(in, file);
  // The attributes checked so far identify the file as a dataset; only now look at its arrays.
  in.findArrays();
  std::string scene_toml = in.text(layout::scene_attribute);
  if (layout::contentHash(scene_toml, in.arrays()) != idIn(in, layout::content_attribute))
    throw in.damaged(layout::content_attribute,
                     "does not match the scene and the hashes of the arrays");
  return scene_toml;
}

/// Selects the values of `nodes` from each row of `all`. A row has `size` values for each of
/// `count` nodes.
std::vector<float> rowsOfNodes(const std::vector<float>& all, std::size_t count, std::size_t size,
                               const std::vector<std::int32_t>& nodes) {
  std::vector<float> some;
  if (all.empty()) return some;
  some.reserve(all.size() / count * nodes.size());
  for (std::size_t row = 0; row < all.size(); row += size * count)
    for (const std::int32_t node : nodes) {
      const float* const values = &all[row + size * static_cast<std::size_t>(node)];
      some.insert(some.end(), values, values + size);
    }
  return some;
}

}  // namespace

ContentId layout::contentHash(const std::string& scene_toml, std::vector<hdf5::ArrayInfo> arrays) {
  std::ranges::sort(arrays, {}, &hdf5::ArrayInfo::path);
  std::string text = fmt::format("scene_toml {}\n", ContentId::of(scene_toml).hex());
  for (const hdf5::ArrayInfo& array : arrays) {
    const std::string shape =
        array.shape.empty() ? "scalar" : fmt::format("{}", fmt::join(array.shape, "x"));
    text += fmt::format("{} {} {} {}\n", array.path, hdf5::typeOf(array.element).name, shape,
                        array.hash.hex());
  }
  return ContentId::of(text);
}

ContentId verifiedContent(const std::filesystem::path& file) {
  Reader in(file);
  readMesh(in, sceneIn(in, openedText(in, file.string()), file.string()));
  for (const hdf5::ArrayInfo& array : in.arrays()) in.verify(array);
  return idIn(in, layout::content_attribute);
}

/// The open file, for data that is read on demand.
struct Dataset::Input {
  Reader in;
  std::optional<FieldsReader> fields;  ///< reads from `in`

  explicit Input(const std::filesystem::path& file) : in(file) {}
};

Dataset::Dataset(const std::filesystem::path& file)
    : file_(file), input_(std::make_unique<Input>(file)) {
  Reader& in = input_->in;
  scene_toml_ = openedText(in, file.string());
  scene_ = sceneIn(in, scene_toml_, file.string());
  body_ = readMesh(in, scene_);
  spaces_ = readSpaces(in, scene_, body_.mesh);
  input_->fields.emplace(in, scene_, body_.mesh, spaces_);
  probe_places_ = splitOff(spaces_);
  PALPATE_ASSERT(spaces_.size() + probe_places_.size() == scene_.active.size(),
                 "each active node of the scene needs a space or a probe");
  for (SpaceTable& space : spaces_) {
    space.max_force = scene_.workspace.max_force;
    space.has_fibers = hasFibers(scene_.regions);
  }
  content_id_ = idIn(in, layout::content_attribute);
  build_id_ = idIn(in, layout::build_attribute);
  partial_ = in.hasAttribute(layout::partial_attribute);
  kernel_family_ = in.text(layout::kernel_attribute);
}

Dataset::~Dataset() = default;
Dataset::Dataset(Dataset&&) noexcept = default;
Dataset& Dataset::operator=(Dataset&&) noexcept = default;

NodalFields Dataset::fields(std::size_t space, std::int32_t point) const {
  const SpaceTable& table = spaces_.at(space);
  const PointRecord& record = table.points.at(static_cast<std::size_t>(point));
  if (!isSolved(record.tag))
    throw badInput("{}: lattice point {} of {} is {} and has no nodal fields", file_.string(),
                   point, table.patch.name, name(record.tag));
  NodalFields kept = input_->fields->read(space, table, static_cast<std::size_t>(point), 1);
  PALPATE_ASSERT(kept.displacement.size() == 3 * body_.stored.size(),
                 "each stored node must have a displacement");
  return kept;
}

NodalFields Dataset::surfaceFields(std::size_t space) const {
  const std::vector<std::int32_t>&surface = body_.surface, &stored = body_.stored;
  const SpaceTable& table = spaces_.at(space);
  const std::size_t n_points = table.points.size();
  NodalFields all = input_->fields->read(space, table, 0, n_points);
  if (surface.size() == stored.size() && all.pressure.empty()) return all;
  PALPATE_ASSERT(stored.size() == body_.mesh.nodes.size(), "the dataset must store all nodes");
  return {rowsOfNodes(all.displacement, stored.size(), 3, surface),
          rowsOfNodes(all.pressure, all.pressure.size() / n_points, 1, surface)};
}

const std::vector<hdf5::ArrayInfo>& Dataset::arrays() const { return input_->in.arrays(); }

void Dataset::verifyAll() const {
  for (const hdf5::ArrayInfo& array : arrays()) input_->in.verify(array);
}

void warnIfPartial(const Dataset& dataset) {
  if (!dataset.isPartial()) return;
  std::size_t points = 0;
  std::ptrdiff_t unknown = 0;
  for (const SpaceTable& space : dataset.spaces()) {
    points += space.points.size();
    unknown += std::ranges::count(space.points, Tag::unknown, &PointRecord::tag);
  }
  spdlog::warn(
      "{}: this dataset is partial, because it was sealed before its build was complete: {} of {} "
      "points are unknown, and there is no force around them",
      dataset.file().string(), unknown, points);
}

}  // namespace palpate
