#include <algorithm>
#include <functional>
#include <limits>

#include "common/base/assertion.hpp"
#include "common/dataset/dataset_format.hpp"
#include "common/mesh/node_set.hpp"
#include "common/problem/finger.hpp"

namespace palpate {

template <>
struct hdf5::Stored<LatticeEdge> : hdf5::Row<std::int32_t, 2> {};
template <>
struct hdf5::Stored<std::array<double, 8>> : hdf5::Row<double, 8> {};
template <>
struct hdf5::Stored<SymmetricSlope> : hdf5::Row<double, 6, 3> {};

namespace {

using hdf5::Reader;
using hdf5::Writer;

constexpr const char *points_group = "/points", *probes_group = "/probes";
constexpr const char *name_path = "/spaces/name", *active_path = "/spaces/active_node",
                     *finger_path = "/spaces/finger", *finger_width_path = "/spaces/finger_width",
                     *patch_node_path = "/patches/node", *patch_weight_path = "/patches/weight",
                     *split_level_path = "/splits/level", *jumps_path = "/inconsistent_edges",
                     *cause_path = "/attempts/cause", *ijk_path = "/points/ijk",
                     *position_path = "/points/position", *probe_position_path = "/probes/position";

constexpr double no_number = std::numeric_limits<double>::quiet_NaN();

/// Number of a table in the counts of a space.
enum class Table : std::uint8_t { patch_nodes, points, splits, edges, probes, attempts };
constexpr std::size_t n_tables = 6;

/// The data of one space, for writing.
struct SpaceToWrite {
  const SpaceRows& rows;
  const std::vector<LatticeEdge>& jumps;
  std::array<std::size_t, n_tables> counts;  ///< number of rows in each table
};
using SpacesToWrite = std::vector<SpaceToWrite>;

// ---- the tables and their columns, for both writer and reader -------------------------------

constexpr auto nodes_of_patch = [](auto& space) -> auto& { return space.patch.nodes; };

/// Calls visit(table, firsts, rows, list) for each table. `firsts` is the path of the array with
/// the first row of each space. `rows` is the path of one of the table's arrays. list(SpaceTable)
/// is the list with the rows of a space.
template <class Visit>
void forEachTable(const Visit& visit) {
  visit(Table::patch_nodes, "/spaces/first_patch_node", patch_node_path, nodes_of_patch);
  visit(Table::points, "/spaces/first_point", ijk_path, &SpaceTable::points);
  visit(Table::splits, "/spaces/first_split", split_level_path, &SpaceTable::splits);
  visit(Table::edges, "/spaces/first_edge", jumps_path, &SpaceTable::inconsistent_edges);
  visit(Table::probes, "/spaces/first_probe", probe_position_path, &SpaceTable::probes);
  visit(Table::attempts, "/spaces/first_attempt", cause_path, &SpaceTable::attempts);
}

// Each of these functions calls visit(path, unit, part) for each column of a table. `part` is the
// member of a row that the column holds. The optional fourth argument tells whether a row has a
// value. In the file, the other rows have nothing().

template <class Visit>
void forEachSplitColumn(const Visit& visit) {
  visit("/splits/lowest", "1", &LatticeCell::lowest);
  visit(split_level_path, "1", &LatticeCell::level);
}

template <class Visit>
void forEachAttemptColumn(const Visit& visit) {
  const auto visitFailure = [&](const char* path, const char* unit, auto member) {
    visit(
        path, unit, [member](auto& attempt) -> auto& { return attempt.failure.*member; });
  };
  visit("/attempts/target", "1", &FailedAttempt::target);
  visit("/attempts/parent", "1", &FailedAttempt::parent);
  visitFailure(cause_path, "1", &Failure::cause);
  visitFailure("/attempts/step_reached", "1", &Failure::step_reached);
  visitFailure("/attempts/residual", "N", &Failure::residual);
  visitFailure("/attempts/element", "1", &Failure::element);
  visitFailure("/attempts/element_det_F", "1", &Failure::element_det_F);
  visitFailure("/attempts/negative_pivots", "1", &Failure::negative_pivots);
  visitFailure("/attempts/expected_negative_pivots", "1", &Failure::expected_negative_pivots);
  visitFailure("/attempts/mumps_infog1", "1", &Failure::mumps_infog1);
  visitFailure("/attempts/mumps_infog2", "1", &Failure::mumps_infog2);
}

/// Visits the columns that /points and /probes (`group`) have in common: those of the PointRecord
/// that recordOf(row) returns. The tag is the first column, because it decides whether a row has
/// values in the other columns. `with_drive` says whether some space belongs to a finger. If not,
/// the columns of FingerSlopes are left out, as in older files.
template <class RecordOf, class Visit>
void forEachRecordColumn(const std::string& group, const RecordOf& recordOf, bool with_drive,
                         const Visit& visit) {
  const auto isThere = [&](const auto& row) { return isSolved(recordOf(row).tag); };
  const auto visitCost = [&](const char* name, auto member) {
    visit(
        group + name, "1",
        [&recordOf, member ](auto& row) -> auto& { return recordOf(row).cost.*member; });
  };
  const auto visitEquilibrium = [&](const char* name, const char* unit, auto member) {
    visit(
        group + name, unit,
        [&recordOf, member ](auto& row) -> auto& { return recordOf(row).equilibrium.*member; },
        isThere);
  };
  const auto part = [&](auto member) {
    return [&recordOf, member ](auto& row) -> auto& { return recordOf(row).*member; };
  };
  visit(group + "/tag", "1", part(&PointRecord::tag));
  visit(group + "/cause", "1", part(&PointRecord::cause));
  visit(group + "/parent", "1", part(&PointRecord::parent));
  visitCost("/newton_iterations", &Cost::newton_iterations);
  visitCost("/factorizations", &Cost::factorizations);
  visitCost("/steps", &Cost::steps);
  visitEquilibrium("/force", "N", &Equilibrium::force);
  visitEquilibrium("/stiffness", "N/m", &Equilibrium::stiffness);
  visitEquilibrium("/energy", "J", &Equilibrium::energy);
  if (with_drive) {
    visitEquilibrium("/drive", "N", &Equilibrium::drive);
    visitEquilibrium("/drive_stiffness", "N/m", &Equilibrium::drive_stiffness);
    visitEquilibrium("/drive_slope", "N/m", &Equilibrium::drive_slope);
    visitEquilibrium("/stiffness_by_p", "N/m^2", &Equilibrium::stiffness_by_p);
    visitEquilibrium("/stiffness_by_s", "N/m^2", &Equilibrium::stiffness_by_s);
    visitEquilibrium("/drive_slope_by_p", "N/m^2", &Equilibrium::drive_slope_by_p);
  }
  visitEquilibrium("/min_det_F", "1", &Equilibrium::min_det_F);
  visit(group + "/residual", "N", part(&PointRecord::residual), isThere);
  visit(group + "/fields_id", "1", part(&PointRecord::fields), isThere);
}

constexpr auto record_of_probe = [](auto& probe) -> auto& { return probe.record; };

// ---- lattices -------------------------------------------------------------------------------

void writeLattices(Writer& out, const SpacesToWrite& spaces) {
  const Lattice& first = spaces.front().rows.lattice();
  out.setNumber(points_group, "radius", first.radius());
  out.setNumber(points_group, "spacing", first.spacing());
  out.setNumber(points_group, "divisions", first.divisions());
  hsize_t size = 0;
  for (const SpaceToWrite& space : spaces) size += static_cast<hsize_t>(space.rows.points());
  const auto write = [&](const char* path, const char* unit, auto valueOf) {
    using Value = decltype(valueOf(first, 0));
    hdf5::RowWriter list = out.list<Value>(path, size, unit);
    for (const SpaceToWrite& space : spaces)
      for (std::int32_t n = 0; n < space.rows.points(); ++n)
        list.add(valueOf(space.rows.lattice(), n));
    list.finish();
  };
  write(ijk_path, "1", [](const Lattice& lattice, std::int32_t n) { return lattice.point(n); });
  write(position_path, "m",
        [](const Lattice& lattice, std::int32_t n) { return lattice.displacement(n); });
}

/// Makes the lattice of each space: the scene's uniform lattice, and the added points from the
/// file.
void readLattices(const Reader& in, const Scene& scene, std::vector<SpaceTable>& spaces) {
  const auto ijk = in.readList<LatticePoint>(ijk_path);
  const auto positions = in.readList<Eigen::Vector3d>(position_path, ijk.size());
  std::size_t row = 0;
  // The first points must be the uniform ones of the scene. Refinement added the others.
  for (SpaceTable& space : spaces) {
    Lattice& lattice = space.lattice = uniformLattice(scene, space.patch);
    const auto n_points = static_cast<std::int32_t>(space.points.size());
    if (n_points < lattice.size() || (lattice.divisions() == 1 && n_points > lattice.size()))
      throw in.damaged(ijk_path, "does not match the lattice of the scene");
    for (std::int32_t n = 0; n < n_points; ++n, ++row) {
      const bool is_new = n >= lattice.size();
      if (is_new ? lattice.indexOf(ijk[row]).has_value() : lattice.point(n) != ijk[row])
        throw in.damaged(ijk_path, "does not match the lattice of the scene");
      if (is_new) lattice.add(ijk[row]);
      const double distance = (lattice.displacement(n) - positions[row]).cwiseAbs().maxCoeff();
      // The positions are stored for other programs. They must agree with the lattice coordinates
      // up to rounding.
      if (!(distance <= 1e-9 * lattice.radius()))
        throw in.damaged(position_path, "does not match the lattice of the scene");
    }
  }
}

// ---- columns --------------------------------------------------------------------------------

/// Type in which a member of type T is stored: matrices are stored row by row.
template <class T>
using InFile = std::conditional_t<std::is_same_v<T, Eigen::Matrix3d>, hdf5::RowMajorMatrix3d, T>;

template <class Row, class Part>
using PartInFile = InFile<std::remove_cvref_t<std::invoke_result_t<Part, Row&>>>;

/// Returns the value that the file holds where a row has none.
template <class T>
T nothing() {
  if constexpr (std::is_floating_point_v<T>)
    return no_number;
  else if constexpr (requires { T::Constant(no_number); })
    return T::Constant(no_number);
  else
    return T();
}

bool isKnown(Tag tag) { return tagOf(static_cast<std::uint32_t>(tag)).has_value(); }
bool isKnown(Cause cause) { return causeOf(static_cast<std::uint32_t>(cause)).has_value(); }

struct Always {
  bool operator()(const auto& /*row*/) const { return true; }
};

/// Writes one column of a table per call. Each call visits all rows, because the rows may not fit
/// into memory together.
template <class Row>
struct ColumnWriter {
  using Visit = std::function<void(const Row&)>;
  Writer& out;
  std::size_t size;
  std::function<void(const Visit&)> each;

  template <class Part, class IsThere = Always>
  void operator()(const std::string& path, const char* unit, Part part,
                  IsThere isThere = {}) const {
    using Value = PartInFile<const Row, Part>;
    hdf5::RowWriter list = out.list<Value>(path, size, unit);
    each([&](const Row& row) {
      list.add(isThere(row) ? Value(std::invoke(part, row)) : nothing<Value>());
    });
    list.finish();
  }
};

/// Returns a writer for the rows of all spaces in a table. each(space, visit) calls visit(row) for
/// each row of a space.
template <class Row, class Each>
ColumnWriter<Row> columnsOf(Writer& out, const SpacesToWrite& spaces, Table table,
                            const Each& each) {
  std::size_t size = 0;
  for (const SpaceToWrite& space : spaces) size += space.counts[static_cast<std::size_t>(table)];
  return {out, size, [&spaces, each](const typename ColumnWriter<Row>::Visit& visit) {
            for (const SpaceToWrite& space : spaces) each(space, visit);
          }};
}

/// Reads one column of a table per call, into the members of existing rows.
template <class Row>
struct ColumnReader {
  const Reader& in;
  std::vector<Row*> rows;

  template <class Part, class IsThere = Always>
  void operator()(const std::string& path, const char* /*unit*/, Part part,
                  IsThere isThere = {}) const {
    using Value = PartInFile<Row, Part>;
    const std::vector<Value> values = in.readList<Value>(path, rows.size());
    for (std::size_t n = 0; n < rows.size(); ++n) {
      // A newer program may have written an enumerator that this one does not know.
      if constexpr (std::is_enum_v<Value>)
        if (!isKnown(values[n]))
          throw in.damaged(path, fmt::format("holds {}, which this program does not know",
                                             static_cast<int>(values[n])));
      if (isThere(*rows[n])) std::invoke(part, *rows[n]) = values[n];
    }
  }
};

/// Returns a reader for the rows in `list` of every space, one space after the other.
template <class List>
auto columnsOf(const Reader& in, std::vector<SpaceTable>& spaces, List list) {
  using Row = std::remove_reference_t<decltype(std::invoke(list, spaces.front()).front())>;
  ColumnReader<Row> columns{in, {}};
  for (SpaceTable& space : spaces)
    for (Row& row : std::invoke(list, space)) columns.rows.push_back(&row);
  return columns;
}

/// A row of the table of fingers: centre and radius, then `outward` and `pull` of the reach. All
/// NaN for other tools. The width of the reach is in a separate array, which older files do not
/// have.
using FingerRow = std::array<double, 8>;

FingerRow rowOf(const std::optional<Finger>& finger) {
  FingerRow row;
  row.fill(no_number);
  if (!finger) return row;
  const Eigen::Vector3d &s = finger->center, &n = finger->reach.outward;
  return {s[0], s[1], s[2], finger->radius, n[0], n[1], n[2], finger->reach.pull};
}

// ---- writing --------------------------------------------------------------------------------

void writeNames(Writer& out, const SpacesToWrite& spaces) {
  std::size_t length = 1;
  for (const SpaceToWrite& space : spaces)
    length = std::max(length, space.rows.patch().name.size());
  hdf5::RowWriter names(out, name_path, hdf5::Element::uint8, {spaces.size(), length}, "1");
  for (const SpaceToWrite& space : spaces) {
    std::string name = space.rows.patch().name;
    name.resize(length);
    names.addBytes(name);
  }
  names.finish();
}

/// Writes the index of the first row of each space, then the total number of rows.
void writeFirsts(Writer& out, const std::string& path, const SpacesToWrite& spaces, Table table) {
  std::vector<std::int32_t> firsts = {0};
  std::size_t total = 0;
  for (const SpaceToWrite& space : spaces) {
    total += space.counts[static_cast<std::size_t>(table)];
    if (total > std::numeric_limits<std::int32_t>::max())
      throw failure("{}: {}: a dataset cannot have more than 2^31 - 1 rows", out.name(), path);
    firsts.push_back(static_cast<std::int32_t>(total));
  }
  out.writeList(path, firsts, "1");
}

/// Writes the patches; returns whether some space belongs to a finger.
bool writePatches(Writer& out, const SpacesToWrite& spaces) {
  std::vector<std::int32_t> nodes;
  std::vector<double> weights;
  std::vector<FingerRow> fingers;
  std::vector<double> widths;
  bool is_weighted = false, with_finger = false;
  for (const SpaceToWrite& space : spaces) {
    const ActivePatch& patch = space.rows.patch();
    nodes.insert(nodes.end(), patch.nodes.begin(), patch.nodes.end());
    weights.insert(weights.end(), patch.weights.begin(), patch.weights.end());
    weights.resize(nodes.size(), no_number);
    is_weighted = is_weighted || !patch.weights.empty();
    with_finger = with_finger || patch.finger;
    fingers.push_back(rowOf(patch.finger));
    widths.push_back(patch.finger ? patch.finger->reach.width : no_number);
  }
  out.makeGroup("/patches");
  out.writeList(patch_node_path, nodes, "1");
  // Arrays that no tool needs are left out, as in older versions of the format.
  if (is_weighted) out.writeList(patch_weight_path, weights, "1");
  if (with_finger) {
    out.writeList(finger_path, fingers, "m");
    out.writeList(finger_width_path, widths, "m");
  }
  return with_finger;
}

// ---- reading --------------------------------------------------------------------------------

void checkNames(const Reader& in, const Scene& scene) {
  const hdf5::ArrayInfo& info =
      in.array(name_path, hdf5::Element::uint8, {scene.active.size(), hdf5::any_extent});
  const std::size_t length = info.shape[1];
  const auto names = in.read<std::uint8_t>(name_path, info.shape);
  for (std::size_t s = 0; s < scene.active.size(); ++s) {
    std::string name(reinterpret_cast<const char*>(names.data()) + s * length, length);
    name.erase(name.find_last_not_of('\0') + 1);
    if (name != scene.active[s].name)
      throw in.damaged(name_path, "does not match the active nodes of the scene");
  }
}

/// Resizes the list of each space to the number of its rows in the file.
template <class List>
void resizeLists(const Reader& in, const std::string& firsts_path, const char* rows_path,
                 std::vector<SpaceTable>& spaces, List list) {
  const std::size_t n_rows = in.rowsOf(rows_path);
  const auto firsts = in.readList<std::int32_t>(firsts_path, spaces.size() + 1);
  if (firsts.front() != 0 || !std::ranges::is_sorted(firsts) ||
      static_cast<std::size_t>(firsts.back()) != n_rows)
    throw in.damaged(firsts_path,
                     fmt::format("does not divide the {} rows among the spaces", n_rows));
  for (std::size_t s = 0; s < spaces.size(); ++s)
    std::invoke(list, spaces[s]).resize(static_cast<std::size_t>(firsts[s + 1] - firsts[s]));
}

/// Reads the patches; returns whether some space belongs to a finger.
bool readPatches(const Reader& in, const Scene& scene, std::size_t n_nodes,
                 std::vector<SpaceTable>& spaces) {
  const auto isWeighted = [](const ActiveSelection& a) { return a.tool != ToolKind::rigid; };
  const auto isFingers = [](const ActiveSelection& a) { return a.tool == ToolKind::finger; };
  const auto active = in.readList<std::int32_t>(active_path, spaces.size());
  const auto nodes = columnsOf(in, spaces, nodes_of_patch);
  nodes(patch_node_path, "1", std::identity());
  std::vector<double> weights(nodes.rows.size());
  if (std::ranges::any_of(scene.active, isWeighted))
    weights = in.readList<double>(patch_weight_path, nodes.rows.size());
  std::vector<FingerRow> fingers(spaces.size());
  const bool with_finger = std::ranges::any_of(scene.active, isFingers);
  if (with_finger) fingers = in.readList<FingerRow>(finger_path, spaces.size());
  std::vector<double> widths(spaces.size(), std::numeric_limits<double>::infinity());
  if (std::ranges::binary_search(in.arrays(), finger_width_path, {}, &hdf5::ArrayInfo::path))
    widths = in.readList<double>(finger_width_path, spaces.size());
  auto weight = weights.begin();
  for (std::size_t s = 0; s < spaces.size(); ++s) {
    ActivePatch& patch = spaces[s].patch;
    patch.name = scene.active[s].name;
    patch.node = active[s];
    patch.probe = scene.active[s].probe;
    const auto end = weight + static_cast<std::ptrdiff_t>(patch.nodes.size());
    if (isWeighted(scene.active[s])) patch.weights.assign(weight, end);
    weight = end;
    if (isFingers(scene.active[s])) {
      const auto& [x, y, z, radius, nx, ny, nz, pull] = fingers[s];
      patch.finger = Finger{{x, y, z}, radius, {{nx, ny, nz}, pull, widths[s]}};
      if (!isFinger(*patch.finger))
        throw in.damaged(finger_path,
                         fmt::format("the row of {} is not a valid finger", patch.name));
    }
    if (!std::ranges::is_sorted(patch.nodes))
      throw in.damaged(patch_node_path, fmt::format("the nodes of {} are not sorted", patch.name));
    if (!patch.nodes.empty() &&
        (patch.nodes.front() < 0 || static_cast<std::size_t>(patch.nodes.back()) >= n_nodes))
      throw in.damaged(patch_node_path, fmt::format("{} has nodes outside the mesh", patch.name));
    if (!contains(patch.nodes, patch.node))
      throw in.damaged(active_path,
                       fmt::format("node {} is not in the patch of {}", patch.node, patch.name));
  }
  return with_finger;
}

std::string unusableRow(std::size_t n) {
  return fmt::format("row {} is solved, but one of its numbers is not finite or exceeds {:g}", n,
                     largest_stored);
}

/// Refuses equilibria with numbers that no reader would accept (isUsable).
template <class Row, class RecordOf>
void refuseUnusable(const std::string& group, const ColumnWriter<Row>& columns,
                    const RecordOf& recordOf) {
  std::size_t n = 0;
  columns.each([&](const Row& row) {
    const PointRecord& record = recordOf(row);
    if (isSolved(record.tag) && !isUsable(record.equilibrium))
      throw failure("{}: {}/force: {}", columns.out.name(), group, unusableRow(n));
    ++n;
  });
}
template <class Row, class RecordOf>
void checkSolved(const std::string& group, const ColumnReader<Row>& columns,
                 const RecordOf& recordOf) {
  for (std::size_t n = 0; n < columns.rows.size(); ++n)
    if (!isUsable(recordOf(*columns.rows[n]).equilibrium))
      throw columns.in.damaged(group + "/force", unusableRow(n));
}

void writeSplitsAndAttempts(Writer& out, const SpacesToWrite& spaces) {
  out.makeGroup("/splits");
  forEachSplitColumn(columnsOf<LatticeCell>(out, spaces, Table::splits,
                                            [](const SpaceToWrite& space, const auto& visit) {
                                              std::ranges::for_each(space.rows.splits(), visit);
                                            }));
  out.makeGroup("/attempts");
  forEachAttemptColumn(columnsOf<FailedAttempt>(
      out, spaces, Table::attempts,
      [](const SpaceToWrite& space, const auto& visit) { space.rows.eachAttempt(visit); }));
  columnsOf<LatticeEdge>(out, spaces, Table::edges,
                         [](const SpaceToWrite& space, const auto& visit) {
                           std::ranges::for_each(space.jumps, visit);
                         })(jumps_path, "1", std::identity());
}

}  // namespace

void writeSpaces(Writer& out, const SpaceRowsList& rows,
                 const std::vector<std::vector<LatticeEdge>>& jumps) {
  PALPATE_ASSERT(!rows.empty() && rows.size() == jumps.size(), "a scene must have an active node");
  SpacesToWrite spaces;
  for (std::size_t s = 0; s < rows.size(); ++s) {
    std::size_t n_attempts = 0;
    rows[s]->eachAttempt([&](const FailedAttempt&) { ++n_attempts; });
    spaces.push_back({*rows[s],
                      jumps[s],
                      {rows[s]->patch().nodes.size(), static_cast<std::size_t>(rows[s]->points()),
                       rows[s]->splits().size(), jumps[s].size(),
                       static_cast<std::size_t>(rows[s]->probes()), n_attempts}});
  }
  const auto points = columnsOf<PointRecord>(
      out, spaces, Table::points, [](const SpaceToWrite& space, const auto& visit) {
        for (std::int32_t n = 0; n < space.rows.points(); ++n) visit(space.rows.point(n));
      });
  const auto probes = columnsOf<Probe>(out, spaces, Table::probes,
                                       [](const SpaceToWrite& space, const auto& visit) {
                                         for (std::int32_t n = 0; n < space.rows.probes(); ++n)
                                           visit(space.rows.probe(n));
                                       });
  refuseUnusable(points_group, points, std::identity());
  refuseUnusable(probes_group, probes, record_of_probe);
  out.makeGroup("/spaces");
  writeNames(out, spaces);
  std::vector<std::int32_t> active;
  for (const SpaceToWrite& space : spaces) active.push_back(space.rows.patch().node);
  out.writeList(active_path, active, "1");
  forEachTable([&](Table table, const char* firsts, const char*, auto) {
    writeFirsts(out, firsts, spaces, table);
  });
  const bool with_drive = writePatches(out, spaces);
  writeSplitsAndAttempts(out, spaces);
  out.makeGroup(points_group);
  writeLattices(out, spaces);
  forEachRecordColumn(points_group, std::identity(), with_drive, points);
  out.makeGroup(probes_group);
  probes(probe_position_path, "m", &Probe::displacement);
  forEachRecordColumn(probes_group, record_of_probe, with_drive, probes);
}

std::vector<SpaceTable> readSpaces(const Reader& in, const Scene& scene, const Mesh& mesh) {
  checkNames(in, scene);
  std::vector<SpaceTable> spaces(scene.active.size());
  forEachTable([&](Table, const char* firsts, const char* rows, auto list) {
    resizeLists(in, firsts, rows, spaces, list);
  });
  const bool with_drive = readPatches(in, scene, mesh.nodes.size(), spaces);
  forEachSplitColumn(columnsOf(in, spaces, &SpaceTable::splits));
  forEachAttemptColumn(columnsOf(in, spaces, &SpaceTable::attempts));
  columnsOf(in, spaces, &SpaceTable::inconsistent_edges)(jumps_path, "1", std::identity());
  readLattices(in, scene, spaces);
  const auto points = columnsOf(in, spaces, &SpaceTable::points);
  forEachRecordColumn(points_group, std::identity(), with_drive, points);
  const auto probes = columnsOf(in, spaces, &SpaceTable::probes);
  probes(probe_position_path, "m", &Probe::displacement);
  forEachRecordColumn(probes_group, record_of_probe, with_drive, probes);
  checkSolved(points_group, points, std::identity());
  checkSolved(probes_group, probes, record_of_probe);
  for (const SpaceTable& space : spaces)
    if (const std::string fault = faultOf(space); !fault.empty())
      throw in.damaged("space " + space.patch.name, fault);
  if (!std::ranges::is_partitioned(spaces,
                                   [](const SpaceTable& space) { return !space.patch.probe; }))
    throw in.damaged(name_path, "lists places of probes before other active nodes");
  return spaces;
}

}  // namespace palpate
