#include "tests/fuzz/stored_arrays.hpp"

#include <set>

#include "common/base/assertion.hpp"
#include "common/dataset/dataset_format.hpp"

namespace palpate::fuzz {
namespace {

/// Changes of an array, chosen by their first byte.
enum ArrayChange : unsigned char {
  overwrites_values,  ///< from an offset on
  fills_values,       ///< with repeated eight bytes
  resizes_rows,       ///< fills new rows with zeros
  removes_array,
  changes_element,
  overwrites_attribute,  ///< from an offset on, or as a number
  array_changes
};

constexpr std::size_t most_bytes = 1u << 20;

template <class Function>
void withElement(hdf5::Element element, Function function) {
  switch (element) {
    case hdf5::Element::uint8: return function(std::uint8_t());
    case hdf5::Element::int16: return function(std::int16_t());
    case hdf5::Element::int32: return function(std::int32_t());
    case hdf5::Element::float32: return function(float());
    case hdf5::Element::float64: return function(double());
  }
}

std::size_t bytesOfArray(hdf5::Element element, const hdf5::Shape& shape) {
  return hdf5::countOf(shape) * hdf5::typeOf(element).size;
}

template <class Map>
auto chosen(Map& map, Choices& choices) {
  return std::next(map.begin(), static_cast<std::ptrdiff_t>(choices.oneOf(map.size())));
}

void overwrite(std::string& text, std::uint32_t offset, std::string_view bytes) {
  if (text.empty()) return;
  const std::size_t at = offset % text.size();
  const std::string_view fitting = bytes.substr(0, text.size() - at);
  text.replace(at, fitting.size(), fitting);
}

void changeAttribute(StoredArrays::Attribute& attribute, Choices& choices) {
  if (auto* text = std::get_if<std::string>(&attribute)) {
    const auto offset = choices.take<std::uint32_t>();
    overwrite(*text, offset, choices.takeBytes());
  } else if (auto* integers = std::get_if<std::vector<std::int32_t>>(&attribute)) {
    integers->assign(choices.oneOf(4), choices.take<std::int32_t>());
  } else {
    attribute = choices.take<double>();
  }
}

void makeGroups(hdf5::Writer& out, const std::map<std::string, StoredArrays::Array>& arrays) {
  std::set<std::string> groups;
  for (const auto& [path, array] : arrays)
    if (const std::size_t slash = path.rfind('/'); slash > 0) groups.insert(path.substr(0, slash));
  for (const std::string& group : groups) out.makeGroup(group);
}

}  // namespace

StoredArrays::StoredArrays(const std::filesystem::path& file, const std::vector<const char*>& texts,
                           const std::vector<const char*>& integers,
                           const std::vector<const char*>& numbers) {
  hdf5::Reader in(file);
  in.findArrays();
  for (const hdf5::ArrayInfo& info : in.arrays())
    withElement(info.element, [&](auto number) {
      const auto values = in.read<decltype(number)>(info.path, info.shape);
      arrays[info.path] = {info.element, info.shape, std::string(bytesOf(std::span(values)))};
    });
  for (const char* name : texts) attributes[name] = in.text(name);
  for (const char* name : integers) attributes[name] = in.integers(name);
  for (const char* name : numbers) attributes[name] = in.number(name);
  PALPATE_ASSERT(arrays.size() < 256 && attributes.size() < 256, "a byte tells which");
}

void StoredArrays::change(Choices& choices) {
  const std::size_t which = choices.oneOf(array_changes);
  if (which == overwrites_attribute) {
    changeAttribute(chosen(attributes, choices)->second, choices);
    return;
  }
  if (arrays.empty()) return;
  const auto entry = chosen(arrays, choices);
  Array& array = entry->second;
  switch (which) {
    case overwrites_values: {
      const auto offset = choices.take<std::uint32_t>();
      overwrite(array.bytes, offset, choices.takeBytes());
      break;
    }
    case fills_values: {
      const auto pattern = choices.take<std::array<char, 8>>();
      for (std::size_t n = 0; n < array.bytes.size(); ++n) array.bytes[n] = pattern[n % 8];
      break;
    }
    case resizes_rows: {
      hdf5::Shape shape = array.shape;
      if (shape.empty()) break;
      shape[0] = choices.take<std::uint16_t>();
      if (bytesOfArray(array.element, shape) > most_bytes) break;
      array.shape = shape;
      array.bytes.resize(bytesOfArray(array.element, shape));
      break;
    }
    case removes_array: arrays.erase(entry); break;
    case changes_element: {
      array.element = hdf5::all_elements.at(choices.oneOf(hdf5::all_elements.size()));
      array.bytes.resize(bytesOfArray(array.element, array.shape));
      break;
    }
    default: break;
  }
}

void StoredArrays::write(const std::filesystem::path& file) const {
  hdf5::Writer out(file);
  makeGroups(out, arrays);
  for (const auto& [path, array] : arrays) {
    hdf5::RowWriter rows(out, path, array.element, array.shape, "1");
    for (std::size_t n = 0; n < array.shape[0]; ++n) {
      const std::size_t size = array.bytes.size() / array.shape[0];
      rows.addBytes(std::string_view(array.bytes).substr(n * size, size));
    }
    rows.finish();
  }
  for (const auto& [name, attribute] : attributes) {
    if (const auto* text = std::get_if<std::string>(&attribute))
      out.setText("/", name.c_str(), *text);
    else if (const auto* integers = std::get_if<std::vector<std::int32_t>>(&attribute))
      out.setIntegers("/", name.c_str(), *integers);
    else
      out.setNumber("/", name.c_str(), std::get<double>(attribute));
  }
  const auto scene = attributes.find(layout::scene_attribute);
  if (scene != attributes.end())
    out.setText("/", layout::content_attribute,
                layout::contentHash(std::get<std::string>(scene->second), out.arrays()).hex());
  out.close();
}

unsigned char StoredArrays::numberOf(const std::string& path) const {
  const auto found = arrays.find(path);
  PALPATE_ASSERT(found != arrays.end(), "seeds name arrays that there are");
  return static_cast<unsigned char>(std::distance(arrays.begin(), found));
}

void StoredArrays::overwriteIn(Script& script, const std::string& path, std::uint32_t offset,
                               std::string_view bytes) const {
  script.op(overwrites_values).op(numberOf(path)).put(offset).putBytes(bytes);
}

void StoredArrays::resizeIn(Script& script, const std::string& path, std::uint16_t rows) const {
  script.op(resizes_rows).op(numberOf(path)).put(rows);
}

}  // namespace palpate::fuzz
