#include "common/base/assertion.hpp"
#include "common/base/text_lines.hpp"
#include "common/base/units.hpp"
#include "common/base/whole_file.hpp"
#include "common/mesh/mesh_reader.hpp"

namespace palpate {
namespace {

/// VTK's numbers of cells (vtkCellType.h).
constexpr int vtk_tetra = 10, vtk_quadratic_tetra = 24;
/// Vertices, lines, triangles, quadrilaterals, strips and polygons, and their quadratic forms.
constexpr int flat_cells[] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 21, 22, 23, 28, 30, 34, 36};

class VtkText {
 public:
  VtkText(TextLines lines, double metres_per_unit)
      : lines_(std::move(lines)), metres_per_unit_(metres_per_unit) {}

  Mesh read() {
    readHeader();
    while (lines_.advance()) readSection(std::string(lines_.takeWord()));
    if (mesh_.nodes.empty()) throw lines_.wrong("there are no POINTS: the file is truncated");
    if (types_.size() + 1 != offsets_.size() || types_.empty())
      throw lines_.wrong(
          "there are no CELLS and CELL_TYPES, or not as many: the file is truncated");
    takeTetrahedra();
    takeCellData();
    finishMesh(mesh_, lines_.source());
    return std::move(mesh_);
  }

 private:
  void readHeader() {
    if (!lines_.advance() || !lines_.rest().starts_with("# vtk DataFile"))
      throw lines_.wrong(
          "this is not a legacy VTK file: its first line is not \"# vtk DataFile Version\"");
    lines_.advanceIn("the header");
    if (lines_.rest() != "ASCII") lines_.advanceIn("the header");  // the title may be empty
    if (lines_.rest() != "ASCII")
      throw lines_.wrong("\"{}\" where ASCII is expected: binary files are not read",
                         lines_.rest());
    lines_.advanceIn("the header");
    if (lines_.rest() != "DATASET UNSTRUCTURED_GRID")
      throw lines_.wrong("\"{}\" where DATASET UNSTRUCTURED_GRID is expected", lines_.rest());
  }

  void readSection(const std::string& section) {
    if (section == "POINTS") {
      readPoints();
    } else if (section == "CELLS") {
      readCells();
    } else if (section == "CELL_TYPES") {
      if (!types_.empty()) throw lines_.wrong("a second CELL_TYPES section");
      const std::size_t count = lines_.takeCount("the number of cells");
      lines_.expectEndOfLine();
      types_ = readNumbers<int>(count, "a cell type");
    } else if (section == "CELL_DATA" || section == "POINT_DATA") {
      in_cell_data_ = section == "CELL_DATA";
      tuples_ = lines_.takeCount("the number of tuples");
      // Else "no data of no cells" would be taken for data of all that follow.
      if (in_cell_data_ && types_.empty()) throw lines_.wrong("CELL_DATA before CELL_TYPES");
      if (in_cell_data_ && tuples_ != types_.size())
        throw lines_.wrong("data of {} cells where there are {}", tuples_, types_.size());
    } else if (section == "METADATA") {
      lines_.skipToBlankLine();
    } else if (section == "FIELD") {
      readField();
    } else {
      readAttribute(section);
    }
  }

  /// The next number, on this line or on a later one.
  template <class Number>
  Number next(const char* what) {
    if (lines_.atEndOfLine()) lines_.advanceIn(what);
    return lines_.take<Number>(what);
  }

  template <class Number>
  std::vector<Number> readNumbers(std::size_t count, const char* what) {
    std::vector<Number> numbers;
    numbers.reserve(lines_.reserveFor(count));
    for (std::size_t i = 0; i < count; ++i) numbers.push_back(next<Number>(what));
    lines_.expectEndOfLine();
    return numbers;
  }

  void readPoints() {
    if (!mesh_.nodes.empty()) throw lines_.wrong("a second POINTS section");
    const std::size_t count = lines_.takeCount("the number of points");
    lines_.takeWord();  // float or double: text is read as double
    lines_.expectEndOfLine();
    const std::vector<double> x = readNumbers<double>(3 * count, "a coordinate");
    for (std::size_t i = 0; i < x.size(); i += 3)
      mesh_.nodes.emplace_back(toMetres(x[i], metres_per_unit_),
                               toMetres(x[i + 1], metres_per_unit_),
                               toMetres(x[i + 2], metres_per_unit_));
  }

  /// Versions before 5 write every cell as its number of nodes and its nodes, later ones all
  /// offsets and then all nodes.
  void readCells() {
    if (!offsets_.empty()) throw lines_.wrong("a second CELLS section");
    const std::size_t count = lines_.takeCount("the number of cells");
    const std::size_t size = lines_.takeCount("the size of the cells");
    lines_.expectEndOfLine();
    lines_.advanceIn("CELLS");
    if (lines_.rest().starts_with("OFFSETS")) {
      while (!lines_.atEndOfLine()) lines_.takeWord();
      offsets_ = readNumbers<std::int64_t>(count, "an offset");
      lines_.advanceIn("CELLS");
      if (lines_.takeWord() != "CONNECTIVITY")
        throw lines_.wrong("CONNECTIVITY is expected after OFFSETS");
      while (!lines_.atEndOfLine()) lines_.takeWord();
      cell_nodes_ = readNumbers<std::int64_t>(size, "a node");
    } else {
      // As version 5 has them, so that the rest need not know the version.
      offsets_ = {0};
      for (std::size_t cell = 0; cell < count; ++cell) {
        const auto nodes = next<std::int64_t>("the number of nodes of a cell");
        for (std::int64_t i = 0; i < nodes; ++i)
          cell_nodes_.push_back(next<std::int64_t>("a node"));
        offsets_.push_back(static_cast<std::int64_t>(cell_nodes_.size()));
      }
      lines_.expectEndOfLine();
      if (size != count + cell_nodes_.size())
        throw lines_.wrong("the cells were announced with {} numbers and have {}", size,
                           count + cell_nodes_.size());
    }
    checkOffsets();
  }

  void checkOffsets() {
    const auto n_nodes = static_cast<std::int64_t>(cell_nodes_.size());
    if (offsets_.empty() || offsets_.front() != 0 || offsets_.back() != n_nodes ||
        !std::ranges::is_sorted(offsets_))
      throw lines_.wrong("the offsets of the cells do not ascend from 0 to their {} nodes",
                         n_nodes);
    for (const std::int64_t node : cell_nodes_)
      if (node < 0 || node >= static_cast<std::int64_t>(mesh_.nodes.size()))
        throw lines_.wrong("a cell uses point {}, the file has {} before its CELLS", node,
                           mesh_.nodes.size());
  }

  void readField() {
    lines_.takeWord();
    const std::size_t arrays = lines_.takeCount("the number of arrays");
    lines_.expectEndOfLine();
    for (std::size_t i = 0; i < arrays; ++i) {
      lines_.advanceIn("FIELD");
      std::string name(lines_.takeWord());
      // VTK puts it between two arrays.
      if (name == "METADATA") {
        lines_.skipToBlankLine();
        lines_.advanceIn("FIELD");
        name = lines_.takeWord();
      }
      const std::size_t components = lines_.takeCount("the number of components");
      const std::size_t tuples = lines_.takeCount("the number of tuples");
      const std::string type(lines_.takeWord());
      lines_.expectEndOfLine();
      readArray(name, type, components, tuples);
    }
  }

  void readAttribute(const std::string& keyword) {
    const std::string name(lines_.takeWord());
    if (keyword == "LOOKUP_TABLE") {
      const std::size_t count = lines_.takeCount("the size of the table");
      readNumbers<double>(4 * count, "a colour");
      return;
    }
    const std::string type(lines_.takeWord());
    std::size_t components = 3;
    if (keyword == "SCALARS") {
      components = lines_.atEndOfLine() ? 1 : lines_.takeCount("the number of components");
      lines_.expectEndOfLine();
      lines_.advanceIn("SCALARS");
      if (lines_.takeWord() != "LOOKUP_TABLE")
        throw lines_.wrong("LOOKUP_TABLE is expected after SCALARS");
      lines_.takeWord();
    } else if (keyword == "TENSORS") {
      components = 9;
    } else if (keyword != "VECTORS" && keyword != "NORMALS") {
      throw lines_.wrong("\"{}\" where a section is expected", keyword);
    }
    lines_.expectEndOfLine();
    readArray(name, type, components, tuples_);
  }

  void readArray(const std::string& name, const std::string& type, std::size_t components,
                 std::size_t tuples) {
    // FIELD arrays before CELL_DATA or of another length belong to nothing that is read.
    const bool of_cells = in_cell_data_ && tuples == types_.size();
    const bool integer = type == "int" || type == "long" || type == "short" || type == "char" ||
                         type.starts_with("unsigned") || type.starts_with("vtkid") ||
                         type == "vtktypeint64";
    if (of_cells && name == "region" && integer && components == 1) {
      regions_ = readNumbers<std::int64_t>(tuples, "the number of a region");
    } else if (of_cells && components == 3 && type != "string") {
      std::vector<Eigen::Vector3d>& vectors = vectors_[name];
      vectors.clear();
      for (std::size_t i = 0; i < tuples; ++i) {
        Eigen::Vector3d vector;
        for (double& component : vector) {
          component = next<double>("a component");
          if (!std::isfinite(component)) throw lines_.wrong("a component that is not finite");
        }
        vectors.push_back(vector);
      }
    } else {
      for (std::size_t i = 0; i < components * tuples; ++i) {
        if (lines_.atEndOfLine()) lines_.advanceIn(name);
        lines_.takeWord();
      }
    }
    lines_.expectEndOfLine();
  }

  void takeTetrahedra() {
    PALPATE_ASSERT(offsets_.size() == types_.size() + 1, "read() refuses other sections");
    for (std::size_t cell = 0; cell < types_.size(); ++cell) {
      const int type = types_[cell];
      const bool quadratic = type == vtk_quadratic_tetra;
      if (type != vtk_tetra && !quadratic) {
        if (std::find(std::begin(flat_cells), std::end(flat_cells), type) == std::end(flat_cells))
          throw badInput(
              "{}: cell {} has VTK's type {}: "
              "volume cells must be tetrahedra of type 10 or 24 (4 or 10 nodes)",
              lines_.source(), cell, type);
        continue;
      }
      const std::int64_t begin = offsets_[cell], count = offsets_[cell + 1] - begin;
      if (count != (quadratic ? 10 : 4))
        throw badInput("{}: cell {} of type {} has {} nodes", lines_.source(), cell, type, count);
      std::array<std::int32_t, 10> nodes{};
      for (std::int64_t i = 0; i < count; ++i)
        nodes[i] = static_cast<std::int32_t>(cell_nodes_[begin + i]);
      if (const std::string edge = quadratic ? curvedEdge(mesh_.nodes, nodes) : ""; !edge.empty())
        throw badInput("{}: cell {}: {}", lines_.source(), cell, edge);
      mesh_.tetrahedra.push_back({nodes[0], nodes[1], nodes[2], nodes[3]});
      cells_.push_back(cell);
    }
  }

  void takeCellData() {
    for (std::size_t e = 0; e < cells_.size() && !regions_.empty(); ++e)
      mesh_.element_groups[std::to_string(regions_[cells_[e]])].push_back(
          static_cast<std::int32_t>(e));
    for (const auto& [name, vectors] : vectors_)
      for (const std::size_t cell : cells_) mesh_.element_vectors[name].push_back(vectors[cell]);
  }

  TextLines lines_;
  double metres_per_unit_;
  Mesh mesh_;
  std::vector<std::int64_t> offsets_,
      cell_nodes_;  ///< nodes of cell c: offsets_[c] to offsets_[c + 1]
  std::vector<int> types_;
  std::vector<std::size_t> cells_;  ///< per tetrahedron, its cell
  bool in_cell_data_ = false;
  std::size_t tuples_ = 0;
  std::vector<std::int64_t> regions_;                            ///< per cell
  std::map<std::string, std::vector<Eigen::Vector3d>> vectors_;  ///< per cell
};

}  // namespace

Mesh readVtk(const std::filesystem::path& file, double metres_per_unit) {
  return parseVtk(readText(file, "mesh"), file.string(), metres_per_unit);
}

Mesh parseVtk(std::string text, const std::string& source, double metres_per_unit) {
  return VtkText(TextLines(std::move(text), source), metres_per_unit).read();
}

}  // namespace palpate
