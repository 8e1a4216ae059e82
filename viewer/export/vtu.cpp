#include "viewer/export/vtu.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>

#include "common/base/assertion.hpp"
#include "common/base/bytes32.hpp"
#include "common/base/markup.hpp"

namespace palpate {
namespace {

const char* vtkName(const std::vector<float>&) { return "Float32"; }
const char* vtkName(const std::vector<double>&) { return "Float64"; }
const char* vtkName(const std::vector<std::int32_t>&) { return "Int32"; }
const char* vtkName(const std::vector<std::uint8_t>&) { return "UInt8"; }

/// Returns the XML element of one array. attributes: further attributes, each with a blank before
/// it.
template <class Number>
std::string element(const std::string& attributes, const std::vector<Number>& values) {
  std::string bytes(bytesOf(std::span(values)));
  const std::uint64_t size = bytes.size();
  bytes.insert(0, bytesOf(std::span(&size, 1)));
  return fmt::format("<DataArray type=\"{}\"{} format=\"binary\">{}</DataArray>\n", vtkName(values),
                     attributes, base64Of(bytes));
}

std::string attributesOf(const GridArray& array, std::size_t values) {
  std::string text =
      fmt::format(" Name=\"{}\" unit=\"{}\"", xmlText(array.name), xmlText(array.unit));
  if (array.components > 1) text += fmt::format(" NumberOfComponents=\"{}\"", array.components);
  if (values > 0)
    text +=
        fmt::format(" NumberOfTuples=\"{}\"", values / static_cast<std::size_t>(array.components));
  return text;
}

/// Returns an XML section with the elements of all arrays. with_tuples: adds the numbers of tuples,
/// which VTK needs only for field data.
std::string section(const char* name, const std::vector<GridArray>& arrays,
                    bool with_tuples = false) {
  std::string text = fmt::format("<{}>\n", name);
  for (const GridArray& array : arrays)
    text += std::visit(
        [&](const auto& values) {
          return element(attributesOf(array, with_tuples ? values.size() : 0), values);
        },
        array.values);
  return text + fmt::format("</{}>\n", name);
}

/// Returns whether each array has `count` tuples, one per point or cell.
bool areOf(std::size_t count, const std::vector<GridArray>& arrays) {
  return std::ranges::all_of(arrays, [&](const GridArray& array) {
    const auto sizeOf = [](const auto& values) { return values.size(); };
    return std::visit(sizeOf, array.values) == count * static_cast<std::size_t>(array.components);
  });
}

std::string cellsOf(const Grid& grid) {
  std::vector<std::int32_t> ends;
  for (std::size_t n = 1; n <= grid.cellCount(); ++n)
    ends.push_back(static_cast<std::int32_t>(n) * pointsOf(grid.kind));
  const std::vector<std::uint8_t> types(grid.cellCount(), static_cast<std::uint8_t>(grid.kind));
  std::string text = "<Cells>\n" + element(" Name=\"connectivity\"", grid.cells);
  text += element(" Name=\"offsets\"", ends);
  return text + element(" Name=\"types\"", types) + "</Cells>\n";
}

}  // namespace

std::string xmlText(std::string_view text) {
  std::string clean(text);
  std::ranges::replace_if(
      clean, [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }, '?');
  return escaped(clean);
}

std::string vtuBytes(const Grid& grid) {
  PALPATE_ASSERT(
      areOf(grid.pointCount(), grid.point_data) && areOf(grid.cellCount(), grid.cell_data),
      "a grid must have a value for every point and cell");
  std::string text =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\"";
  for (const auto& [name, value] : grid.texts)
    text += fmt::format(" {}=\"{}\"", name, xmlText(value));
  text += ">\n<UnstructuredGrid>\n" + section("FieldData", grid.field_data, true);
  text += fmt::format("<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n", grid.pointCount(),
                      grid.cellCount());
  text += section("PointData", grid.point_data);
  text += section("CellData", grid.cell_data);
  text += "<Points>\n";
  text += element(" Name=\"Points\" unit=\"m\" NumberOfComponents=\"3\"", grid.points);
  return text + "</Points>\n" + cellsOf(grid) + "</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
}

std::string pvdText(const std::vector<SeriesFile>& series) {
  std::string text =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n<Collection>\n";
  for (const SeriesFile& step : series)
    text += fmt::format("<DataSet timestep=\"{}\" group=\"\" part=\"0\" file=\"{}\"/>\n", step.time,
                        xmlText(step.file));
  return text + "</Collection>\n</VTKFile>\n";
}

}  // namespace palpate
