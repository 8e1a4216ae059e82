#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "common/base/program.hpp"
#include "common/base/replaced_file.hpp"
#include "common/dataset/dataset.hpp"
#include "common/dataset/dataset_layout.hpp"
#include "common/dataset/hdf5_writer.hpp"
#include "common/interpolation/branch_check.hpp"
#include "common/interpolation/rbf_weights.hpp"
#include "common/problem/stored_fields.hpp"

namespace palpate {
namespace {

using hdf5::Shape;

/// Stands where a point that is not solved has no number.
constexpr double no_number = std::numeric_limits<double>::quiet_NaN();

template <class T>
std::span<const T> spanOf(const std::vector<T>& values) {
  return values;
}

/// The record of a row of /points or /probes.
const PointRecord& recordOf(const PointRecord& point) { return point; }
const PointRecord& recordOf(const Probe& probe) { return probe.record; }

/// Writes the rows of /points that hold nodal fields, in order.
class FieldsWriter {
 public:
  FieldsWriter(hdf5::Writer& out, const Problem& problem, hsize_t n_rows)
      : out_(out), stored_(storedNodes(problem.scene, problem.mesh)) {
    const Shape shape = {n_rows, stored_.size(), 3};
    if (problem.scene.storage.precision == StoredPrecision::int16)
      integers_.emplace(out, displacement_path, shape, "1");
    else
      floats_.emplace(out, displacement_path, shape, "m");
    const hsize_t n_pressures = storedPressures(problem.scene, problem.mesh);
    if (n_pressures > 0)
      pressures_.emplace(out, "/points/pressure", Shape{n_rows, n_pressures}, "Pa");
  }

  void write(const NodalFields& fields) {
    std::vector<float> displacement;
    for (const std::int32_t node : stored_) {
      const float* const u = &fields.displacement[3 * static_cast<std::size_t>(node)];
      displacement.insert(displacement.end(), u, u + 3);
    }
    const std::span<const float> pressure =
        pressures_ ? spanOf(fields.pressure) : std::span<const float>();
    if (pressures_) pressures_->write(pressure);
    if (floats_) {
      floats_->write(displacement);
      addHash(layout::rowHash(bytesOf(spanOf(displacement)), nullptr, pressure));
    } else {
      const layout::Quantized quantized = layout::quantize(displacement);
      integers_->write(quantized.values);
      steps_.push_back(quantized.step);
      addHash(layout::rowHash(bytesOf(spanOf(quantized.values)), &steps_.back(), pressure));
    }
  }

  void skip() {
    if (floats_) floats_->skip();
    if (integers_) integers_->skip();
    if (integers_) steps_.push_back(std::numeric_limits<float>::quiet_NaN());
    if (pressures_) pressures_->skip();
    addHash(ContentId());
  }

  void finish() {
    if (floats_) floats_->finish();
    if (pressures_) pressures_->finish();
    out_.write("/points/stored_id", {hashes_.size() / 32, 32}, spanOf(hashes_), "1");
    if (!integers_) return;
    integers_->finish();
    out_.write("/points/displacement_step", {steps_.size()}, spanOf(steps_), "m");
    float largest = 0;
    for (const float step : steps_) largest = std::fmax(largest, step);  // not those that are NaN
    out_.setNumber(displacement_path, "error_bound", layout::quantization_error * largest);
  }

 private:
  static constexpr const char* displacement_path = "/points/displacement";

  void addHash(const ContentId& hash) {
    hashes_.insert(hashes_.end(), hash.bytes().begin(), hash.bytes().end());
  }

  hdf5::Writer& out_;
  std::vector<std::int32_t> stored_;
  std::optional<hdf5::RowWriter<float>> floats_, pressures_;
  std::optional<hdf5::RowWriter<std::int16_t>> integers_;
  std::vector<float> steps_;
  std::vector<std::uint8_t> hashes_;
};

/// Groups, attributes and arrays of one dataset file, in a fixed order. Tables have the rows of all
/// spaces one after the other: opening costs time per array.
class SealWriter {
 public:
  SealWriter(const std::filesystem::path& file, const Problem& problem,
             const std::vector<SpaceTable>& spaces)
      : file_(file.string()), problem_(problem), spaces_(spaces), out_(file) {}

  void writeMesh() {
    out_.makeGroup("/mesh");
    const Mesh& mesh = problem_.mesh;
    std::vector<double> points;
    for (const Eigen::Vector3d& node : mesh.nodes)
      points.insert(points.end(), node.begin(), node.end());
    out_.write<double>("/mesh/points", {mesh.nodes.size(), 3}, points, "m");
    writeTuples("/mesh/tetrahedra", mesh.tetrahedra);
    writeTuples("/mesh/surface", mesh.surface);
    if (!mesh.edges.empty()) writeTuples("/mesh/edges", mesh.edges);
    writeList("/mesh/fixed_nodes", problem_.fixed);
    writeList("/mesh/surface_nodes", surfaceNodes(mesh));
    writeList("/mesh/stored_nodes", storedNodes(problem_.scene, mesh));
  }

  void writeSpaces() {
    out_.makeGroup("/spaces");
    std::vector<std::int32_t> nodes;
    for (const SpaceTable& space : spaces_) nodes.push_back(space.patch.node);
    writeNames();
    writeList("/spaces/active_node", nodes);
    writeFirsts("/spaces/first_patch_node",
                [](const SpaceTable& space) { return space.patch.nodes.size(); });
    writeFirsts("/spaces/first_point", [](const SpaceTable& space) { return space.points.size(); });
    writeFirsts("/spaces/first_split", [](const SpaceTable& space) { return space.splits.size(); });
    writeFirsts("/spaces/first_edge",
                [](const SpaceTable& space) { return space.inconsistent_edges.size(); });
    writeFirsts("/spaces/first_probe", [](const SpaceTable& space) { return space.probes.size(); });
    writeFirsts("/spaces/first_attempt",
                [](const SpaceTable& space) { return space.attempts.size(); });
    writePatches();
    writeSplits();
    writeAttempts();
    const auto ends = [](auto& row, const LatticeEdge& edge) {
      row.insert(row.end(), {edge.a, edge.b});
    };
    writeRows<std::int32_t>("/inconsistent_edges", {2}, "1", &SpaceTable::inconsistent_edges, ends);
  }

  void writePoints() {
    out_.makeGroup("/points");
    const Lattice& lattice = spaces_.front().lattice;
    out_.setNumber("/points", "radius", lattice.radius());
    out_.setNumber("/points", "spacing", lattice.spacing());
    out_.setNumber("/points", "divisions", lattice.divisions());
    std::vector<std::int32_t> ijk;
    std::vector<double> positions;
    for (const SpaceTable& space : spaces_)
      for (std::int32_t n = 0; n < space.lattice.size(); ++n) {
        const LatticePoint& point = space.lattice.point(n);
        const Eigen::Vector3d position = space.lattice.displacement(n);
        ijk.insert(ijk.end(), point.begin(), point.end());
        positions.insert(positions.end(), position.begin(), position.end());
      }
    out_.write("/points/ijk", {ijk.size() / 3, 3}, spanOf(ijk), "1");
    out_.write("/points/position", {ijk.size() / 3, 3}, spanOf(positions), "m");
    writeRecords("/points/", &SpaceTable::points);
  }

  void writeProbes() {
    out_.makeGroup("/probes");
    const auto position = [](auto& row, const Probe& probe) {
      row.insert(row.end(), probe.displacement.begin(), probe.displacement.end());
    };
    writeRows<double>("/probes/position", {3}, "m", &SpaceTable::probes, position);
    writeRecords("/probes/", &SpaceTable::probes);
  }

  void writeRbf() {
    out_.makeGroup("/rbf");
    std::vector<double> condition, residual;
    for (const SpaceTable& space : spaces_)
      for (std::size_t k = 0; k < layout::rbf_paths.size(); ++k) {
        condition.push_back(space.rbf.empty() ? no_number : space.rbf[k].condition);
        residual.push_back(space.rbf.empty() ? no_number : space.rbf[k].residual);
      }
    out_.write("/rbf/condition", {spaces_.size(), 4}, spanOf(condition), "1");
    out_.write("/rbf/residual", {spaces_.size(), 4}, spanOf(residual), "1");
    for (std::size_t k = 0; k < layout::rbf_paths.size(); ++k) writeRbf(k);
  }

  void writeFields(const FieldsSource& fields) {
    std::size_t n_rows = 0;
    for (const SpaceTable& space : spaces_) n_rows += space.points.size();
    FieldsWriter rows(out_, problem_, n_rows);
    for (std::size_t s = 0; s < spaces_.size(); ++s)
      for (std::size_t n = 0; n < spaces_[s].points.size(); ++n) {
        const PointRecord& point = spaces_[s].points[n];
        if (!isSolved(point.tag)) {
          rows.skip();
          continue;
        }
        const NodalFields values = fields(s, static_cast<std::int32_t>(n));
        if (values.id() != point.fields ||
            values.displacement.size() != 3 * problem_.mesh.nodes.size() ||
            values.pressure.size() != pressureNodes(problem_))
          throw failure(
              "{}: space {}: the nodal fields of lattice point {} are not those of its result",
              file_, spaces_[s].patch.name, n);
        rows.write(values);
      }
    rows.finish();
  }

  /// Attributes of the root, and the end of the file. Returns the content hash.
  ContentId finish(const std::string& kernel_family) {
    const std::string scene = resolvedToml(problem_.scene);
    const ContentId content = layout::contentHash(scene, out_.arrays());
    const std::array<std::int32_t, 2> version_numbers = {layout::major_version,
                                                         layout::minor_version};
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

 private:
  template <std::size_t n>
  void writeTuples(const std::string& path,
                   const std::vector<std::array<std::int32_t, n>>& tuples) {
    std::vector<std::int32_t> values;
    for (const auto& tuple : tuples) values.insert(values.end(), tuple.begin(), tuple.end());
    out_.write(path, {tuples.size(), n}, spanOf(values), "1");
  }

  void writeList(const std::string& path, const std::vector<std::int32_t>& values) {
    out_.write(path, {values.size()}, spanOf(values), "1");
  }

  /// One array over the records of all spaces; `append` adds the numbers of one, `row` is their
  /// shape.
  template <class T, class Record, class Append>
  void writeRows(const std::string& path, const Shape& row, const char* unit,
                 std::vector<Record> SpaceTable::*records, Append append) {
    std::vector<T> values;
    Shape shape = {0};
    for (const SpaceTable& space : spaces_) {
      shape[0] += (space.*records).size();
      for (const Record& record : space.*records) append(values, record);
    }
    shape.insert(shape.end(), row.begin(), row.end());
    out_.write(path, shape, spanOf(values), unit);
  }

  /// The same for one number each.
  template <class T, class Record, class Value>
  void writeColumn(const std::string& path, const char* unit,
                   std::vector<Record> SpaceTable::*records, Value value) {
    writeRows<T>(path, {}, unit, records, [&](std::vector<T>& values, const Record& record) {
      values.push_back(static_cast<T>(value(record)));
    });
  }

  /// Where the rows of each space begin, and at the end how many there are.
  template <class Count>
  void writeFirsts(const std::string& path, Count count) {
    std::vector<std::int32_t> firsts = {0};
    std::size_t total = 0;
    for (const SpaceTable& space : spaces_) {
      total += count(space);
      if (total > std::numeric_limits<std::int32_t>::max())
        throw failure("{}: {}: more rows than a dataset has numbers for", file_, path);
      firsts.push_back(static_cast<std::int32_t>(total));
    }
    writeList(path, firsts);
  }

  void writeNames() {
    std::size_t length = 1;
    for (const SpaceTable& space : spaces_) length = std::max(length, space.patch.name.size());
    std::vector<std::uint8_t> names;
    for (const SpaceTable& space : spaces_) {
      names.insert(names.end(), space.patch.name.begin(), space.patch.name.end());
      names.insert(names.end(), length - space.patch.name.size(), 0);
    }
    out_.write("/spaces/name", {spaces_.size(), length}, spanOf(names), "1");
  }

  void writePatches() {
    std::vector<std::int32_t> nodes;
    std::vector<double> weights;
    bool is_weighted = false;
    for (const SpaceTable& space : spaces_) {
      const ActivePatch& patch = space.patch;
      nodes.insert(nodes.end(), patch.nodes.begin(), patch.nodes.end());
      weights.insert(weights.end(), patch.weights.begin(), patch.weights.end());
      weights.resize(nodes.size(), no_number);
      is_weighted = is_weighted || !patch.weights.empty();
    }
    out_.makeGroup("/patches");
    writeList("/patches/node", nodes);
    if (is_weighted) out_.write("/patches/weight", {weights.size()}, spanOf(weights), "1");
  }

  void writeSplits() {
    out_.makeGroup("/splits");
    const auto lowest = [](auto& row, const LatticeCell& cell) {
      row.insert(row.end(), cell.lowest.begin(), cell.lowest.end());
    };
    writeRows<std::int32_t>("/splits/lowest", {3}, "1", &SpaceTable::splits, lowest);
    writeColumn<std::int32_t>("/splits/level", "1", &SpaceTable::splits,
                              [](const LatticeCell& cell) { return cell.level; });
  }

  /// What points and probes have in common.
  template <class Record>
  void writeRecords(const std::string& group, std::vector<Record> SpaceTable::*records) {
    const auto integers = [&](const char* array, auto value) {
      writeColumn<std::int32_t>(group + array, "1", records,
                                [&](const Record& record) { return value(recordOf(record)); });
    };
    const auto bytes = [&](const char* array, auto value) {
      writeColumn<std::uint8_t>(group + array, "1", records,
                                [&](const Record& record) { return value(recordOf(record)); });
    };
    const auto numbers = [&](const char* array, const char* unit, auto value) {
      writeColumn<double>(group + array, unit, records, [&](const Record& record) {
        const PointRecord& point = recordOf(record);
        return isSolved(point.tag) ? value(point) : no_number;
      });
    };
    using Point = PointRecord;
    bytes("tag", [](const Point& p) { return p.tag; });
    bytes("cause", [](const Point& p) { return p.cause; });
    integers("parent", [](const Point& p) { return p.parent; });
    integers("newton_iterations", [](const Point& p) { return p.cost.newton_iterations; });
    integers("factorizations", [](const Point& p) { return p.cost.factorizations; });
    integers("steps", [](const Point& p) { return p.cost.steps; });
    writeForces(group, records);
    numbers("energy", "J", [](const Point& p) { return p.equilibrium.energy; });
    numbers("min_det_F", "1", [](const Point& p) { return p.equilibrium.min_det_F; });
    numbers("residual", "N", [](const Point& p) { return p.residual; });
    const auto id = [](std::vector<std::uint8_t>& row, const Record& record) {
      const Point& point = recordOf(record);
      const ContentId name = isSolved(point.tag) ? point.fields : ContentId();
      row.insert(row.end(), name.bytes().begin(), name.bytes().end());
    };
    writeRows<std::uint8_t>(group + "fields_id", {32}, "1", records, id);
  }

  template <class Record>
  void writeForces(const std::string& group, std::vector<Record> SpaceTable::*records) {
    const auto force = [](std::vector<double>& row, const Record& record) {
      const PointRecord& point = recordOf(record);
      for (int i = 0; i < 3; ++i)
        row.push_back(isSolved(point.tag) ? point.equilibrium.force[i] : no_number);
    };
    const auto stiffness = [](std::vector<double>& row, const Record& record) {
      const PointRecord& point = recordOf(record);
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          row.push_back(isSolved(point.tag) ? point.equilibrium.stiffness(i, j) : no_number);
    };
    writeRows<double>(group + "force", {3}, "N", records, force);
    writeRows<double>(group + "stiffness", {3, 3}, "N/m", records, stiffness);
  }

  /// One row of weights per point, NaN where there are none, and the tail of every space.
  void writeRbf(std::size_t kind) {
    std::vector<double> weights, tails;
    for (const SpaceTable& space : spaces_) {
      const RbfWeights* const rbf = space.rbf.empty() ? nullptr : &space.rbf[kind];
      Eigen::Index row = 0;
      for (const PointRecord& point : space.points) {
        const bool has = rbf != nullptr && isSolved(point.tag);
        for (Eigen::Index axis = 0; axis < 3; ++axis)
          weights.push_back(has ? rbf->weights(row, axis) : no_number);
        row += has ? 1 : 0;
      }
      for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(layout::rbf_tail_rows[kind]); ++i)
        for (Eigen::Index axis = 0; axis < 3; ++axis)
          tails.push_back(rbf != nullptr ? rbf->tail(i, axis) : no_number);
    }
    const std::string path = layout::rbf_paths[kind];
    out_.write(path, {weights.size() / 3, 3}, spanOf(weights), "N");
    if (!tails.empty())
      out_.write(path + "_polynomial", {spaces_.size(), layout::rbf_tail_rows[kind], 3},
                 spanOf(tails), "N");
  }

  void writeAttempts() {
    out_.makeGroup("/attempts");
    const auto integers = [&](const char* array, auto value) {
      writeColumn<std::int32_t>(std::string("/attempts/") + array, "1", &SpaceTable::attempts,
                                value);
    };
    const auto numbers = [&](const char* array, const char* unit, auto value) {
      writeColumn<double>(std::string("/attempts/") + array, unit, &SpaceTable::attempts, value);
    };
    using Attempt = FailedAttempt;
    integers("target", [](const Attempt& a) { return a.target; });
    integers("parent", [](const Attempt& a) { return a.parent; });
    writeColumn<std::uint8_t>("/attempts/cause", "1", &SpaceTable::attempts,
                              [](const Attempt& a) { return a.failure.cause; });
    numbers("step_reached", "1", [](const Attempt& a) { return a.failure.step_reached; });
    numbers("residual", "N", [](const Attempt& a) { return a.failure.residual; });
    integers("element", [](const Attempt& a) { return a.failure.element; });
    numbers("element_det_F", "1", [](const Attempt& a) { return a.failure.element_det_F; });
    integers("negative_pivots", [](const Attempt& a) { return a.failure.negative_pivots; });
    integers("expected_negative_pivots",
             [](const Attempt& a) { return a.failure.expected_negative_pivots; });
    integers("mumps_infog1", [](const Attempt& a) { return a.failure.mumps_infog1; });
    integers("mumps_infog2", [](const Attempt& a) { return a.failure.mumps_infog2; });
  }

  std::string file_;
  const Problem& problem_;
  const std::vector<SpaceTable>& spaces_;
  hdf5::Writer out_;
};

void checkArguments(const std::string& file, const Problem& problem,
                    const std::vector<SpaceTable>& spaces) {
  const Lattice expected = uniformLattice(problem.scene);
  if (spaces.empty() || spaces.size() != problem.active.size())
    throw failure("{}: {} spaces to seal for {} active nodes", file, spaces.size(),
                  problem.active.size());
  for (std::size_t s = 0; s < spaces.size(); ++s) {
    const ActivePatch &given = spaces[s].patch, &active = problem.active[s];
    if (given.name != active.name || given.node != active.node || given.nodes != active.nodes ||
        given.weights != active.weights)
      throw failure(
          "{}: space {} to seal is \"{}\", which is not active node \"{}\" of the problem", file, s,
          given.name, active.name);
    const Lattice& lattice = spaces[s].lattice;
    if (lattice.radius() != expected.radius() || lattice.spacing() != expected.spacing() ||
        lattice.divisions() != expected.divisions() || lattice.uniformSize() != expected.size())
      throw failure(
          "{}: space \"{}\": its lattice (radius {} m, spacing {} m) "
          "is not that of the scene (radius {} m, spacing {} m)",
          file, given.name, lattice.radius(), lattice.spacing(), expected.radius(),
          expected.spacing());
    if (const std::string fault = faultOf(spaces[s]); !fault.empty())
      throw failure("{}: space \"{}\": {}", file, given.name, fault);
  }
}

/// With what is derived from the points and stored beside them.
std::vector<SpaceTable> withDerived(std::vector<SpaceTable> spaces) {
  for (SpaceTable& space : spaces) {
    space.inconsistent_edges = inconsistentEdges(space);
    space.rbf.clear();
    const auto n_solved =
        std::count_if(space.points.begin(), space.points.end(),
                      [](const PointRecord& point) { return isSolved(point.tag); });
    if (n_solved == 0 || static_cast<std::size_t>(n_solved) > most_stored_rbf_points) continue;
    for (const RbfKernel kernel : {RbfKernel::linear, RbfKernel::cubic})
      for (RbfWeights& weights : solveRbfWeights(space, kernel))
        space.rbf.push_back(std::move(weights));
  }
  return spaces;
}

ContentId writeDataset(const std::filesystem::path& file, const Problem& problem,
                       const std::vector<SpaceTable>& spaces, const std::string& kernel_family,
                       const FieldsSource& fields) {
  SealWriter writer(file, problem, spaces);
  writer.writeMesh();
  writer.writeSpaces();
  writer.writePoints();
  writer.writeProbes();
  writer.writeRbf();
  writer.writeFields(fields);
  return writer.finish(kernel_family);
}

void verifySealed(const std::filesystem::path& file, const ContentId& written) {
  const Dataset dataset(file);
  dataset.verifyAll();
  if (dataset.contentId() != written)
    throw failure("{}: reads back differently from what was written", file.string());
}

}  // namespace

void sealDataset(const std::filesystem::path& file, const Problem& problem,
                 const std::vector<SpaceTable>& spaces, const std::string& kernel_family,
                 const FieldsSource& fields) {
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored))
    throw badInput("{}: is a directory; give the dataset a file name", file.string());
  checkArguments(file.string(), problem, spaces);
  const std::vector<SpaceTable> complete = withDerived(spaces);
  replaceFile(file, [&](const std::filesystem::path& aside) {
    const ContentId content = writeDataset(aside, problem, complete, kernel_family, fields);
    verifySealed(aside, content);
  });
}

}  // namespace palpate
