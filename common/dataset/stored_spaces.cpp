#include <algorithm>
#include <cmath>
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

// ---- the tables, as writer and reader both go through them ----------------------------------

constexpr auto patch_nodes = [](auto& space) -> auto& { return space.patch.nodes; };

/// What is written of one space.
struct SpaceToWrite {
  const SpaceRows& rows;
  const std::vector<LatticeEdge>& jumps;
};
using SpacesToWrite = std::vector<SpaceToWrite>;

/// visit(where the rows of each space begin, an array of these rows, the list in a SpaceTable, how
/// many a SpaceToWrite has)
template <class Visit>
void forEachTable(const Visit& visit) {
  using Space = SpaceToWrite;
  visit("/spaces/first_patch_node", patch_node_path, patch_nodes,
        [](const Space& space) { return space.rows.patch().nodes.size(); });
  visit("/spaces/first_point", ijk_path, &SpaceTable::points,
        [](const Space& space) { return static_cast<std::size_t>(space.rows.points()); });
  visit("/spaces/first_split", split_level_path, &SpaceTable::splits,
        [](const Space& space) { return space.rows.splits().size(); });
  visit("/spaces/first_edge", jumps_path, &SpaceTable::inconsistent_edges,
        [](const Space& space) { return space.jumps.size(); });
  visit("/spaces/first_probe", probe_position_path, &SpaceTable::probes,
        [](const Space& space) { return static_cast<std::size_t>(space.rows.probes()); });
  visit("/spaces/first_attempt", cause_path, &SpaceTable::attempts,
        [](const Space& space) { return space.rows.attempts(); });
}

// Each column: visit(path, rows, unit, member). A row is a pointer to a record, of which the column
// has the member (std::identity: all of it); null where the file has no number. Rows that are read
// are a vector of them. Those that are written come one after the other, as often as there are
// columns: they may be more than fit into memory.

template <class Row>
struct WrittenRows {
  using Visit = std::function<void(const Row*)>;
  std::size_t size = 0;
  std::function<void(const Visit&)> each;
};

/// Pointers to one member of each row.
template <class Row, class Member>
auto partsOf(const std::vector<Row*>& rows, Member member) {
  std::vector<std::remove_reference_t<decltype(rows.front()->*member)>*> parts;
  for (Row* row : rows) parts.push_back(row == nullptr ? nullptr : &(row->*member));
  return parts;
}
template <class Row, class Part, class Base>
WrittenRows<Part> partsOf(const WrittenRows<Row>& rows, Part Base::*member) {
  return {rows.size, [each = rows.each, member](const typename WrittenRows<Part>::Visit& visit) {
            each([&](const Row* row) { visit(row == nullptr ? nullptr : &(row->*member)); });
          }};
}

/// Null in the place of those that hold no equilibrium.
template <class Row>
std::vector<Row*> solvedOf(std::vector<Row*> records) {
  for (Row*& record : records)
    if (!isSolved(record->tag)) record = nullptr;
  return records;
}
WrittenRows<PointRecord> solvedOf(const WrittenRows<PointRecord>& records) {
  return {
      records.size, [each = records.each](const WrittenRows<PointRecord>::Visit& visit) {
        each([&](const PointRecord* record) { visit(isSolved(record->tag) ? record : nullptr); });
      }};
}

/// What /points and /probes, which is `group`, have in common. The tags come before what depends on
/// them. `with_drive`: some space is of a finger; other files keep their bytes.
template <class Records, class Visit>
void forEachRecordColumn(const std::string& group, const Records& records, bool with_drive,
                         const Visit& visit) {
  visit(group + "/tag", records, "1", &PointRecord::tag);
  visit(group + "/cause", records, "1", &PointRecord::cause);
  visit(group + "/parent", records, "1", &PointRecord::parent);
  const auto costs = partsOf(records, &PointRecord::cost);
  visit(group + "/newton_iterations", costs, "1", &Cost::newton_iterations);
  visit(group + "/factorizations", costs, "1", &Cost::factorizations);
  visit(group + "/steps", costs, "1", &Cost::steps);
  const auto solved = solvedOf(records);
  const auto equilibria = partsOf(solved, &PointRecord::equilibrium);
  visit(group + "/force", equilibria, "N", &Equilibrium::force);
  visit(group + "/stiffness", equilibria, "N/m", &Equilibrium::stiffness);
  visit(group + "/energy", equilibria, "J", &Equilibrium::energy);
  if (with_drive) {
    visit(group + "/drive", equilibria, "N", &Equilibrium::drive);
    visit(group + "/drive_stiffness", equilibria, "N/m", &Equilibrium::drive_stiffness);
    visit(group + "/drive_slope", equilibria, "N/m", &Equilibrium::drive_slope);
    visit(group + "/stiffness_by_p", equilibria, "N/m^2", &Equilibrium::stiffness_by_p);
    visit(group + "/stiffness_by_s", equilibria, "N/m^2", &Equilibrium::stiffness_by_s);
    visit(group + "/drive_slope_by_p", equilibria, "N/m^2", &Equilibrium::drive_slope_by_p);
  }
  visit(group + "/min_det_F", equilibria, "1", &Equilibrium::min_det_F);
  visit(group + "/residual", solved, "N", &PointRecord::residual);
  visit(group + "/fields_id", solved, "1", &PointRecord::fields);
}

/// Pointers to the entries of a list of each space, those of all spaces one after the other.
template <class Spaces, class List>
auto rowsOf(Spaces& spaces, List list) {
  std::vector<std::remove_reference_t<decltype(std::invoke(list, spaces.front()).front())>*> rows;
  for (auto& space : spaces)
    for (auto& row : std::invoke(list, space)) rows.push_back(&row);
  return rows;
}

auto splitsOf(std::vector<SpaceTable>& spaces) { return rowsOf(spaces, &SpaceTable::splits); }
auto attemptsOf(std::vector<SpaceTable>& spaces) { return rowsOf(spaces, &SpaceTable::attempts); }
auto jumpsOf(std::vector<SpaceTable>& spaces) {
  return rowsOf(spaces, &SpaceTable::inconsistent_edges);
}
auto pointsOf(std::vector<SpaceTable>& spaces) { return rowsOf(spaces, &SpaceTable::points); }
auto probesOf(std::vector<SpaceTable>& spaces) { return rowsOf(spaces, &SpaceTable::probes); }

/// countOf(space) rows, which each(space, visit) goes through.
template <class Row, class Count, class Each>
WrittenRows<Row> writtenRows(const SpacesToWrite& spaces, const Count& countOf, const Each& each) {
  std::size_t size = 0;
  for (const SpaceToWrite& space : spaces) size += static_cast<std::size_t>(countOf(space));
  return {size, [&spaces, each](const typename WrittenRows<Row>::Visit& visit) {
            for (const SpaceToWrite& space : spaces) each(space, visit);
          }};
}
/// Of lists that are there.
template <class Row, class List>
WrittenRows<Row> listedRows(const SpacesToWrite& spaces, const List& listOf) {
  return writtenRows<Row>(
      spaces, [listOf](const SpaceToWrite& space) { return listOf(space).size(); },
      [listOf](const SpaceToWrite& space, const auto& visit) {
        for (const Row& row : listOf(space)) visit(&row);
      });
}

WrittenRows<LatticeCell> splitsOf(const SpacesToWrite& spaces) {
  return listedRows<LatticeCell>(
      spaces, [](const SpaceToWrite& space) -> auto& { return space.rows.splits(); });
}
WrittenRows<LatticeEdge> jumpsOf(const SpacesToWrite& spaces) {
  return listedRows<LatticeEdge>(
      spaces, [](const SpaceToWrite& space) -> auto& { return space.jumps; });
}
WrittenRows<FailedAttempt> attemptsOf(const SpacesToWrite& spaces) {
  return writtenRows<FailedAttempt>(
      spaces, [](const SpaceToWrite& space) { return space.rows.attempts(); },
      [](const SpaceToWrite& space, const auto& visit) {
        space.rows.eachAttempt([&](const FailedAttempt& attempt) { visit(&attempt); });
      });
}
WrittenRows<PointRecord> pointsOf(const SpacesToWrite& spaces) {
  return writtenRows<PointRecord>(
      spaces, [](const SpaceToWrite& space) { return space.rows.points(); },
      [](const SpaceToWrite& space, const auto& visit) {
        for (std::int32_t n = 0; n < space.rows.points(); ++n) {
          const PointRecord record = space.rows.point(n);
          visit(&record);
        }
      });
}
WrittenRows<Probe> probesOf(const SpacesToWrite& spaces) {
  return writtenRows<Probe>(
      spaces, [](const SpaceToWrite& space) { return space.rows.probes(); },
      [](const SpaceToWrite& space, const auto& visit) {
        for (std::int32_t n = 0; n < space.rows.probes(); ++n) {
          const Probe probe = space.rows.probe(n);
          visit(&probe);
        }
      });
}

bool hasFinger(const SpaceTable& space) { return space.patch.finger.has_value(); }
bool hasFinger(const SpaceToWrite& space) { return space.rows.patch().finger.has_value(); }

/// In the order of the file. visit.group(path) comes before the columns of a group, and
/// visit.lattices(spaces) where those of /points that are no members are.
template <class Spaces, class Visit>
void forEachColumn(Spaces& spaces, const Visit& visit) {
  visit.group("/splits");
  const auto splits = splitsOf(spaces);
  visit("/splits/lowest", splits, "1", &LatticeCell::lowest);
  visit(split_level_path, splits, "1", &LatticeCell::level);
  visit.group("/attempts");
  const auto attempts = attemptsOf(spaces);
  visit("/attempts/target", attempts, "1", &FailedAttempt::target);
  visit("/attempts/parent", attempts, "1", &FailedAttempt::parent);
  const auto failures = partsOf(attempts, &FailedAttempt::failure);
  visit(cause_path, failures, "1", &Failure::cause);
  visit("/attempts/step_reached", failures, "1", &Failure::step_reached);
  visit("/attempts/residual", failures, "N", &Failure::residual);
  visit("/attempts/element", failures, "1", &Failure::element);
  visit("/attempts/element_det_F", failures, "1", &Failure::element_det_F);
  visit("/attempts/negative_pivots", failures, "1", &Failure::negative_pivots);
  visit("/attempts/expected_negative_pivots", failures, "1", &Failure::expected_negative_pivots);
  visit("/attempts/mumps_infog1", failures, "1", &Failure::mumps_infog1);
  visit("/attempts/mumps_infog2", failures, "1", &Failure::mumps_infog2);
  visit(jumps_path, jumpsOf(spaces), "1", std::identity());
  visit.group(points_group);
  visit.lattices(spaces);
  const bool with_drive =
      std::ranges::any_of(spaces, [](const auto& space) { return hasFinger(space); });
  forEachRecordColumn(points_group, pointsOf(spaces), with_drive, visit);
  visit.group(probes_group);
  const auto probes = probesOf(spaces);
  visit(probe_position_path, probes, "m", &Probe::displacement);
  forEachRecordColumn(probes_group, partsOf(probes, &Probe::record), with_drive, visit);
}

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

/// The uniform lattice of the scene, and what the file adds to it.
void readLattices(const Reader& in, const Scene& scene, std::vector<SpaceTable>& spaces) {
  const auto ijk = in.readList<LatticePoint>(ijk_path);
  const auto positions = in.readList<Eigen::Vector3d>(position_path, ijk.size());
  std::size_t row = 0;
  // Uniform points must be where the scene puts them; what follows them was added by refinement.
  for (SpaceTable& space : spaces) {
    Lattice& lattice = space.lattice = uniformLattice(scene, space.patch);
    const auto n_points = static_cast<std::int32_t>(space.points.size());
    if (n_points < lattice.size() || (lattice.divisions() == 1 && n_points > lattice.size()))
      throw in.damaged(ijk_path, "is not the lattice of the scene");
    for (std::int32_t n = 0; n < n_points; ++n, ++row) {
      const bool is_new = n >= lattice.size();
      if (is_new ? lattice.indexOf(ijk[row]).has_value() : lattice.point(n) != ijk[row])
        throw in.damaged(ijk_path, "is not the lattice of the scene");
      if (is_new) lattice.add(ijk[row]);
      const double distance = (lattice.displacement(n) - positions[row]).cwiseAbs().maxCoeff();
      // Positions are for other readers: they must agree with the numbers, to the rounding.
      if (!(distance <= 1e-9 * lattice.radius()))
        throw in.damaged(position_path, "is not the lattice of the scene");
    }
  }
}

// ---- columns --------------------------------------------------------------------------------

/// As what a member lies in the file: matrices by rows.
template <class T>
using InFile = std::conditional_t<std::is_same_v<T, Eigen::Matrix3d>, hdf5::RowMajorMatrix3d, T>;

template <class Row, class Member>
using MemberInFile = InFile<std::remove_cvref_t<std::invoke_result_t<Member, Row&>>>;

/// Stands where there is no number.
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

struct ColumnWriter {
  Writer& out;

  void group(const char* path) const { out.makeGroup(path); }
  void lattices(const SpacesToWrite& spaces) const { writeLattices(out, spaces); }

  template <class Row, class Member>
  void operator()(const std::string& path, const WrittenRows<Row>& rows, const char* unit,
                  Member member) const {
    using Value = MemberInFile<const Row, Member>;
    hdf5::RowWriter list = out.list<Value>(path, rows.size, unit);
    rows.each([&](const Row* row) {
      list.add(row == nullptr ? nothing<Value>() : Value(std::invoke(member, *row)));
    });
    list.finish();
  }
};

struct ColumnReader {
  const Reader& in;
  const Scene& scene;

  void group(const char*) const {}
  void lattices(std::vector<SpaceTable>& spaces) const { readLattices(in, scene, spaces); }

  template <class Row, class Member>
  void operator()(const std::string& path, const std::vector<Row*>& rows, const char*,
                  Member member) const {
    using Value = MemberInFile<Row, Member>;
    const std::vector<Value> values = in.readList<Value>(path, rows.size());
    for (std::size_t n = 0; n < rows.size(); ++n) {
      // A value from a newer program would be an enumerator without a name.
      if constexpr (std::is_enum_v<Value>)
        if (!isKnown(values[n]))
          throw in.damaged(path, fmt::format("holds {}, which this program does not know",
                                             static_cast<int>(values[n])));
      if (rows[n] != nullptr) std::invoke(member, *rows[n]) = values[n];
    }
  }
};

/// Centre, radius, and what of the ball it reaches; of other tools no numbers. The width of that is
/// an array of its own, which older files lack.
using FingerRow = std::array<double, 8>;

FingerRow noFinger() {
  FingerRow row;
  row.fill(no_number);
  return row;
}

FingerRow rowOf(const Finger& finger) {
  const Eigen::Vector3d &s = finger.center, &n = finger.reach.outward;
  return {s[0], s[1], s[2], finger.radius, n[0], n[1], n[2], finger.reach.pull};
}

// ---- writing --------------------------------------------------------------------------------

void writeNames(Writer& out, const SpacesToWrite& spaces) {
  std::size_t length = 1;
  for (const SpaceToWrite& space : spaces)
    length = std::max(length, space.rows.patch().name.size());
  std::string names(spaces.size() * length, '\0');
  for (std::size_t s = 0; s < spaces.size(); ++s)
    spaces[s].rows.patch().name.copy(&names[s * length], length);
  out.write(name_path, {spaces.size(), length},
            std::span(reinterpret_cast<const std::uint8_t*>(names.data()), names.size()), "1");
}

/// Where the rows of each space begin, and at the end how many there are.
template <class Count>
void writeFirsts(Writer& out, const std::string& path, const SpacesToWrite& spaces,
                 const Count& countOf) {
  std::vector<std::int32_t> firsts = {0};
  std::size_t total = 0;
  for (const SpaceToWrite& space : spaces) {
    total += countOf(space);
    if (total > std::numeric_limits<std::int32_t>::max())
      throw failure("{}: {}: more rows than a dataset has numbers for", out.name(), path);
    firsts.push_back(static_cast<std::int32_t>(total));
  }
  out.writeList(path, firsts, "1");
}

void writePatches(Writer& out, const SpacesToWrite& spaces) {
  std::vector<std::int32_t> nodes;
  std::vector<double> weights;
  std::vector<FingerRow> fingers;
  std::vector<double> widths;
  bool is_weighted = false;
  for (const SpaceToWrite& space : spaces) {
    const ActivePatch& patch = space.rows.patch();
    nodes.insert(nodes.end(), patch.nodes.begin(), patch.nodes.end());
    weights.insert(weights.end(), patch.weights.begin(), patch.weights.end());
    weights.resize(nodes.size(), no_number);
    is_weighted = is_weighted || !patch.weights.empty();
    fingers.push_back(patch.finger ? rowOf(*patch.finger) : noFinger());
    widths.push_back(patch.finger ? patch.finger->reach.width : no_number);
  }
  out.makeGroup("/patches");
  out.writeList(patch_node_path, nodes, "1");
  // Left out for rigid tools alone: their files keep their bytes.
  if (is_weighted) out.writeList(patch_weight_path, weights, "1");
  if (std::ranges::any_of(spaces, [](const SpaceToWrite& space) { return hasFinger(space); })) {
    out.writeList(finger_path, fingers, "m");
    out.writeList(finger_width_path, widths, "m");
  }
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
      throw in.damaged(name_path, "are not the active nodes of the scene");
  }
}

/// Makes room for the rows of each space.
template <class List>
void resizeLists(const Reader& in, const std::string& firsts_path, const char* rows_path,
                 std::vector<SpaceTable>& spaces, List list) {
  const std::size_t n_rows = in.rowsOf(rows_path);
  const auto firsts = in.readList<std::int32_t>(firsts_path, spaces.size() + 1);
  if (firsts.front() != 0 || !std::ranges::is_sorted(firsts) ||
      static_cast<std::size_t>(firsts.back()) != n_rows)
    throw in.damaged(firsts_path, fmt::format("does not divide {} rows", n_rows));
  for (std::size_t s = 0; s < spaces.size(); ++s)
    std::invoke(list, spaces[s]).resize(static_cast<std::size_t>(firsts[s + 1] - firsts[s]));
}

void readPatches(const Reader& in, const Scene& scene, std::size_t n_nodes,
                 std::vector<SpaceTable>& spaces) {
  const auto isWeighted = [](const ActiveSelection& a) { return a.tool != ToolKind::rigid; };
  const auto isFingers = [](const ActiveSelection& a) { return a.tool == ToolKind::finger; };
  const auto active = in.readList<std::int32_t>(active_path, spaces.size());
  const auto nodes = rowsOf(spaces, patch_nodes);
  ColumnReader{in, scene}(patch_node_path, nodes, "1", std::identity());
  std::vector<double> weights(nodes.size());
  if (std::ranges::any_of(scene.active, isWeighted))
    weights = in.readList<double>(patch_weight_path, nodes.size());
  std::vector<FingerRow> fingers(spaces.size());
  if (std::ranges::any_of(scene.active, isFingers))
    fingers = in.readList<FingerRow>(finger_path, spaces.size());
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
        throw in.damaged(finger_path, fmt::format("that of {} is none", patch.name));
    }
    if (!std::ranges::is_sorted(patch.nodes))
      throw in.damaged(patch_node_path, fmt::format("those of {} are not sorted", patch.name));
    if (!patch.nodes.empty() &&
        (patch.nodes.front() < 0 || static_cast<std::size_t>(patch.nodes.back()) >= n_nodes))
      throw in.damaged(patch_node_path, fmt::format("those of {} are not of the mesh", patch.name));
    if (!contains(patch.nodes, patch.node))
      throw in.damaged(active_path,
                       fmt::format("{} is not in the patch of {}", patch.node, patch.name));
  }
}

std::string unusableRow(std::size_t n) {
  return fmt::format("row {} is solved, but a number of it is not finite, or beyond {:g}", n,
                     largest_stored);
}

void checkSolved(const Reader& in, const std::string& group,
                 const std::vector<PointRecord*>& records) {
  for (std::size_t n = 0; n < records.size(); ++n)
    if (!isUsable(records[n]->equilibrium)) throw in.damaged(group + "/force", unusableRow(n));
}

/// What no reader would take.
void refuseUnusable(const Writer& out, const std::string& group,
                    const WrittenRows<PointRecord>& records) {
  std::size_t n = 0;
  records.each([&](const PointRecord* record) {
    if (isSolved(record->tag) && !isUsable(record->equilibrium))
      throw failure("{}: {}/force: {}", out.name(), group, unusableRow(n));
    ++n;
  });
}

}  // namespace

void writeSpaces(Writer& out, const SpaceRowsList& rows,
                 const std::vector<std::vector<LatticeEdge>>& jumps) {
  PALPATE_ASSERT(!rows.empty() && rows.size() == jumps.size(), "a scene has an active node");
  SpacesToWrite spaces;
  for (std::size_t s = 0; s < rows.size(); ++s) spaces.push_back({*rows[s], jumps[s]});
  refuseUnusable(out, points_group, pointsOf(spaces));
  refuseUnusable(out, probes_group, partsOf(probesOf(spaces), &Probe::record));
  out.makeGroup("/spaces");
  writeNames(out, spaces);
  std::vector<std::int32_t> active;
  for (const SpaceToWrite& space : spaces) active.push_back(space.rows.patch().node);
  out.writeList(active_path, active, "1");
  forEachTable([&](const char* firsts, const char*, auto, auto countOf) {
    writeFirsts(out, firsts, spaces, countOf);
  });
  writePatches(out, spaces);
  forEachColumn(spaces, ColumnWriter{out});
}

std::vector<SpaceTable> readSpaces(const Reader& in, const Scene& scene, const Mesh& mesh) {
  checkNames(in, scene);
  std::vector<SpaceTable> spaces(scene.active.size());
  forEachTable([&](const char* firsts, const char* rows, auto list, auto) {
    resizeLists(in, firsts, rows, spaces, list);
  });
  readPatches(in, scene, mesh.nodes.size(), spaces);
  forEachColumn(spaces, ColumnReader{in, scene});
  checkSolved(in, points_group, rowsOf(spaces, &SpaceTable::points));
  checkSolved(in, probes_group, partsOf(rowsOf(spaces, &SpaceTable::probes), &Probe::record));
  for (const SpaceTable& space : spaces)
    if (const std::string fault = faultOf(space); !fault.empty())
      throw in.damaged("space " + space.patch.name, fault);
  if (!std::ranges::is_partitioned(spaces,
                                   [](const SpaceTable& space) { return !space.patch.probe; }))
    throw in.damaged(name_path, "have places of probes before what can be touched");
  return spaces;
}

}  // namespace palpate
