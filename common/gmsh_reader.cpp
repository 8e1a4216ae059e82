#include "common/gmsh_reader.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include "common/error.hpp"
#include "common/text_file.hpp"

namespace palpate {
namespace {

/// A text line by line, and a line token by token. Blank lines are skipped; errors carry file and line.
class Lines {
 public:
  Lines(std::string text, std::string source) : text_(std::move(text)), source_(std::move(source)) {}

  /// Goes to the next line that is not blank; false at the end of the text.
  bool advance() {
    while (at_ < text_.size()) {
      const std::size_t end = std::min(text_.find('\n', at_), text_.size());
      rest_ = std::string_view(text_).substr(at_, end - at_);
      at_ = end + 1;
      ++number_;
      skipBlanks();
      while (!rest_.empty() && isBlank(rest_.back())) rest_.remove_suffix(1);
      if (!rest_.empty()) return true;
    }
    rest_ = {};
    return false;
  }

  /// advance(), or an error that the file is truncated inside `section`.
  void advanceIn(std::string_view section) {
    if (!advance())
      throw badInput("{}:{}: the file is truncated: it ends inside {}", source_, number_, section);
  }

  std::string_view rest() const { return rest_; }
  std::size_t number() const { return number_; }
  bool atEndOfLine() const { return rest_.empty(); }

  /// The next number of the line; `what` names it in errors.
  template <class Number>
  Number take(const char* what) {
    const std::string_view token = takeToken();
    if (token.empty()) throw wrong("the line ends where {} is expected", what);
    const std::string_view digits = token.front() == '+' ? token.substr(1) : token;
    Number value{};
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc() || end != digits.data() + digits.size())
      throw wrong("\"{}\" where {} is expected", token, what);
    return value;
  }

  double takeCoordinate() {
    const auto value = take<double>("a coordinate");
    if (!std::isfinite(value)) throw wrong("a coordinate that is not finite");
    return value;
  }

  void expectEndOfLine() const {
    if (!rest_.empty()) throw wrong("\"{}\" at the end of the line is too much", rest_);
  }

  template <class... Args>
  Error wrong(fmt::format_string<Args...> format, Args&&... args) const {
    return badInput("{}:{}: {}", source_, number_, fmt::format(format, std::forward<Args>(args)...));
  }

  std::size_t size() const { return text_.size(); }
  const std::string& source() const { return source_; }

 private:
  static bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

  void skipBlanks() {
    while (!rest_.empty() && isBlank(rest_.front())) rest_.remove_prefix(1);
  }

  std::string_view takeToken() {
    const auto* end = std::find_if(rest_.begin(), rest_.end(), isBlank);
    const std::string_view token = rest_.substr(0, end - rest_.begin());
    rest_.remove_prefix(token.size());
    skipBlanks();
    return token;
  }

  std::string text_;
  std::string source_;
  std::size_t at_ = 0;
  std::size_t number_ = 0;
  std::string_view rest_;
};

/// Gmsh's element types: dimension and number of nodes.
struct ElementType {
  int dimension;
  int nodes;
};

/// Types 1 to 31 in Gmsh's numbering (its manual, "Low order elements" and "High-order elements").
constexpr std::array<ElementType, 32> element_types = {
    {{-1, 0}, {1, 2},  {2, 3},  {2, 4},  {3, 4}, {3, 8}, {3, 6},  {3, 5},  {1, 3},  {2, 6}, {2, 9},
     {3, 10}, {3, 27}, {3, 18}, {3, 14}, {0, 1}, {2, 8}, {3, 20}, {3, 15}, {3, 13}, {2, 9}, {2, 10},
     {2, 12}, {2, 15}, {2, 15}, {2, 21}, {1, 4}, {1, 5}, {1, 6},  {3, 20}, {3, 35}, {3, 56}}};
constexpr int tetrahedron_4 = 4;

constexpr std::array<const char*, 4> dimension_words = {"point", "curve", "surface", "volume"};

/// (dimension, tag) of a physical group or of an entity: Gmsh counts each dimension on its own.
using Key = std::pair<int, std::int64_t>;

/// 0-based numbers of the nodes that the file names by tags of its own.
class NodeTags {
 public:
  void add(std::int64_t tag) { tags_.emplace_back(tag, static_cast<std::int32_t>(tags_.size())); }
  std::size_t size() const { return tags_.size(); }

  /// Call after the last add. The first tag that was given twice, if one was.
  std::optional<std::int64_t> sort() {
    std::sort(tags_.begin(), tags_.end());
    for (std::size_t i = 1; i < tags_.size(); ++i)
      if (tags_[i].first == tags_[i - 1].first) return tags_[i].first;
    return std::nullopt;
  }

  std::optional<std::int32_t> find(std::int64_t tag) const {
    const auto at = std::lower_bound(tags_.begin(), tags_.end(), std::pair{tag, std::int32_t{0}});
    if (at == tags_.end() || at->first != tag) return std::nullopt;
    return at->second;
  }

 private:
  std::vector<std::pair<std::int64_t, std::int32_t>> tags_;
};

class Reader {
 public:
  Reader(Lines lines, double metres_per_unit) : lines_(std::move(lines)), metres_per_unit_(metres_per_unit) {}

  Mesh read() {
    readFormat();
    while (lines_.advance()) readSection();
    if (!have_nodes_)
      throw badInput("{}: there is no $Nodes section: the file is truncated", lines_.source());
    if (!have_elements_)
      throw badInput("{}: there is no $Elements section: the file is truncated", lines_.source());
    if (!entity_blocks_) dropRepeatedTetrahedra();
    nameGroups();
    finishMesh(mesh_, lines_.source());
    return std::move(mesh_);
  }

 private:
  void readFormat() {
    if (!lines_.advance()) throw badInput("{}: the file is empty", lines_.source());
    if (lines_.rest() != "$MeshFormat")
      throw lines_.wrong(
          "this is not a Gmsh .msh file of version 2.2 or 4.1: its first line is not $MeshFormat");
    lines_.advanceIn("$MeshFormat");
    const auto version = lines_.take<double>("the version");
    const auto binary = lines_.take<int>("the file type");
    if (version != 2.2 && version != 4.1)
      throw lines_.wrong(
          "Gmsh format version {} is not read; convert with: gmsh {} -save -format msh41 -o NEW.msh", version,
          lines_.source());
    if (binary != 0)
      throw lines_.wrong("the file is binary; convert with: gmsh {} -save -format msh41 -o NEW.msh (no -bin)",
                         lines_.source());
    entity_blocks_ = version == 4.1;
    endSection("$MeshFormat");
  }

  void readSection() {
    const std::string section(lines_.rest());
    if (section == "$PhysicalNames") {
      readPhysicalNames();
    } else if (section == "$Entities") {
      readEntities();
    } else if (section == "$Nodes") {
      if (have_nodes_) throw lines_.wrong("a second $Nodes section");
      entity_blocks_ ? readNodeBlocks() : readNodes();
      finishNodes();
    } else if (section == "$Elements") {
      if (!have_nodes_) throw lines_.wrong("$Elements before $Nodes");
      if (have_elements_) throw lines_.wrong("a second $Elements section");
      entity_blocks_ ? readElementBlocks() : readElements();
      have_elements_ = true;
    } else if (section == "$PartitionedEntities") {
      throw lines_.wrong("the mesh is partitioned; save it without partitions (gmsh: Mesh > Unpartition)");
    } else if (section.starts_with("$") && !section.starts_with("$End")) {
      skipSection(section);
      return;
    } else {
      throw lines_.wrong("\"{}\" where a section is expected", section);
    }
    endSection(section);
  }

  void endSection(const std::string& section) {
    lines_.advanceIn(section);
    if (lines_.rest() != "$End" + section.substr(1))
      throw lines_.wrong(
          "\"{}\" where $End{} is expected: more lines than were announced, or the file is truncated",
          lines_.rest(), section.substr(1));
  }

  void skipSection(const std::string& section) {
    const std::string end = "$End" + section.substr(1);
    do lines_.advanceIn(section);
    while (lines_.rest() != end);
  }

  /// A count that is announced. It is not believed before its lines were seen: only reserveFor() may use it.
  std::size_t takeCount(const char* what) {
    const auto count = lines_.take<std::int64_t>(what);
    if (count < 0 || count > std::numeric_limits<std::int32_t>::max())
      throw lines_.wrong("{} is {}, which cannot be", what, count);
    return static_cast<std::size_t>(count);
  }

  /// No more than the file can hold, whatever it announces: the shortest line of an item is "1 0 0 0" and its
  /// end.
  std::size_t reserveFor(std::size_t announced) const { return std::min(announced, lines_.size() / 8); }

  void readPhysicalNames() {
    lines_.advanceIn("$PhysicalNames");
    const std::size_t count = takeCount("the number of physical names");
    for (std::size_t i = 0; i < count; ++i) {
      lines_.advanceIn("$PhysicalNames");
      const Key key = {takeDimension(), lines_.take<std::int64_t>("the number of a physical group")};
      const std::string_view quoted = lines_.rest();
      if (quoted.size() < 3 || quoted.front() != '"' || quoted.back() != '"')
        throw lines_.wrong("a name in quotes is expected after the number of the physical group");
      physical_names_[key] = quoted.substr(1, quoted.size() - 2);
    }
  }

  int takeDimension() {
    const auto dimension = lines_.take<int>("a dimension");
    if (dimension < 0 || dimension > 3)
      throw lines_.wrong("dimension {} where 0 to 3 is expected", dimension);
    return dimension;
  }

  void readEntities() {
    if (!entity_blocks_) throw lines_.wrong("$Entities in a file of version 2.2");
    lines_.advanceIn("$Entities");
    std::array<std::size_t, 4> counts;
    for (std::size_t& count : counts) count = takeCount("the number of entities");
    for (int dimension = 0; dimension < 4; ++dimension)
      for (std::size_t i = 0; i < counts[dimension]; ++i) {
        lines_.advanceIn("$Entities");
        const Key entity = {dimension, lines_.take<std::int64_t>("the tag of an entity")};
        const int extents = dimension == 0 ? 3 : 6;  // its position, or its bounding box
        for (int n = 0; n < extents; ++n) lines_.take<double>("the extent of an entity");
        const std::size_t n_physical = takeCount("the number of physical groups of an entity");
        for (std::size_t n = 0; n < n_physical; ++n)
          physical_of_entity_[entity].insert(
              std::abs(lines_.take<std::int64_t>("the number of a physical group")));
      }
  }

  void addNode() {
    const double x = lines_.takeCoordinate(), y = lines_.takeCoordinate(), z = lines_.takeCoordinate();
    mesh_.nodes.emplace_back(toMetres(x, metres_per_unit_), toMetres(y, metres_per_unit_),
                             toMetres(z, metres_per_unit_));
  }

  void readNodes() {
    lines_.advanceIn("$Nodes");
    const std::size_t count = takeCount("the number of nodes");
    lines_.expectEndOfLine();
    mesh_.nodes.reserve(reserveFor(count));
    for (std::size_t i = 0; i < count; ++i) {
      lines_.advanceIn("$Nodes");
      tags_.add(lines_.take<std::int64_t>("the number of a node"));
      addNode();
      lines_.expectEndOfLine();
    }
  }

  void readNodeBlocks() {
    lines_.advanceIn("$Nodes");
    const std::size_t n_blocks = takeCount("the number of entity blocks");
    const std::size_t n_nodes = takeCount("the number of nodes");
    mesh_.nodes.reserve(reserveFor(n_nodes));
    for (std::size_t block = 0; block < n_blocks; ++block) {
      lines_.advanceIn("$Nodes");
      takeDimension();
      lines_.take<std::int64_t>("the tag of an entity");
      const bool parametric = lines_.take<int>("0 or 1 for parametric") != 0;
      const std::size_t count = takeCount("the number of nodes of a block");
      lines_.expectEndOfLine();
      for (std::size_t i = 0; i < count; ++i) {
        lines_.advanceIn("$Nodes");
        tags_.add(lines_.take<std::int64_t>("the tag of a node"));
        lines_.expectEndOfLine();
      }
      for (std::size_t i = 0; i < count; ++i) {
        lines_.advanceIn("$Nodes");
        addNode();
        if (!parametric) lines_.expectEndOfLine();  // else coordinates on the entity follow: of no use here
      }
    }
    if (mesh_.nodes.size() != n_nodes)
      throw lines_.wrong("{} nodes were announced, the blocks hold {}", n_nodes, mesh_.nodes.size());
  }

  void finishNodes() {
    if (const auto twice = tags_.sort()) throw lines_.wrong("node {} is defined twice", *twice);
    have_nodes_ = true;
  }

  std::int32_t takeNode() {
    const auto tag = lines_.take<std::int64_t>("a node");
    const auto node = tags_.find(tag);
    if (!node) throw lines_.wrong("an element uses node {}, which is not in $Nodes", tag);
    return *node;
  }

  ElementType takeElementType(int& type) {
    type = lines_.take<int>("an element type");
    if (type < 1 || type >= static_cast<int>(element_types.size()))
      throw lines_.wrong("element type {} is not known", type);
    const ElementType& found = element_types[type];
    if (found.dimension == 3 && type != tetrahedron_4)
      throw lines_.wrong(
          "an element of Gmsh's type {} with {} nodes: volume elements must be 4-node tetrahedra (mesh "
          "without recombination, and with -order 1)",
          type, found.nodes);
    return found;
  }

  /// The nodes of an element of the line, into the mesh and into the nodes of `group`.
  void addElement(int type, const Key& group) {
    const int count = element_types[type].nodes;
    std::array<std::int32_t, 4> first_four{};
    std::vector<std::int32_t>& group_nodes = nodes_of_[group];
    for (int i = 0; i < count; ++i) {
      const std::int32_t node = takeNode();
      if (i < 4) first_four[i] = node;
      group_nodes.push_back(node);
    }
    lines_.expectEndOfLine();
    if (type != tetrahedron_4) return;
    mesh_.tetrahedra.push_back(first_four);
    group_of_tetrahedron_.push_back(group.second);
  }

  void readElements() {
    lines_.advanceIn("$Elements");
    const std::size_t count = takeCount("the number of elements");
    lines_.expectEndOfLine();
    mesh_.tetrahedra.reserve(reserveFor(count));
    for (std::size_t i = 0; i < count; ++i) {
      lines_.advanceIn("$Elements");
      lines_.take<std::int64_t>("the number of an element");
      int type = 0;
      const int dimension = takeElementType(type).dimension;
      const std::size_t n_tags = takeCount("the number of tags");
      std::int64_t physical = 0;  // no group
      for (std::size_t n = 0; n < n_tags; ++n) {
        const auto tag = lines_.take<std::int64_t>("a tag");
        if (n == 0) physical = std::abs(tag);  // negative where the orientation was turned
      }
      addElement(type, {dimension, physical});
    }
  }

  void readElementBlocks() {
    lines_.advanceIn("$Elements");
    const std::size_t n_blocks = takeCount("the number of entity blocks");
    const std::size_t n_elements = takeCount("the number of elements");
    mesh_.tetrahedra.reserve(reserveFor(n_elements));
    std::size_t read = 0;
    for (std::size_t block = 0; block < n_blocks; ++block) {
      lines_.advanceIn("$Elements");
      const Key entity = {takeDimension(), lines_.take<std::int64_t>("the tag of an entity")};
      int type = 0;
      if (takeElementType(type).dimension != entity.first)
        throw lines_.wrong("element type {} in a block of dimension {}", type, entity.first);
      const std::size_t count = takeCount("the number of elements of a block");
      lines_.expectEndOfLine();
      for (std::size_t i = 0; i < count; ++i, ++read) {
        lines_.advanceIn("$Elements");
        lines_.take<std::int64_t>("the tag of an element");
        addElement(type, entity);
      }
    }
    if (read != n_elements)
      throw lines_.wrong("{} elements were announced, the blocks hold {}", n_elements, read);
  }

  /// Version 2.2 writes a tetrahedron once per physical group that it is in. The same one twice in one group
  /// is an error of the mesh, and finishMesh says so.
  void dropRepeatedTetrahedra() {
    std::vector<std::tuple<Tetrahedron, std::int64_t, std::size_t>> order;
    order.reserve(mesh_.tetrahedra.size());
    for (std::size_t e = 0; e < mesh_.tetrahedra.size(); ++e) {
      Tetrahedron sorted = mesh_.tetrahedra[e];
      std::sort(sorted.begin(), sorted.end());
      order.emplace_back(sorted, group_of_tetrahedron_[e], e);
    }
    std::sort(order.begin(), order.end());
    std::vector<bool> repeated(order.size(), false);
    for (std::size_t i = 1; i < order.size(); ++i) {
      const auto& [nodes, group, element] = order[i];
      const auto& [previous_nodes, previous_group, previous_element] = order[i - 1];
      repeated[element] = nodes == previous_nodes && group != previous_group;
    }
    std::size_t e = 0;
    std::erase_if(mesh_.tetrahedra, [&](const Tetrahedron&) { return repeated[e++]; });
  }

  void nameGroups() {
    for (const auto& [key, nodes] : nodes_of_) {
      const auto& [dimension, tag] = key;
      if (!entity_blocks_) {
        if (tag != 0) addToGroup(key, nodes);
        continue;
      }
      const auto physical = physical_of_entity_.find(key);
      if (physical == physical_of_entity_.end()) continue;
      for (const std::int64_t number : physical->second) addToGroup({dimension, number}, nodes);
    }
  }

  void addToGroup(const Key& group, const std::vector<std::int32_t>& nodes) {
    const auto named = physical_names_.find(group);
    std::vector<std::int32_t>& all =
        mesh_.node_groups[named != physical_names_.end()
                              ? named->second
                              : fmt::format("{} {}", dimension_words[group.first], group.second)];
    all.insert(all.end(), nodes.begin(), nodes.end());
  }

  Lines lines_;
  double metres_per_unit_;
  bool entity_blocks_ = false;  ///< version 4.1
  bool have_nodes_ = false, have_elements_ = false;
  Mesh mesh_;
  NodeTags tags_;
  std::map<Key, std::string> physical_names_;
  std::map<Key, std::set<std::int64_t>> physical_of_entity_;
  std::map<Key, std::vector<std::int32_t>>
      nodes_of_;  ///< of entities in version 4.1, of physical groups in 2.2
  std::vector<std::int64_t> group_of_tetrahedron_;
};

}  // namespace

Mesh readGmsh(const std::filesystem::path& file, double metres_per_unit) {
  return parseGmsh(readText(file, "mesh"), file.string(), metres_per_unit);
}

Mesh parseGmsh(std::string text, const std::string& source, double metres_per_unit) {
  return Reader(Lines(std::move(text), source), metres_per_unit).read();
}

}  // namespace palpate
