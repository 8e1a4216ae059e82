#include "viewer/export/vtkhdf.hpp"

#include "common/dataset/hdf5_writer.hpp"

namespace palpate {
namespace {

constexpr const char* root = "/VTKHDF";

void writeArrays(hdf5::Writer& out, const std::string& group,
                 const std::vector<GridArray>& arrays) {
  out.makeGroup(group);
  for (const GridArray& array : arrays)
    std::visit(
        [&](const auto& values) {
          const auto width = static_cast<hsize_t>(array.components);
          hdf5::Shape shape = {values.size() / width};
          if (width > 1) shape.push_back(width);
          out.write(group + "/" + array.name, shape, std::span(values), array.unit);
        },
        array.values);
}

/// A list of one number: one partition.
void writeCount(hdf5::Writer& out, const char* name, std::size_t count) {
  out.writeList(std::string(root) + name,
                std::vector<std::int32_t>{static_cast<std::int32_t>(count)}, "1");
}

void writeCells(hdf5::Writer& out, const Grid& grid) {
  const std::string group = root;
  out.writeList(group + "/Connectivity", grid.cells, "1");
  std::vector<std::int32_t> offsets;
  for (std::size_t n = 0; n <= grid.cellCount(); ++n)
    offsets.push_back(static_cast<std::int32_t>(n) * pointsOf(grid.kind));
  out.writeList(group + "/Offsets", offsets, "1");
  out.writeList(group + "/Types",
                std::vector<std::uint8_t>(grid.cellCount(), static_cast<std::uint8_t>(grid.kind)),
                "1");
}

}  // namespace

void writeVtkHdf(const std::filesystem::path& file, const Grid& grid) {
  hdf5::Writer out(file);
  for (const auto& [name, text] : grid.texts) out.setText("/", name.c_str(), text);
  out.makeGroup(root);
  out.setIntegers(root, "Version", std::array<std::int32_t, 2>{1, 0});
  out.setAscii(root, "Type", "UnstructuredGrid");
  writeCount(out, "/NumberOfPoints", grid.pointCount());
  writeCount(out, "/NumberOfCells", grid.cellCount());
  writeCount(out, "/NumberOfConnectivityIds", grid.cells.size());
  out.write(std::string(root) + "/Points", {grid.pointCount(), 3}, std::span(grid.points), "m");
  writeCells(out, grid);
  writeArrays(out, std::string(root) + "/PointData", grid.point_data);
  writeArrays(out, std::string(root) + "/CellData", grid.cell_data);
  writeArrays(out, std::string(root) + "/FieldData", grid.field_data);
  out.close();
}

}  // namespace palpate
