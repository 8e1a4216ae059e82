#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <tuple>
#include <unordered_map>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/base/text_lines.hpp"
#include "common/base/units.hpp"
#include "common/base/whole_file.hpp"
#include "common/mesh/mesh_reader.hpp"
#include "common/mesh/self_intersections.hpp"

namespace palpate {
namespace {

/// Dimension and number of nodes of a Gmsh element type.
struct ElementType {
  int dimension;
  int nodes;
};

/// Element types by number, 1 to 31 (Gmsh's manual, "Low order elements" and "High-order
/// elements").
constexpr std::array<ElementType, 32> element_types = {
    {{-1, 0}, {1, 2},  {2, 3},  {2, 4},  {3, 4}, {3, 8}, {3, 6},  {3, 5},  {1, 3},  {2, 6}, {2, 9},
     {3, 10}, {3, 27}, {3, 18}, {3, 14}, {0, 1}, {2, 8}, {3, 20}, {3, 15}, {3, 13}, {2, 9}, {2, 10},
     {2, 12}, {2, 15}, {2, 15}, {2, 21}, {1, 4}, {1, 5}, {1, 6},  {3, 20}, {3, 35}, {3, 56}}};
constexpr int tetrahedron_4 = 4, tetrahedron_10 = 11;
/// For each node of a 10-node tetrahedron in the order of VTK and tetrahedron_edges, its index in
/// Gmsh's order.
constexpr std::array<int, 10> gmsh_order = {0, 1, 2, 3, 4, 5, 6, 7, 9, 8};

constexpr std::array<const char*, 4> dimension_words = {"point", "curve", "surface", "volume"};

/// Dimension and tag of a physical group or entity. Both are needed, because Gmsh numbers each
/// dimension separately.
using Key = std::pair<int, std::int64_t>;

/// 0-based number of each node or tetrahedron by its tag in the file.
using NumberOfTag = std::unordered_map<std::int64_t, std::int32_t>;

class GmshText {
 public:
  GmshText(TextLines lines, double metres_per_unit)
      : lines_(std::move(lines)), metres_per_unit_(metres_per_unit) {}

  Mesh read() {
    readFormat();
    while (lines_.advance()) readSection();
    if (!have_nodes_)
      throw badInput("{}: there is no $Nodes section: the file is truncated", lines_.source());
    if (!have_elements_)
      throw badInput("{}: there is no $Elements section: the file is truncated", lines_.source());
    nameGroups();
    // Convert to metres last, because errors give positions in the unit of the file.
    finishMesh(mesh_, lines_.source());
    refuseOverlaps(mesh_, lines_.source());
    for (Eigen::Vector3d& node : mesh_.nodes)
      node = node.unaryExpr([this](double x) { return toMetres(x, metres_per_unit_); });
    return std::move(mesh_);
  }

 private:
  void readFormat() {
    if (!lines_.advance()) throw badInput("{}: the file is empty", lines_.source());
    if (lines_.rest() != "$MeshFormat")
      throw lines_.wrong(
          "this is not a Gmsh .msh file of version 2.2 or 4.1: its first line is not $MeshFormat; "
          "convert other formats with palpate mesh");
    section_ = lines_.rest();
    nextLine();
    const auto version = lines_.take<double>("the version");
    const auto binary = lines_.take<int>("the file type");
    if (version != 2.2 && version != 4.1)
      throw lines_.wrong(
          "Gmsh format version {} is not supported; convert it with: palpate mesh {} -o NEW.msh",
          version, shellWord(lines_.source()));
    if (binary != 0)
      throw lines_.wrong("the file is binary; convert it with: palpate mesh {} -o NEW.msh",
                         shellWord(lines_.source()));
    entity_blocks_ = version == 4.1;
    endSection();
  }

  void readSection() {
    section_ = lines_.rest();
    if (section_ == "$PhysicalNames") {
      readPhysicalNames();
    } else if (section_ == "$Entities") {
      readEntities();
    } else if (section_ == "$Nodes") {
      if (have_nodes_) throw lines_.wrong("a second $Nodes section");
      entity_blocks_ ? readNodeBlocks() : readNodes();
      have_nodes_ = true;
    } else if (section_ == "$Elements") {
      if (!have_nodes_) throw lines_.wrong("$Elements before $Nodes");
      if (have_elements_) throw lines_.wrong("a second $Elements section");
      entity_blocks_ ? readElementBlocks() : readElements();
      // Only version 2.2 repeats elements; version 4.1 lists each element once.
      if (!entity_blocks_) dropRepeatedTetrahedra();
      have_elements_ = true;
    } else if (section_ == "$ElementData") {
      if (!have_elements_) throw lines_.wrong("$ElementData before $Elements");
      // Refuse repeated numbers only in a file with element data: in version 2.2, the copies of an
      // element may share a number.
      if (tetrahedron_tag_twice_)
        throw lines_.wrong("$ElementData cannot be assigned: two tetrahedra have the number {}",
                           *tetrahedron_tag_twice_);
      return readElementData();
    } else if (section_ == "$PartitionedEntities") {
      throw lines_.wrong(
          "the mesh is partitioned; save it without partitions (gmsh: Mesh > Unpartition)");
    } else if (section_ == "$ParametricNodes") {
      throw lines_.wrong("parametric nodes are not supported; run: palpate mesh {} -o NEW.msh",
                         shellWord(lines_.source()));
    } else if (section_.starts_with("$") && !section_.starts_with("$End")) {
      return skipSection();
    } else {
      throw lines_.wrong("\"{}\" where a section is expected", section_);
    }
    endSection();
  }

  void endSection() {
    nextLine();
    if (lines_.rest() != "$End" + section_.substr(1))
      throw lines_.wrong(
          "\"{}\" where $End{} is expected: there are more lines than announced, or the file is "
          "truncated",
          lines_.rest(), section_.substr(1));
  }

  void skipSection() {
    const std::string end = "$End" + section_.substr(1);
    do nextLine();
    while (lines_.rest() != end);
  }

  void nextLine() { lines_.advanceIn(section_); }

  /// Advances over the next `count` lines and calls read() for each.
  template <class Read>
  void eachLine(std::size_t count, Read read) {
    for (; count > 0; --count) {
      nextLine();
      read();
    }
  }

  /// Reads a tag, the number of a node, element, entity or group in the file.
  std::int64_t takeTag(const char* what) { return lines_.take<std::int64_t>(what); }

  /// Reads the tag of a physical group. The number in the file is negative if Gmsh reversed the
  /// orientation of the group.
  std::int64_t takeGroup() {
    const std::int64_t group = takeTag("the number of a physical group");
    if (group == std::numeric_limits<std::int64_t>::min())
      throw lines_.wrong("{} is not the number of a physical group", group);
    return std::abs(group);
  }

  int takeDimension() {
    const auto dimension = lines_.take<int>("a dimension");
    if (dimension < 0 || dimension > 3)
      throw lines_.wrong("dimension {} where 0 to 3 is expected", dimension);
    return dimension;
  }

  void readPhysicalNames() {
    nextLine();
    eachLine(lines_.takeCount("the number of physical names"), [&] {
      const Key key = {takeDimension(), takeTag("the number of a physical group")};
      const std::string_view quoted = lines_.rest();
      if (quoted.size() < 3 || quoted.front() != '"' || quoted.back() != '"')
        throw lines_.wrong("a name in quotes is expected after the number of the physical group");
      physical_names_[key] = quoted.substr(1, quoted.size() - 2);
    });
  }

  void readEntities() {
    if (!entity_blocks_) throw lines_.wrong("$Entities in a file of version 2.2");
    nextLine();
    std::array<std::size_t, 4> counts;
    for (std::size_t& count : counts) count = lines_.takeCount("the number of entities");
    for (int dimension = 0; dimension < 4; ++dimension)
      eachLine(counts[dimension], [&] {
        const Key entity = {dimension, takeTag("the tag of an entity")};
        // A point has a position, any other entity a bounding box.
        const int extents = dimension == 0 ? 3 : 6;
        for (int n = 0; n < extents; ++n) lines_.take<double>("the extent of an entity");
        const std::size_t n_physical =
            lines_.takeCount("the number of physical groups of an entity");
        for (std::size_t n = 0; n < n_physical; ++n)
          physical_of_entity_[entity].insert(takeGroup());
      });
  }

  Eigen::Vector3d takeVector(const char* what) {
    Eigen::Vector3d vector;
    for (double& component : vector) component = lines_.takeFinite(what);
    return vector;
  }

  void addNodeTag(std::int64_t tag) {
    const auto number = static_cast<std::int32_t>(number_of_node_.size());
    if (!number_of_node_.emplace(tag, number).second)
      throw lines_.wrong("node {} is defined twice", tag);
  }

  void readNodes() {
    nextLine();
    const std::size_t count = lines_.takeCount("the number of nodes");
    lines_.expectEndOfLine();
    mesh_.nodes.reserve(lines_.reserveFor(count));
    eachLine(count, [&] {
      addNodeTag(takeTag("the number of a node"));
      mesh_.nodes.push_back(takeVector("a coordinate"));
      lines_.expectEndOfLine();
    });
  }

  void readNodeBlocks() {
    nextLine();
    const std::size_t n_blocks = lines_.takeCount("the number of entity blocks");
    const std::size_t n_nodes = lines_.takeCount("the number of nodes");
    mesh_.nodes.reserve(lines_.reserveFor(n_nodes));
    eachLine(n_blocks, [&] {
      takeDimension();
      takeTag("the tag of an entity");
      const bool parametric = lines_.take<int>("0 or 1 for parametric") != 0;
      const std::size_t count = lines_.takeCount("the number of nodes of a block");
      lines_.expectEndOfLine();
      eachLine(count, [&] {
        addNodeTag(takeTag("the tag of a node"));
        lines_.expectEndOfLine();
      });
      eachLine(count, [&] {
        mesh_.nodes.push_back(takeVector("a coordinate"));
        // In a parametric block, parameters on the entity follow, which are ignored.
        if (!parametric) lines_.expectEndOfLine();
      });
    });
    if (mesh_.nodes.size() != n_nodes)
      throw lines_.wrong("{} nodes were announced, but the blocks contain {}", n_nodes,
                         mesh_.nodes.size());
  }

  std::int32_t takeNode() {
    const std::int64_t tag = takeTag("a node");
    const auto node = number_of_node_.find(tag);
    if (node == number_of_node_.end())
      throw lines_.wrong("an element uses node {}, which is not in $Nodes", tag);
    return node->second;
  }

  int takeElementType() {
    const auto type = lines_.take<int>("an element type");
    if (type < 1 || type >= static_cast<int>(element_types.size()))
      throw lines_.wrong("element type {} is not known", type);
    const ElementType& found = element_types[type];
    if (found.dimension == 3 && type != tetrahedron_4 && type != tetrahedron_10)
      throw lines_.wrong(
          "element type {} of Gmsh, with {} nodes, is not supported: volume elements must be "
          "tetrahedra with 4 or 10 nodes (mesh without recombination, and with -order 1 or 2)",
          type, found.nodes);
    return type;
  }

  /// Reads the nodes of an element from the current line and adds them to `group`. Adds a volume
  /// element to the mesh.
  void addElement(std::int64_t tag, int type, const Key& group) {
    const int count = element_types[type].nodes;
    std::array<std::int32_t, 10> first_ten{};
    std::vector<std::int32_t>& group_nodes = nodes_of_[group];
    for (int i = 0; i < count; ++i) {
      const std::int32_t node = takeNode();
      if (i < 10) first_ten[i] = node;
      group_nodes.push_back(node);
    }
    lines_.expectEndOfLine();
    if (element_types[type].dimension == 3) addTetrahedron(tag, type, first_ten, group);
  }

  /// Adds a tetrahedron by its corners. Mid-edge nodes are dropped, because addMidEdgeNodes() makes
  /// new ones in the middle of each edge. Error if a dropped one lies elsewhere.
  void addTetrahedron(std::int64_t tag, int type, const std::array<std::int32_t, 10>& nodes,
                      const Key& group) {
    if (type == tetrahedron_10) {
      std::array<std::int32_t, 10> ordered;
      for (int i = 0; i < 10; ++i) ordered[i] = nodes[gmsh_order[i]];
      if (const std::string edge = curvedEdge(mesh_.nodes, ordered); !edge.empty())
        throw lines_.wrong("element {}: {} (gmsh: -setnumber Mesh.SecondOrderLinear 1)", tag, edge);
    }
    const auto number = static_cast<std::int32_t>(mesh_.tetrahedra.size());
    tetrahedra_of_[group].push_back(number);
    mesh_.tetrahedra.push_back({nodes[0], nodes[1], nodes[2], nodes[3]});
    group_of_tetrahedron_.push_back(group.second);
    if (!number_of_tetrahedron_.emplace(tag, number).second) tetrahedron_tag_twice_ = tag;
  }

  void readElements() {
    nextLine();
    const std::size_t count = lines_.takeCount("the number of elements");
    lines_.expectEndOfLine();
    mesh_.tetrahedra.reserve(lines_.reserveFor(count));
    eachLine(count, [&] {
      const std::int64_t tag = takeTag("the number of an element");
      const int type = takeElementType();
      const std::size_t n_tags = lines_.takeCount("the number of tags");
      const std::int64_t physical = n_tags > 0 ? takeGroup() : 0;  // 0: no group
      for (std::size_t n = 1; n < n_tags; ++n) takeTag("a tag");
      addElement(tag, type, {element_types[type].dimension, physical});
    });
  }

  void readElementBlocks() {
    nextLine();
    const std::size_t n_blocks = lines_.takeCount("the number of entity blocks");
    const std::size_t n_elements = lines_.takeCount("the number of elements");
    mesh_.tetrahedra.reserve(lines_.reserveFor(n_elements));
    std::size_t read = 0;
    eachLine(n_blocks, [&] {
      const Key entity = {takeDimension(), takeTag("the tag of an entity")};
      const int type = takeElementType();
      if (element_types[type].dimension != entity.first)
        throw lines_.wrong("element type {} in a block of dimension {}", type, entity.first);
      const std::size_t count = lines_.takeCount("the number of elements of a block");
      lines_.expectEndOfLine();
      eachLine(count, [&] { addElement(takeTag("the tag of an element"), type, entity); });
      read += count;
    });
    if (read != n_elements)
      throw lines_.wrong("{} elements were announced, but the blocks contain {}", n_elements, read);
  }

  /// Reads data with one vector per tetrahedron; the first string tag is the name of the data.
  /// Skips data that do not have three components, and later time steps of the same name.
  void readElementData() {
    const auto tags = [&](const char* what) {
      nextLine();
      std::vector<std::string> words;
      eachLine(lines_.takeCount(what), [&] { words.emplace_back(lines_.rest()); });
      return words;
    };
    // String, real and integer tags precede the values; each list begins with its length.
    const std::vector<std::string> names = tags("the number of string tags");
    tags("the number of real tags");
    nextLine();
    std::vector<std::size_t> integers;  // time step, number of components, number of elements
    eachLine(lines_.takeCount("the number of integer tags"),
             [&] { integers.push_back(lines_.takeCount("an integer tag")); });
    // Ignore further integer tags (a partition). Missing tags count as 0.
    integers.resize(3);
    const std::string name = names.empty() ? "" : unquoted(names[0]);
    if (name.empty() || integers[1] != 3 || mesh_.element_vectors.contains(name))
      return skipSection();
    std::vector<Eigen::Vector3d>& vectors = mesh_.element_vectors[name];
    vectors.assign(mesh_.tetrahedra.size(), Eigen::Vector3d::Zero());
    eachLine(integers[2], [&] {
      const auto element = number_of_tetrahedron_.find(takeTag("the number of an element"));
      const Eigen::Vector3d vector = takeVector("a component");
      lines_.expectEndOfLine();
      // A tetrahedron that version 2.2 repeats may have several numbers, and possibly only one of
      // them has a vector. If they have different vectors, the last one is used.
      if (element != number_of_tetrahedron_.end() && !vector.isZero(0))
        vectors[element->second] = vector;
    });
    endSection();
  }

  static std::string unquoted(const std::string& text) {
    const bool quoted = text.size() >= 2 && text.front() == '"' && text.back() == '"';
    return quoted ? text.substr(1, text.size() - 2) : text;
  }

  /// Removes the copies of a tetrahedron that version 2.2 lists in several physical groups. Copies
  /// within one group are kept, so that finishMesh reports them as an error.
  void dropRepeatedTetrahedra() {
    PALPATE_ASSERT(group_of_tetrahedron_.size() == mesh_.tetrahedra.size(),
                   "each tetrahedron must have a group");
    std::vector<std::tuple<Tetrahedron, std::int64_t, std::int32_t>> order;
    order.reserve(mesh_.tetrahedra.size());
    for (std::size_t e = 0; e < mesh_.tetrahedra.size(); ++e) {
      Tetrahedron sorted = mesh_.tetrahedra[e];
      std::ranges::sort(sorted);
      order.emplace_back(sorted, group_of_tetrahedron_[e], static_cast<std::int32_t>(e));
    }
    std::ranges::sort(order);
    std::vector<std::int32_t> same_as(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
      const auto& [nodes, group, element] = order[i];
      const bool repeated =
          i > 0 && nodes == std::get<0>(order[i - 1]) && group != std::get<1>(order[i - 1]);
      same_as[element] = repeated ? same_as[std::get<2>(order[i - 1])] : element;
    }
    // Keep the first copy of each tetrahedron and give it the groups of its copies.
    std::vector<std::int32_t> number(same_as.size());
    std::int32_t kept = 0;
    for (std::size_t e = 0; e < same_as.size(); ++e)
      if (same_as[e] == static_cast<std::int32_t>(e)) {
        mesh_.tetrahedra[kept] = mesh_.tetrahedra[e];
        number[e] = kept++;
      }
    mesh_.tetrahedra.resize(kept);
    for (auto& [group, elements] : tetrahedra_of_)
      for (std::int32_t& element : elements) element = number[same_as[element]];
    for (auto& [tag, element] : number_of_tetrahedron_) element = number[same_as[element]];
  }

  void nameGroups() {
    for (const auto& [key, nodes] : nodes_of_) {
      const auto& [dimension, tag] = key;
      if (!entity_blocks_) {
        // 0 means "no group" in version 2.2.
        if (tag != 0) addToGroup(key, key);
        continue;
      }
      const auto physical = physical_of_entity_.find(key);
      if (physical == physical_of_entity_.end()) continue;
      for (const std::int64_t number : physical->second) addToGroup({dimension, number}, key);
    }
    for (auto& [name, elements] : mesh_.element_groups) sortUnique(elements);
    for (const auto& [key, name] : physical_names_)
      if (!mesh_.node_groups.contains(name)) mesh_.unused_names.push_back(name);
    sortUnique(mesh_.unused_names);
  }

  /// Adds to `group` the nodes and tetrahedra that were read for `from`, an entity or a group.
  void addToGroup(const Key& group, const Key& from) {
    const auto named = physical_names_.find(group);
    const std::string name = named != physical_names_.end()
                                 ? named->second
                                 : fmt::format("{} {}", dimension_words[group.first], group.second);
    const auto add = [](std::vector<std::int32_t>& all, const std::vector<std::int32_t>& more) {
      all.insert(all.end(), more.begin(), more.end());
    };
    add(mesh_.node_groups[name], nodes_of_.at(from));
    if (group.first == 3) add(mesh_.element_groups[name], tetrahedra_of_.at(from));
  }

  TextLines lines_;
  std::string section_;  ///< current section, such as "$Nodes"
  double metres_per_unit_;
  bool entity_blocks_ = false;  ///< version 4.1
  bool have_nodes_ = false, have_elements_ = false;
  Mesh mesh_;
  NumberOfTag number_of_node_, number_of_tetrahedron_;
  std::optional<std::int64_t> tetrahedron_tag_twice_;
  std::map<Key, std::string> physical_names_;
  std::map<Key, std::set<std::int64_t>> physical_of_entity_;
  /// Nodes and tetrahedra by entity (version 4.1) or by physical group (version 2.2).
  std::map<Key, std::vector<std::int32_t>> nodes_of_, tetrahedra_of_;
  std::vector<std::int64_t> group_of_tetrahedron_;
};

}  // namespace

Mesh readGmsh(const std::filesystem::path& file, double metres_per_unit) {
  return parseGmsh(readText(file, "mesh"), file.string(), metres_per_unit);
}

Mesh parseGmsh(std::string text, const std::string& source, double metres_per_unit) {
  return GmshText(TextLines(std::move(text), source), metres_per_unit).read();
}

}  // namespace palpate
