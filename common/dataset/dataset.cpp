#include "common/dataset/dataset.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <span>

#include "common/dataset/dataset_layout.hpp"
#include "common/dataset/hdf5_reader.hpp"
#include "common/problem/stored_fields.hpp"

namespace palpate {
namespace {

using hdf5::any_extent;
using hdf5::Reader;
using hdf5::Shape;

void refuseOtherFormats(const Reader& in, const std::string& file) {
  if (!in.hasAttribute("format") || !in.hasAttribute("format_version") ||
      in.text("format") != layout::format)
    throw badInput("{}: is an HDF5 file, but not a Palpate dataset (no attribute format = \"{}\")",
                   file, layout::format);
  const std::vector<std::int32_t> version = in.integers("format_version");
  if (version.size() != 2) throw in.damaged("format_version", "is not (major, minor)");
  if (version[0] > 0 && version[0] < layout::major_version)
    throw badInput(
        "{}: has format version {}.{}, which is no longer read; "
        "seal it again with `palpate build SCENE.toml --force`, "
        "which takes what was computed from the state directory",
        file, version[0], version[1]);
  if (version[0] != layout::major_version)
    throw badInput(
        "{}: has format version {}.{}, this program reads {}.x; use the program that made it: {}",
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

void checkIndices(const Reader& in, const std::string& path,
                  const std::vector<std::int32_t>& values, std::int32_t lowest, std::size_t end) {
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

std::vector<std::int32_t> readNodes(const Reader& in, const std::string& path,
                                    std::size_t n_nodes) {
  std::vector<std::int32_t> nodes = in.read<std::int32_t>(path, {any_extent});
  checkIndices(in, path, nodes, 0, n_nodes);
  if (!std::is_sorted(nodes.begin(), nodes.end())) throw in.damaged(path, "is not sorted");
  return nodes;
}

/// The middles of the edges are among the points, and must be those that the tetrahedra have.
void readMidEdgeNodes(const Reader& in, Mesh& mesh) {
  const std::vector<Edge> edges = readTuples<2>(in, "/mesh/edges", mesh.nodes.size());
  const std::vector<Eigen::Vector3d> points = mesh.nodes;
  if (edges.size() >= points.size())
    throw in.damaged("/mesh/edges", "has more edges than there are points");
  mesh.nodes.resize(points.size() - edges.size());
  for (const Tetrahedron& tetrahedron : mesh.tetrahedra)
    checkIndices(in, "/mesh/tetrahedra", {tetrahedron.begin(), tetrahedron.end()}, 0,
                 mesh.nodes.size());
  addMidEdgeNodes(mesh);
  if (mesh.edges != edges || mesh.nodes != points)
    throw in.damaged("/mesh/edges",
                     "are not those of the tetrahedra, or their middles are elsewhere");
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

/// Rows of a table that belong to one space.
struct Rows {
  std::size_t first, end;
  std::size_t size() const { return end - first; }
};

/// The part of a column of the file that belongs to one space.
template <class T>
std::vector<T> cut(const std::vector<T>& all, const Rows& rows) {
  const auto at = [&](std::size_t row) { return all.begin() + static_cast<std::ptrdiff_t>(row); };
  return {at(rows.first), at(rows.end)};
}

Tag tagOf(const Reader& in, const std::string& path, std::uint8_t value) {
  if (value > static_cast<std::uint8_t>(Tag::failed))
    throw in.damaged(path, fmt::format("holds {}", value));
  return static_cast<Tag>(value);
}

Cause causeOf(const Reader& in, const std::string& path, std::uint8_t value) {
  if (value > static_cast<std::uint8_t>(Cause::unreachable))
    throw in.damaged(path, fmt::format("holds {}, a cause this program does not know", value));
  return static_cast<Cause>(value);
}

/// What /points and /probes have in common.
std::vector<PointRecord> readRecords(const Reader& in, const std::string& group,
                                     std::size_t n_rows) {
  const auto bytes = [&](const char* array) {
    return in.read<std::uint8_t>(group + array, {n_rows});
  };
  const auto integers = [&](const char* array) {
    return in.read<std::int32_t>(group + array, {n_rows});
  };
  const auto numbers = [&](const char* array) { return in.read<double>(group + array, {n_rows}); };
  const auto tag = bytes("tag"), cause = bytes("cause");
  const auto parent = integers("parent"), iterations = integers("newton_iterations");
  const auto factorizations = integers("factorizations"), steps = integers("steps");
  const auto force = in.read<double>(group + "force", {n_rows, 3});
  const auto stiffness = in.read<double>(group + "stiffness", {n_rows, 3, 3});
  const auto energy = numbers("energy"), min_det_F = numbers("min_det_F"),
             residual = numbers("residual");
  const auto ids = in.read<std::uint8_t>(group + "fields_id", {n_rows, 32});
  std::vector<PointRecord> records(n_rows);
  for (std::size_t n = 0; n < n_rows; ++n) {
    PointRecord& record = records[n];
    record.tag = tagOf(in, group + "tag", tag[n]);
    record.cause = causeOf(in, group + "cause", cause[n]);
    record.parent = parent[n];
    record.cost = {iterations[n], factorizations[n], steps[n], 0};
    if (!isSolved(record.tag)) continue;
    Equilibrium& e = record.equilibrium;
    e.force = Eigen::Map<const Eigen::Vector3d>(&force[3 * n]);
    e.stiffness = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(&stiffness[9 * n]);
    e.energy = energy[n];
    e.min_det_F = min_det_F[n];
    record.residual = residual[n];
    record.fields = *ContentId::fromBytes({reinterpret_cast<const char*>(&ids[32 * n]), 32});
    if (!e.force.allFinite() || !e.stiffness.allFinite() || !std::isfinite(e.energy))
      throw in.damaged(group + "force",
                       fmt::format("row {} is solved, but has no finite force", n));
  }
  return records;
}

std::vector<FailedAttempt> readAttempts(const Reader& in) {
  const std::string cause_path = "/attempts/cause";
  const auto cause = in.read<std::uint8_t>(cause_path, {any_extent});
  const Shape shape = {cause.size()};
  const auto integers = [&](const char* array) {
    return in.read<std::int32_t>(std::string("/attempts/") + array, shape);
  };
  const auto numbers = [&](const char* array) {
    return in.read<double>(std::string("/attempts/") + array, shape);
  };
  const auto target = integers("target"), parent = integers("parent"),
             element = integers("element");
  const auto step_reached = numbers("step_reached"), residual = numbers("residual");
  const auto element_det_F = numbers("element_det_F");
  const auto pivots = integers("negative_pivots"),
             expected_pivots = integers("expected_negative_pivots");
  const auto infog1 = integers("mumps_infog1"), infog2 = integers("mumps_infog2");
  std::vector<FailedAttempt> attempts;
  for (std::size_t n = 0; n < cause.size(); ++n)
    attempts.push_back(
        {target[n], parent[n],
         Failure{causeOf(in, cause_path, cause[n]), step_reached[n], residual[n], element[n],
                 element_det_F[n], pivots[n], expected_pivots[n], infog1[n], infog2[n]}});
  return attempts;
}

/// Cuts the tables of a file, which hold the rows of all spaces, into spaces.
class SpacesReader {
 public:
  SpacesReader(const Reader& in, const Scene& scene, const Mesh& mesh)
      : in_(in), scene_(scene), n_nodes_(mesh.nodes.size()), n_spaces_(scene.active.size()) {}

  std::vector<SpaceTable> read() const {
    std::vector<SpaceTable> spaces(n_spaces_);
    checkNames();
    readPatches(spaces);
    readLattices(spaces);
    readRefinements(spaces);
    readProbes(spaces);
    readRbf(spaces);
    const auto attempts = readAttempts(in_);
    const auto attempts_of = rows("first_attempt", attempts.size());
    for (std::size_t s = 0; s < n_spaces_; ++s) {
      spaces[s].attempts = cut(attempts, attempts_of[s]);
      if (const std::string fault = faultOf(spaces[s]); !fault.empty())
        throw in_.damaged("space " + spaces[s].patch.name, fault);
    }
    return spaces;
  }

  /// Of the rows of /points.
  std::vector<Rows> pointRows() const {
    return rows("first_point",
                in_.array("/points/ijk", hdf5::Element::int32, {any_extent, 3}).shape[0]);
  }

 private:
  std::vector<Rows> rows(const char* array, std::size_t n_rows) const {
    const std::string path = std::string("/spaces/") + array;
    const auto firsts = in_.read<std::int32_t>(path, {n_spaces_ + 1});
    if (firsts.front() != 0 || !std::is_sorted(firsts.begin(), firsts.end()) ||
        static_cast<std::size_t>(firsts.back()) != n_rows)
      throw in_.damaged(path, fmt::format("does not divide {} rows", n_rows));
    std::vector<Rows> found;
    for (std::size_t s = 0; s < n_spaces_; ++s)
      found.push_back(
          {static_cast<std::size_t>(firsts[s]), static_cast<std::size_t>(firsts[s + 1])});
    return found;
  }

  void checkNames() const {
    const hdf5::ArrayInfo& info =
        in_.array("/spaces/name", hdf5::Element::uint8, {n_spaces_, any_extent});
    const std::size_t length = info.shape[1];
    const auto names = in_.read<std::uint8_t>(info.path, info.shape);
    for (std::size_t s = 0; s < n_spaces_; ++s) {
      std::string name(reinterpret_cast<const char*>(names.data()) + s * length, length);
      name.erase(name.find_last_not_of('\0') + 1);
      if (name != scene_.active[s].name)
        throw in_.damaged(info.path, "are not the active nodes of the scene");
    }
  }

  void readPatches(std::vector<SpaceTable>& spaces) const {
    const auto active = in_.read<std::int32_t>("/spaces/active_node", {n_spaces_});
    const auto nodes = in_.read<std::int32_t>("/patches/node", {any_extent});
    checkIndices(in_, "/patches/node", nodes, 0, n_nodes_);
    const auto patches = rows("first_patch_node", nodes.size());
    const auto isWeighted = [](const ActiveSelection& a) {
      return a.tool == ToolKind::weighted_average;
    };
    std::vector<double> weights;
    if (std::any_of(scene_.active.begin(), scene_.active.end(), isWeighted))
      weights = in_.read<double>("/patches/weight", {nodes.size()});
    for (std::size_t s = 0; s < n_spaces_; ++s) {
      ActivePatch& patch = spaces[s].patch;
      patch = {scene_.active[s].name, active[s], cut(nodes, patches[s])};
      if (isWeighted(scene_.active[s])) patch.weights = cut(weights, patches[s]);
      if (!std::is_sorted(patch.nodes.begin(), patch.nodes.end()))
        throw in_.damaged("/patches/node", fmt::format("those of {} are not sorted", patch.name));
      if (!std::binary_search(patch.nodes.begin(), patch.nodes.end(), patch.node))
        throw in_.damaged("/spaces/active_node",
                          fmt::format("{} is not in the patch of {}", patch.node, patch.name));
    }
  }

  void readLattices(std::vector<SpaceTable>& spaces) const {
    const std::vector<Rows> points_of = pointRows();
    const std::size_t n_rows = points_of.empty() ? 0 : points_of.back().end;
    const auto ijk = in_.read<std::int32_t>("/points/ijk", {n_rows, 3});
    const auto position = in_.read<double>("/points/position", {n_rows, 3});
    const std::vector<PointRecord> records = readRecords(in_, "/points/", n_rows);
    const Lattice uniform = uniformLattice(scene_);
    for (std::size_t s = 0; s < n_spaces_; ++s) {
      spaces[s].points = cut(records, points_of[s]);
      spaces[s].lattice = uniform;
      readLattice(spaces[s].lattice, {ijk.data() + 3 * points_of[s].first, 3 * points_of[s].size()},
                  {position.data() + 3 * points_of[s].first, 3 * points_of[s].size()});
    }
  }

  /// Compares the points of `lattice`, which is uniform, and adds the others.
  void readLattice(Lattice& lattice, std::span<const std::int32_t> ijk,
                   std::span<const double> position) const {
    const auto n_points = static_cast<std::int32_t>(ijk.size() / 3);
    if (n_points < lattice.size() || (lattice.divisions() == 1 && n_points > lattice.size()))
      throw in_.damaged("/points/ijk", "is not the lattice of the scene");
    for (std::int32_t n = 0; n < n_points; ++n) {
      const LatticePoint point = {ijk[3 * n], ijk[3 * n + 1], ijk[3 * n + 2]};
      if (n >= lattice.size() ? lattice.indexOf(point).has_value() : lattice.point(n) != point)
        throw in_.damaged("/points/ijk", "is not the lattice of the scene");
      if (n >= lattice.size()) lattice.add(point);
      const Eigen::Vector3d difference =
          lattice.displacement(n) -
          Eigen::Vector3d(position[3 * n], position[3 * n + 1], position[3 * n + 2]);
      if (!(difference.cwiseAbs().maxCoeff() <= 1e-9 * lattice.radius()))
        throw in_.damaged("/points/position", "is not the lattice of the scene");
    }
  }

  void readRefinements(std::vector<SpaceTable>& spaces) const {
    const auto level = in_.read<std::int32_t>("/splits/level", {any_extent});
    const auto lowest = in_.read<std::int32_t>("/splits/lowest", {level.size(), 3});
    const auto ends = in_.read<std::int32_t>("/inconsistent_edges", {any_extent, 2});
    const auto splits_of = rows("first_split", level.size()),
               edges_of = rows("first_edge", ends.size() / 2);
    for (std::size_t s = 0; s < n_spaces_; ++s) {
      for (std::size_t n = splits_of[s].first; n < splits_of[s].end; ++n)
        spaces[s].splits.push_back(
            {{lowest[3 * n], lowest[3 * n + 1], lowest[3 * n + 2]}, level[n]});
      for (std::size_t n = edges_of[s].first; n < edges_of[s].end; ++n)
        spaces[s].inconsistent_edges.push_back({ends[2 * n], ends[2 * n + 1]});
    }
  }

  void readProbes(std::vector<SpaceTable>& spaces) const {
    const auto position = in_.read<double>("/probes/position", {any_extent, 3});
    const std::vector<PointRecord> records = readRecords(in_, "/probes/", position.size() / 3);
    const auto probes_of = rows("first_probe", records.size());
    for (std::size_t s = 0; s < n_spaces_; ++s)
      for (std::size_t n = probes_of[s].first; n < probes_of[s].end; ++n)
        spaces[s].probes.push_back(
            {Eigen::Map<const Eigen::Vector3d>(&position[3 * n]), records[n]});
  }

  void readRbf(std::vector<SpaceTable>& spaces) const {
    const std::vector<Rows> points_of = pointRows();
    const auto condition = in_.read<double>("/rbf/condition", {n_spaces_, 4});
    const auto residual = in_.read<double>("/rbf/residual", {n_spaces_, 4});
    for (std::size_t kind = 0; kind < layout::rbf_paths.size(); ++kind) {
      const std::string path = layout::rbf_paths[kind];
      const std::size_t n_tail = layout::rbf_tail_rows[kind];
      const auto weights = in_.read<double>(path, {points_of.back().end, 3});
      std::vector<double> tails;
      if (n_tail > 0) tails = in_.read<double>(path + "_polynomial", {n_spaces_, n_tail, 3});
      for (std::size_t s = 0; s < n_spaces_; ++s) {
        if (std::isnan(residual[4 * s + kind])) continue;
        RbfWeights& rbf = spaces[s].rbf.emplace_back();
        rbf.kernel = kind < 2 ? RbfKernel::linear : RbfKernel::cubic;
        rbf.has_tail = n_tail > 0;
        rbf.condition = condition[4 * s + kind];
        rbf.residual = residual[4 * s + kind];
        rbf.weights = weightsOf(spaces[s], std::span(weights).subspan(3 * points_of[s].first));
        rbf.tail = Eigen::Map<const decltype(rbf.tail)>(
            tails.data() + 3 * n_tail * (n_tail > 0 ? s : 0), static_cast<Eigen::Index>(n_tail), 3);
        if (rbf.accurate() && !(rbf.weights.allFinite() && rbf.tail.allFinite()))
          throw in_.damaged(
              path, fmt::format("{} has weights that are not finite", spaces[s].patch.name));
      }
    }
    for (const SpaceTable& space : spaces)
      if (!space.rbf.empty() && space.rbf.size() != layout::rbf_paths.size())
        throw in_.damaged("/rbf/residual",
                          fmt::format("{} has some weights only", space.patch.name));
  }

  /// The rows of solved points.
  static decltype(RbfWeights::weights) weightsOf(const SpaceTable& space,
                                                 std::span<const double> rows) {
    std::vector<double> solved;
    for (std::size_t n = 0; n < space.points.size(); ++n)
      if (isSolved(space.points[n].tag))
        solved.insert(solved.end(), &rows[3 * n], &rows[3 * n] + 3);
    return Eigen::Map<const decltype(RbfWeights::weights)>(
        solved.data(), static_cast<Eigen::Index>(solved.size() / 3), 3);
  }

  const Reader& in_;
  const Scene& scene_;
  std::size_t n_nodes_, n_spaces_;
};

/// Reads rows of /points that hold nodal fields, and compares each with its hash.
class FieldsReader {
 public:
  FieldsReader(const Reader& in, const Scene& scene, const Mesh& mesh, std::size_t n_rows)
      : in_(&in),
        n_values_(3 * palpate::storedNodes(scene, mesh).size()),
        n_pressures_(storedPressures(scene, mesh)),
        quantized_(scene.storage.precision == StoredPrecision::int16) {
    in.array(path, quantized_ ? hdf5::Element::int16 : hdf5::Element::float32,
             {n_rows, n_values_ / 3, 3});
    if (n_pressures_ > 0) in.array(pressure_path, hdf5::Element::float32, {n_rows, n_pressures_});
    hashes_ = in.read<std::uint8_t>("/points/stored_id", {n_rows, 32});
    if (quantized_) steps_ = in.read<float>("/points/displacement_step", {n_rows});
  }

  std::size_t valuesPerRow() const { return n_values_; }

  /// `pressures` may be empty; else there is one row for each of `rows`. Rows of points that are
  /// not solved are NaN, and have nothing to compare.
  void read(const Rows& rows, const SpaceTable& space, std::size_t first_point,
            std::vector<float>& displacement, std::vector<float>& pressure) const {
    pressure.resize(rows.size() * n_pressures_);
    if (n_pressures_ > 0) in_->readRows<float>(in_->array(pressure_path), rows.first, pressure);
    displacement.resize(rows.size() * n_values_);
    std::vector<std::int16_t> integers(quantized_ ? displacement.size() : 0);
    if (quantized_)
      in_->readRows<std::int16_t>(in_->array(path), rows.first, integers);
    else
      in_->readRows<float>(in_->array(path), rows.first, displacement);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const std::span<float> values = std::span(displacement).subspan(i * n_values_, n_values_);
      if (!isSolved(space.points[first_point + i].tag)) {
        std::fill(values.begin(), values.end(), std::numeric_limits<float>::quiet_NaN());
        continue;
      }
      std::string_view stored = bytesOf(std::span<const float>(values));
      const float* step = nullptr;
      if (quantized_) {
        const std::span<const std::int16_t> row =
            std::span(integers).subspan(i * n_values_, n_values_);
        stored = bytesOf(row);
        step = &steps_[rows.first + i];
        std::transform(row.begin(), row.end(), values.begin(),
                       [step](std::int16_t q) { return *step * q; });
      }
      check(rows.first + i, space, first_point + i,
            layout::rowHash(stored, step,
                            std::span(pressure).subspan(i * n_pressures_, n_pressures_)));
    }
  }

 private:
  static constexpr const char *path = "/points/displacement", *pressure_path = "/points/pressure";

  void check(std::size_t row, const SpaceTable& space, std::size_t point,
             const ContentId& hash) const {
    if (hash.bytes() != std::string_view(reinterpret_cast<const char*>(&hashes_[32 * row]), 32))
      throw in_->damaged(fmt::format("{} or pressure, row {} (point {} of {})", path, row, point,
                                     space.patch.name),
                         "does not match stored_id");
  }

  const Reader* in_;
  std::size_t n_values_, n_pressures_;
  bool quantized_;
  std::vector<std::uint8_t> hashes_;
  std::vector<float> steps_;
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
        surface(readNodes(in, "/mesh/surface_nodes", mesh.nodes.size())),
        stored(readNodes(in, "/mesh/stored_nodes", mesh.nodes.size())) {
    content_id = idIn(in, "content_hash");
    build_id = idIn(in, "build_id");
    kernel_family = in.text("kernel_family");
    if (layout::contentHash(scene_toml, in.arrays()) != content_id)
      throw in.damaged("content_hash", "does not match the scene and the hashes of the arrays");
    if (surface != palpate::surfaceNodes(mesh) || stored != palpate::storedNodes(scene, mesh))
      throw in.damaged("/mesh/surface_nodes or stored_nodes",
                       "are not those of the surface and the scene");
    const SpacesReader reader(in, scene, mesh);
    spaces = reader.read();
    points_of = reader.pointRows();
    fields.emplace(in, scene, mesh, points_of.back().end);
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
  std::vector<std::int32_t> fixed, surface, stored;
  std::vector<SpaceTable> spaces;
  std::vector<Rows> points_of;  ///< of every space, in /points
  std::optional<FieldsReader> fields;
  ContentId content_id, build_id;
  std::string kernel_family;
};

Dataset::Dataset(const std::filesystem::path& file) : impl_(std::make_unique<Impl>(file)) {}
Dataset::~Dataset() = default;
Dataset::Dataset(Dataset&&) noexcept = default;
Dataset& Dataset::operator=(Dataset&&) noexcept = default;

const std::filesystem::path& Dataset::file() const { return impl_->file; }
ContentId Dataset::contentId() const { return impl_->content_id; }
ContentId Dataset::buildId() const { return impl_->build_id; }
const std::string& Dataset::kernelFamily() const { return impl_->kernel_family; }
const std::string& Dataset::sceneToml() const { return impl_->scene_toml; }
const Scene& Dataset::scene() const { return impl_->scene; }
const Mesh& Dataset::mesh() const { return impl_->mesh; }
const std::vector<std::int32_t>& Dataset::fixedNodes() const { return impl_->fixed; }
const std::vector<SpaceTable>& Dataset::spaces() const { return impl_->spaces; }

const std::vector<std::int32_t>& Dataset::surfaceNodes() const { return impl_->surface; }
const std::vector<std::int32_t>& Dataset::storedNodes() const { return impl_->stored; }

std::size_t Dataset::spaceNamed(const std::string& name) const {
  std::string names;
  for (std::size_t s = 0; s < impl_->spaces.size(); ++s) {
    if (impl_->spaces[s].patch.name == name) return s;
    names += (s > 0 ? ", " : "") + impl_->spaces[s].patch.name;
  }
  throw badInput("{}: there is no active node \"{}\"; there are: {}", impl_->file.string(), name,
                 names);
}

NodalFields Dataset::fields(std::size_t space, std::int32_t point) const {
  const SpaceTable& table = impl_->spaces.at(space);
  const PointRecord& record = table.points.at(static_cast<std::size_t>(point));
  if (!isSolved(record.tag))
    throw badInput("{}: lattice point {} of {} is {}: it has no nodal fields", impl_->file.string(),
                   point, table.patch.name, name(record.tag));
  const std::size_t row = impl_->points_of.at(space).first + static_cast<std::size_t>(point);
  NodalFields fields;
  impl_->fields->read({row, row + 1}, table, static_cast<std::size_t>(point), fields.displacement,
                      fields.pressure);
  return fields;
}

std::vector<float> Dataset::surfaceDisplacements(std::size_t space) const {
  const std::vector<std::int32_t>&surface = impl_->surface, &stored = impl_->stored;
  std::vector<float> all, pressure;
  impl_->fields->read(impl_->points_of.at(space), impl_->spaces[space], 0, all, pressure);
  if (surface.size() == stored.size()) return all;
  std::vector<float> visible;
  visible.reserve(impl_->points_of[space].size() * 3 * surface.size());
  for (auto row = all.begin(); row != all.end();
       row += static_cast<std::ptrdiff_t>(3 * stored.size()))
    for (const std::int32_t node : surface)
      visible.insert(visible.end(), row + 3 * std::ptrdiff_t{node},
                     row + 3 * std::ptrdiff_t{node} + 3);
  return visible;
}

void Dataset::verifyAll() const {
  for (const hdf5::ArrayInfo& array : impl_->in.arrays()) impl_->in.verify(array);
}

}  // namespace palpate
