#include "common/dataset.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "common/dataset_layout.hpp"
#include "common/hdf5_reader.hpp"

namespace palpate {
namespace {

using hdf5::any_extent;
using hdf5::Reader;
using hdf5::Shape;

void refuseOtherFormats(const Reader& in, const std::string& file) {
  if (!in.hasAttribute("format") || !in.hasAttribute("format_version") || in.text("format") != layout::format)
    throw badInput("{}: is an HDF5 file, but not a Palpate dataset (no attribute format = \"{}\")", file,
                   layout::format);
  const std::vector<std::int32_t> version = in.integers("format_version");
  if (version.size() != 2) throw in.damaged("format_version", "is not (major, minor)");
  if (version[0] != layout::major_version)
    throw badInput("{}: has format version {}.{}, this program reads {}.x; use the program that made it: {}",
                   file, version[0], version[1], layout::major_version, in.text("generator"));
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
    throw in.damaged("scene_toml", error.what());
  }
}

void checkIndices(const Reader& in, const std::string& path, const std::vector<std::int32_t>& values,
                  std::int32_t lowest, std::size_t end) {
  for (const std::int32_t value : values)
    if (value < lowest || value >= static_cast<std::int64_t>(end))
      throw in.damaged(path, fmt::format("holds {}, which is not in {}..{}", value, lowest,
                                         static_cast<std::int64_t>(end) - 1));
}

template <std::size_t n>
std::vector<std::array<std::int32_t, n>> readTuples(const Reader& in, const std::string& path,
                                                    std::size_t n_nodes) {
  const std::vector<std::int32_t> flat = in.read<std::int32_t>(path, {any_extent, n});
  checkIndices(in, path, flat, 0, n_nodes);
  std::vector<std::array<std::int32_t, n>> tuples(flat.size() / n);
  std::memcpy(tuples.data(), flat.data(), flat.size() * sizeof(std::int32_t));
  return tuples;
}

std::vector<std::int32_t> readNodes(const Reader& in, const std::string& path, std::size_t n_nodes) {
  std::vector<std::int32_t> nodes = in.read<std::int32_t>(path, {any_extent});
  checkIndices(in, path, nodes, 0, n_nodes);
  if (!std::is_sorted(nodes.begin(), nodes.end())) throw in.damaged(path, "is not sorted");
  return nodes;
}

/// The middles of the edges are among the points, and must be those that the tetrahedra have.
void readMidEdgeNodes(const Reader& in, Mesh& mesh) {
  const std::vector<Edge> edges = readTuples<2>(in, "/mesh/edges", mesh.nodes.size());
  const std::vector<Eigen::Vector3d> points = mesh.nodes;
  if (edges.size() >= points.size()) throw in.damaged("/mesh/edges", "has more edges than there are points");
  mesh.nodes.resize(points.size() - edges.size());
  for (const Tetrahedron& tetrahedron : mesh.tetrahedra)
    checkIndices(in, "/mesh/tetrahedra", {tetrahedron.begin(), tetrahedron.end()}, 0, mesh.nodes.size());
  addMidEdgeNodes(mesh);
  if (mesh.edges != edges || mesh.nodes != points)
    throw in.damaged("/mesh/edges", "are not those of the tetrahedra, or their middles are elsewhere");
}

Mesh readMesh(const Reader& in, DisplacementSpace displacement) {
  Mesh mesh;
  const std::vector<double> points = in.read<double>("/mesh/points", {any_extent, 3});
  for (std::size_t n = 0; n + 3 <= points.size(); n += 3)
    mesh.nodes.emplace_back(points[n], points[n + 1], points[n + 2]);
  for (const double value : points)
    if (!std::isfinite(value)) throw in.damaged("/mesh/points", "holds a value that is not finite");
  mesh.tetrahedra = readTuples<4>(in, "/mesh/tetrahedra", mesh.nodes.size());
  if (displacement == DisplacementSpace::p2) readMidEdgeNodes(in, mesh);
  mesh.surface = readTuples<3>(in, "/mesh/surface", mesh.vertices());
  return mesh;
}

Lattice readLattice(const Reader& in, const Scene& scene) {
  Lattice lattice = uniformLattice(scene);
  const auto n_points = static_cast<hsize_t>(lattice.size());
  const auto ijk = in.read<std::int32_t>("/lattice/ijk", {n_points, 3});
  const auto position = in.read<double>("/lattice/position", {n_points, 3});
  for (std::int32_t n = 0; n < lattice.size(); ++n) {
    const Eigen::Vector3d expected = lattice.displacement(n);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (ijk[3 * n + axis] != lattice.point(n)[axis])
        throw in.damaged("/lattice/ijk", "is not the lattice of the scene");
      if (!(std::abs(position[3 * n + axis] - expected[static_cast<Eigen::Index>(axis)]) <=
            1e-9 * lattice.radius()))
        throw in.damaged("/lattice/position", "is not the lattice of the scene");
    }
  }
  return lattice;
}

/// Reads the arrays of one configuration space.
class SpaceReader {
 public:
  SpaceReader(const Reader& in, const ActiveSelection& active, const Lattice& lattice, std::size_t n_nodes)
      : in_(in),
        name_(active.name),
        tool_(active.tool),
        lattice_(lattice),
        n_points_(static_cast<std::size_t>(lattice.size())),
        n_nodes_(n_nodes) {}

  SpaceTable read() const {
    SpaceTable space;
    space.patch = readPatch();
    space.lattice = lattice_;
    space.points.resize(n_points_);
    readTags(space.points);
    readEquilibria(space.points);
    space.attempts = readAttempts();
    return space;
  }

  void checkFields(std::size_t n_pressures) const {
    in_.array(at("displacement"), hdf5::Element::float32, {n_points_, n_nodes_, 3});
    if (n_pressures > 0) in_.array(at("pressure"), hdf5::Element::float32, {n_points_, n_pressures});
  }

 private:
  std::string at(const char* array) const { return layout::inSpace(name_, array); }

  template <class T>
  std::vector<T> column(const char* array) const {
    return in_.read<T>(at(array), {n_points_});
  }

  ActivePatch readPatch() const {
    ActivePatch patch;
    patch.name = name_;
    patch.nodes = readNodes(in_, at("patch_nodes"), n_nodes_);
    patch.node = in_.read<std::int32_t>(at("active_node"), {}).at(0);
    if (!std::binary_search(patch.nodes.begin(), patch.nodes.end(), patch.node))
      throw in_.damaged(at("active_node"), "is not one of patch_nodes");
    if (tool_ == ToolKind::weighted_average)
      patch.weights = in_.read<double>(at("patch_weights"), {patch.nodes.size()});
    return patch;
  }

  Tag tagOf(std::uint8_t value) const {
    if (value > static_cast<std::uint8_t>(Tag::failed))
      throw in_.damaged(at("tag"), fmt::format("holds {}", value));
    return static_cast<Tag>(value);
  }

  Cause causeOf(const char* array, std::uint8_t value) const {
    if (value > static_cast<std::uint8_t>(Cause::unreachable))
      throw in_.damaged(at(array), fmt::format("holds {}, a cause this program does not know", value));
    return static_cast<Cause>(value);
  }

  void readTags(std::vector<PointRecord>& points) const {
    const auto tag = column<std::uint8_t>("tag"), cause = column<std::uint8_t>("cause");
    const auto parent = column<std::int32_t>("parent");
    const auto iterations = column<std::int32_t>("newton_iterations");
    const auto factorizations = column<std::int32_t>("factorizations"), steps = column<std::int32_t>("steps");
    checkIndices(in_, at("parent"), parent, -1, n_points_);
    for (std::size_t n = 0; n < points.size(); ++n) {
      points[n].tag = tagOf(tag[n]);
      points[n].cause = causeOf("cause", cause[n]);
      points[n].parent = parent[n];
      points[n].cost = {iterations[n], factorizations[n], steps[n], 0};
    }
  }

  void readEquilibria(std::vector<PointRecord>& points) const {
    const auto force = in_.read<double>(at("force"), {n_points_, 3});
    const auto stiffness = in_.read<double>(at("stiffness"), {n_points_, 3, 3});
    const auto energy = column<double>("energy"), min_det_F = column<double>("min_det_F");
    const auto residual = column<double>("residual");
    const auto ids = in_.read<std::uint8_t>(at("fields_id"), {n_points_, 32});
    for (std::size_t n = 0; n < points.size(); ++n) {
      if (!isSolved(points[n].tag)) continue;
      Equilibrium& e = points[n].equilibrium;
      e.force = Eigen::Map<const Eigen::Vector3d>(&force[3 * n]);
      e.stiffness = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(&stiffness[9 * n]);
      e.energy = energy[n];
      e.min_det_F = min_det_F[n];
      points[n].residual = residual[n];
      points[n].fields = *ContentId::fromBytes({reinterpret_cast<const char*>(&ids[32 * n]), 32});
      if (!e.force.allFinite() || !e.stiffness.allFinite() || !std::isfinite(e.energy))
        throw in_.damaged("/spaces/" + name_,
                          fmt::format("lattice point {} is solved, but has no finite force", n));
    }
  }

  std::vector<FailedAttempt> readAttempts() const {
    const auto target = in_.read<std::int32_t>(at("attempts/target"), {any_extent});
    const Shape shape = {target.size()};
    const auto integers = [&](const char* array) { return in_.read<std::int32_t>(at(array), shape); };
    const auto numbers = [&](const char* array) { return in_.read<double>(at(array), shape); };
    const auto parent = integers("attempts/parent"), element = integers("attempts/element");
    const auto cause = in_.read<std::uint8_t>(at("attempts/cause"), shape);
    const auto step_reached = numbers("attempts/step_reached"), residual = numbers("attempts/residual");
    const auto element_det_F = numbers("attempts/element_det_F");
    const auto pivots = integers("attempts/negative_pivots");
    const auto expected_pivots = integers("attempts/expected_negative_pivots");
    const auto infog1 = integers("attempts/mumps_infog1"), infog2 = integers("attempts/mumps_infog2");
    checkIndices(in_, at("attempts/target"), target, 0, n_points_);
    checkIndices(in_, at("attempts/parent"), parent, 0, n_points_);
    std::vector<FailedAttempt> attempts;
    for (std::size_t n = 0; n < target.size(); ++n)
      attempts.push_back(
          {target[n], parent[n],
           Failure{causeOf("attempts/cause", cause[n]), step_reached[n], residual[n], element[n],
                   element_det_F[n], pivots[n], expected_pivots[n], infog1[n], infog2[n]}});
    return attempts;
  }

  const Reader& in_;
  std::string name_;
  ToolKind tool_;
  const Lattice& lattice_;
  std::size_t n_points_, n_nodes_;
};

}  // namespace

struct Dataset::Impl {
  explicit Impl(const std::filesystem::path& path)
      : file(path),
        in(path),
        scene_toml(openedText()),
        scene(sceneIn(in, scene_toml, path.string())),
        mesh(readMesh(in, scene.discretization.displacement)),
        fixed(readNodes(in, "/mesh/fixed_nodes", mesh.nodes.size())),
        lattice(readLattice(in, scene)) {
    content_id = idIn(in, "content_hash");
    build_id = idIn(in, "build_id");
    kernel_family = in.text("kernel_family");
    if (layout::contentHash(scene_toml, in.arrays()) != content_id)
      throw in.damaged("content_hash", "does not match the scene and the hashes of the arrays");
    if (in.groupsIn("/spaces").size() != scene.active.size())
      throw in.damaged("/spaces", "are not the active nodes of the scene");
    for (const ActiveSelection& active : scene.active) {
      const SpaceReader reader(in, active, lattice, mesh.nodes.size());
      reader.checkFields(pressureNodes(scene.discretization.pressure, mesh));
      spaces.push_back(reader.read());
    }
  }

  std::string openedText() {
    refuseOtherFormats(in, file.string());
    in.findArrays();
    return in.text("scene_toml");
  }

  std::filesystem::path file;
  Reader in;
  std::string scene_toml;
  Scene scene;
  Mesh mesh;
  std::vector<std::int32_t> fixed;
  Lattice lattice;
  std::vector<SpaceTable> spaces;
  ContentId content_id, build_id;
  std::string kernel_family;
};

Dataset::Dataset(const std::filesystem::path& file) : impl_(std::make_unique<Impl>(file)) {}
Dataset::~Dataset() = default;
Dataset::Dataset(Dataset&&) noexcept = default;
Dataset& Dataset::operator=(Dataset&&) noexcept = default;

const std::filesystem::path& Dataset::file() const {
  return impl_->file;
}
ContentId Dataset::contentId() const {
  return impl_->content_id;
}
ContentId Dataset::buildId() const {
  return impl_->build_id;
}
const std::string& Dataset::kernelFamily() const {
  return impl_->kernel_family;
}
const std::string& Dataset::sceneToml() const {
  return impl_->scene_toml;
}
const Scene& Dataset::scene() const {
  return impl_->scene;
}
const Mesh& Dataset::mesh() const {
  return impl_->mesh;
}
const std::vector<std::int32_t>& Dataset::fixedNodes() const {
  return impl_->fixed;
}
const std::vector<SpaceTable>& Dataset::spaces() const {
  return impl_->spaces;
}

std::size_t Dataset::spaceNamed(const std::string& name) const {
  std::string names;
  for (std::size_t s = 0; s < impl_->spaces.size(); ++s) {
    if (impl_->spaces[s].patch.name == name) return s;
    names += (s > 0 ? ", " : "") + impl_->spaces[s].patch.name;
  }
  throw badInput("{}: there is no active node \"{}\"; there are: {}", impl_->file.string(), name, names);
}

NodalFields Dataset::fields(std::size_t space, std::int32_t point) const {
  const SpaceTable& table = impl_->spaces.at(space);
  const PointRecord& record = table.points.at(static_cast<std::size_t>(point));
  if (!isSolved(record.tag))
    throw badInput("{}: lattice point {} of {} is {}: it has no nodal fields", impl_->file.string(), point,
                   table.patch.name, name(record.tag));
  const auto row = static_cast<std::size_t>(point);
  const std::string displacement = layout::inSpace(table.patch.name, "displacement");
  NodalFields fields;
  fields.displacement.resize(3 * impl_->mesh.nodes.size());
  impl_->in.readRow(impl_->in.array(displacement), row, fields.displacement);
  fields.pressure.resize(pressureNodes(impl_->scene.discretization.pressure, impl_->mesh));
  if (!fields.pressure.empty()) {
    impl_->in.readRow(impl_->in.array(layout::inSpace(table.patch.name, "pressure")), row, fields.pressure);
  }
  if (fields.id() != record.fields)
    throw impl_->in.damaged(fmt::format("{} or pressure, row {}", displacement, point),
                            "does not match fields_id");
  return fields;
}

void Dataset::verifyAll() const {
  for (const hdf5::ArrayInfo& array : impl_->in.arrays()) impl_->in.verify(array);
}

}  // namespace palpate
