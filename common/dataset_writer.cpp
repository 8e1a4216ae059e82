#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <limits>
#include <span>

#include "common/dataset.hpp"
#include "common/dataset_layout.hpp"
#include "common/hdf5_writer.hpp"
#include "common/program.hpp"

namespace palpate {
namespace {

using hdf5::Shape;

template <class T>
std::span<const T> spanOf(const std::vector<T>& values) {
  return values;
}

/// Collects one value per record: columns of a table of structs.
template <class T, class Record, class Value>
std::vector<T> column(const std::vector<Record>& records, Value value) {
  std::vector<T> values;
  values.reserve(records.size());
  for (const Record& record : records) values.push_back(static_cast<T>(value(record)));
  return values;
}

/// Whether version 1.0 of the format has a place for everything.
bool isPlain(const Problem& problem) {
  const auto rigid = [](const ActivePatch& patch) { return patch.weights.empty(); };
  return problem.mesh.edges.empty() && std::all_of(problem.active.begin(), problem.active.end(), rigid);
}

/// Groups, attributes and arrays of one dataset file, in a fixed order.
class SealWriter {
 public:
  SealWriter(const std::filesystem::path& file, const Problem& problem)
      : file_(file.string()), problem_(problem), lattice_(uniformLattice(problem.scene)), out_(file) {}

  void writeMesh() {
    out_.makeGroup("/mesh");
    const Mesh& mesh = problem_.mesh;
    std::vector<double> points;
    for (const Eigen::Vector3d& node : mesh.nodes) points.insert(points.end(), node.begin(), node.end());
    out_.write<double>("/mesh/points", {mesh.nodes.size(), 3}, points, "m");
    writeTuples("/mesh/tetrahedra", mesh.tetrahedra);
    writeTuples("/mesh/surface", mesh.surface);
    if (!mesh.edges.empty()) writeTuples("/mesh/edges", mesh.edges);
    out_.write("/mesh/fixed_nodes", {problem_.fixed.size()}, spanOf(problem_.fixed), "1");
  }

  void writeLattice() {
    out_.makeGroup("/lattice");
    out_.setNumber("/lattice", "radius", lattice_.radius());
    out_.setNumber("/lattice", "spacing", lattice_.spacing());
    std::vector<std::int32_t> ijk;
    std::vector<double> positions;
    for (std::int32_t n = 0; n < lattice_.size(); ++n) {
      const LatticePoint& point = lattice_.point(n);
      const Eigen::Vector3d position = lattice_.displacement(n);
      ijk.insert(ijk.end(), point.begin(), point.end());
      positions.insert(positions.end(), position.begin(), position.end());
    }
    const auto n_points = static_cast<hsize_t>(lattice_.size());
    out_.write("/lattice/ijk", {n_points, 3}, spanOf(ijk), "1");
    out_.write("/lattice/position", {n_points, 3}, spanOf(positions), "m");
  }

  void writeSpace(const SpaceTable& space, const std::function<NodalFields(std::int32_t)>& fields) {
    out_.makeGroup("/spaces/" + space.patch.name);
    const std::vector<std::int32_t> active_node = {space.patch.node};
    writeColumn(space, "patch_nodes", space.patch.nodes, "1");
    if (!space.patch.weights.empty()) writeColumn(space, "patch_weights", space.patch.weights, "1");
    out_.write(layout::inSpace(space.patch.name, "active_node"), {}, spanOf(active_node), "1");
    writeTags(space);
    writeEquilibria(space);
    writeAttempts(space);
    writeFields(space, fields);
  }

  /// Attributes of the root, and the end of the file. Returns the content hash.
  ContentId finish(const std::string& kernel_family) {
    const std::string scene = resolvedToml(problem_.scene);
    const ContentId content = layout::contentHash(scene, out_.arrays());
    const std::array<std::int32_t, 2> version_numbers = {layout::major_version,
                                                         isPlain(problem_) ? 0 : layout::minor_version};
    out_.setText("/", "format", layout::format);
    out_.setIntegers("/", "format_version", version_numbers);
    out_.setText("/", "generator", std::string("palpate ") + version());
    out_.setText("/", "units", layout::units);
    out_.setText("/", "kernel_family", kernel_family);
    out_.setText("/", "scene_toml", scene);
    out_.setText("/", "build_id", problemId(problem_).hex());
    out_.setText("/", "content_hash", content.hex());
    out_.close();
    return content;
  }

  void makeSpacesGroup() { out_.makeGroup("/spaces"); }

 private:
  template <std::size_t n>
  void writeTuples(const std::string& path, const std::vector<std::array<std::int32_t, n>>& tuples) {
    std::vector<std::int32_t> values;
    for (const auto& tuple : tuples) values.insert(values.end(), tuple.begin(), tuple.end());
    out_.write(path, {tuples.size(), n}, spanOf(values), "1");
  }

  template <class T>
  void writeColumn(const SpaceTable& space, const char* array, const std::vector<T>& values,
                   const char* unit) {
    out_.write(layout::inSpace(space.patch.name, array), {values.size()}, spanOf(values), unit);
  }

  void writeTags(const SpaceTable& space) {
    const auto& points = space.points;
    writeColumn(space, "tag", column<std::uint8_t>(points, [](const PointRecord& p) { return p.tag; }), "1");
    writeColumn(space, "cause", column<std::uint8_t>(points, [](const PointRecord& p) { return p.cause; }),
                "1");
    writeColumn(space, "parent", column<std::int32_t>(points, [](const PointRecord& p) { return p.parent; }),
                "1");
    writeColumn(space, "newton_iterations",
                column<std::int32_t>(points, [](const PointRecord& p) { return p.cost.newton_iterations; }),
                "1");
    writeColumn(space, "factorizations",
                column<std::int32_t>(points, [](const PointRecord& p) { return p.cost.factorizations; }),
                "1");
    writeColumn(space, "steps",
                column<std::int32_t>(points, [](const PointRecord& p) { return p.cost.steps; }), "1");
  }

  void writeEquilibria(const SpaceTable& space) {
    const double none = std::numeric_limits<double>::quiet_NaN();
    std::vector<double> force, stiffness, energy, min_det_F, residual;
    std::vector<std::uint8_t> ids;
    for (const PointRecord& point : space.points) {
      const bool solved = isSolved(point.tag);
      const Equilibrium& e = point.equilibrium;
      for (int i = 0; i < 3; ++i) force.push_back(solved ? e.force[i] : none);
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) stiffness.push_back(solved ? e.stiffness(i, j) : none);
      energy.push_back(solved ? e.energy : none);
      min_det_F.push_back(solved ? e.min_det_F : none);
      residual.push_back(solved ? point.residual : none);
      const ContentId id = solved ? point.fields : ContentId();
      ids.insert(ids.end(), id.bytes().begin(), id.bytes().end());
    }
    const hsize_t n = space.points.size();
    const std::string& name = space.patch.name;
    out_.write(layout::inSpace(name, "force"), {n, 3}, spanOf(force), "N");
    out_.write(layout::inSpace(name, "stiffness"), {n, 3, 3}, spanOf(stiffness), "N/m");
    writeColumn(space, "energy", energy, "J");
    writeColumn(space, "min_det_F", min_det_F, "1");
    writeColumn(space, "residual", residual, "N");
    out_.write(layout::inSpace(name, "fields_id"), {n, 32}, spanOf(ids), "1");
  }

  void writeAttempts(const SpaceTable& space) {
    out_.makeGroup(layout::inSpace(space.patch.name, "attempts"));
    const auto integers = [&](const char* array, auto value) {
      writeColumn(space, array, column<std::int32_t>(space.attempts, value), "1");
    };
    const auto numbers = [&](const char* array, auto value, const char* unit) {
      writeColumn(space, array, column<double>(space.attempts, value), unit);
    };
    using Attempt = FailedAttempt;
    integers("attempts/target", [](const Attempt& a) { return a.target; });
    integers("attempts/parent", [](const Attempt& a) { return a.parent; });
    writeColumn(space, "attempts/cause",
                column<std::uint8_t>(space.attempts, [](const Attempt& a) { return a.failure.cause; }), "1");
    numbers(
        "attempts/step_reached", [](const Attempt& a) { return a.failure.step_reached; }, "1");
    numbers(
        "attempts/residual", [](const Attempt& a) { return a.failure.residual; }, "N");
    integers("attempts/element", [](const Attempt& a) { return a.failure.element; });
    numbers(
        "attempts/element_det_F", [](const Attempt& a) { return a.failure.element_det_F; }, "1");
    integers("attempts/negative_pivots", [](const Attempt& a) { return a.failure.negative_pivots; });
    integers("attempts/expected_negative_pivots",
             [](const Attempt& a) { return a.failure.expected_negative_pivots; });
    integers("attempts/mumps_infog1", [](const Attempt& a) { return a.failure.mumps_infog1; });
    integers("attempts/mumps_infog2", [](const Attempt& a) { return a.failure.mumps_infog2; });
  }

  void writeFields(const SpaceTable& space, const std::function<NodalFields(std::int32_t)>& fields) {
    const hsize_t n_points = space.points.size(), n_nodes = problem_.mesh.nodes.size();
    const hsize_t n_pressures = pressureNodes(problem_);
    hdf5::RowWriter displacement(out_, layout::inSpace(space.patch.name, "displacement"),
                                 {n_points, n_nodes, 3}, "m");
    std::optional<hdf5::RowWriter> pressure;
    if (n_pressures > 0)
      pressure.emplace(out_, layout::inSpace(space.patch.name, "pressure"), Shape{n_points, n_pressures},
                       "Pa");
    for (std::int32_t n = 0; n < space.lattice.size(); ++n) {
      if (!isSolved(space.points[n].tag)) {
        displacement.skip();
        if (pressure) pressure->skip();
        continue;
      }
      const NodalFields values = fields(n);
      if (values.id() != space.points[n].fields || values.pressure.size() != n_pressures)
        throw failure("{}: space {}: the nodal fields of lattice point {} are not those of its result", file_,
                      space.patch.name, n);
      displacement.write(values.displacement);
      if (pressure) pressure->write(values.pressure);
    }
    displacement.finish();
    if (pressure) pressure->finish();
  }

  std::string file_;
  const Problem& problem_;
  Lattice lattice_;
  hdf5::Writer out_;
};

void checkArguments(const std::string& file, const Problem& problem, const std::vector<SpaceTable>& spaces) {
  const Lattice expected = uniformLattice(problem.scene);
  if (spaces.size() != problem.active.size())
    throw failure("{}: {} spaces to seal for {} active nodes", file, spaces.size(), problem.active.size());
  for (std::size_t s = 0; s < spaces.size(); ++s) {
    const ActivePatch &given = spaces[s].patch, &active = problem.active[s];
    if (given.name != active.name || given.node != active.node || given.nodes != active.nodes ||
        given.weights != active.weights)
      throw failure("{}: space {} to seal is \"{}\", which is not active node \"{}\" of the problem", file, s,
                    given.name, active.name);
    const Lattice& lattice = spaces[s].lattice;
    if (lattice.radius() != expected.radius() || lattice.spacing() != expected.spacing() ||
        lattice.divisions() != expected.divisions() || lattice.uniformSize() != expected.size())
      throw failure(
          "{}: space \"{}\": its lattice (radius {} m, spacing {} m) is not that of the scene (radius {} m, "
          "spacing {} m)",
          file, given.name, lattice.radius(), lattice.spacing(), expected.radius(), expected.spacing());
    if (spaces[s].points.size() != static_cast<std::size_t>(lattice.size()))
      throw failure("{}: space \"{}\" has {} points, the lattice {}", file, given.name,
                    spaces[s].points.size(), lattice.size());
  }
}

ContentId writeDataset(const std::filesystem::path& file, const Problem& problem,
                       const std::vector<SpaceTable>& spaces, const std::string& kernel_family,
                       const FieldsSource& fields) {
  SealWriter writer(file, problem);
  writer.writeMesh();
  writer.writeLattice();
  writer.makeSpacesGroup();
  for (std::size_t s = 0; s < spaces.size(); ++s)
    writer.writeSpace(spaces[s], [&fields, s](std::int32_t point) { return fields(s, point); });
  return writer.finish(kernel_family);
}

void verifySealed(const std::filesystem::path& file, const ContentId& written) {
  const Dataset dataset(file);
  dataset.verifyAll();
  if (dataset.contentId() != written)
    throw failure("{}: reads back differently from what was written", file.string());
}

void syncToDisk(const std::filesystem::path& path, int flags) {
  const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC | flags);
  const bool synced = descriptor >= 0 && fsync(descriptor) == 0;
  const int reason = errno;
  if (descriptor >= 0) close(descriptor);
  if (!synced) throw failure("{}: cannot be flushed to disk: {}", path.string(), std::strerror(reason));
}

}  // namespace

void sealDataset(const std::filesystem::path& file, const Problem& problem,
                 const std::vector<SpaceTable>& spaces, const std::string& kernel_family,
                 const FieldsSource& fields) {
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored))
    throw badInput("{}: is a directory; give the dataset a file name", file.string());
  checkArguments(file.string(), problem, spaces);
  std::filesystem::path aside = file;
  aside += ".tmp";
  try {
    const ContentId content = writeDataset(aside, problem, spaces, kernel_family, fields);
    verifySealed(aside, content);
    syncToDisk(aside, 0);
    std::filesystem::rename(aside, file);
  } catch (const std::filesystem::filesystem_error& error) {
    std::filesystem::remove(aside, ignored);
    throw failure("{}: {}", file.string(), error.code().message());
  } catch (...) {
    std::filesystem::remove(aside, ignored);
    throw;
  }
  const std::filesystem::path folder = file.parent_path();
  syncToDisk(folder.empty() ? "." : folder, O_DIRECTORY);
}

}  // namespace palpate
