#include "viewer/export/vtu.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sodium.h>

#include <cstring>

namespace palpate {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// One tetrahedron with an array of every kind.
Grid smallGrid() {
  Grid grid;
  grid.points = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  grid.cells = {0, 1, 2, 3};
  grid.point_data = {{"displacement", "m", 3, std::vector<float>(12, 0.25F)},
                     {"fixed", "1", 1, std::vector<std::uint8_t>{1, 0, 0, 1}}};
  grid.cell_data = {{"det_F", "1", 1, std::vector<float>{0.5F}}};
  grid.field_data = {{"force", "N", 3, std::vector<double>{1, -2, 0.125}}};
  return grid;
}

/// The numbers of an array, which follow their size in base64.
template <class Number>
std::vector<Number> valuesOf(const std::string& file, const std::string& element) {
  const std::size_t begin = file.find(element);
  if (begin == std::string::npos) {
    ADD_FAILURE() << "there is no " << element;
    return {};
  }
  const std::size_t text = file.find('>', begin) + 1, end = file.find('<', text);
  std::string bytes(file.size(), '\0');
  std::size_t length = 0;
  EXPECT_EQ(sodium_base642bin(reinterpret_cast<unsigned char*>(bytes.data()), bytes.size(),
                              file.data() + text, end - text, nullptr, &length, nullptr,
                              sodium_base64_VARIANT_ORIGINAL),
            0);
  std::uint64_t size = 0;
  std::memcpy(&size, bytes.data(), sizeof size);
  EXPECT_EQ(length, sizeof size + size);
  std::vector<Number> values(size / sizeof(Number));
  std::memcpy(values.data(), bytes.data() + sizeof size, size);
  return values;
}

TEST(Vtu, HoldsEveryArrayWithItsTypeShapeAndUnit) {
  const std::string file = vtuBytes(smallGrid());
  EXPECT_THAT(file, HasSubstr("<Piece NumberOfPoints=\"4\" NumberOfCells=\"1\">"));
  EXPECT_EQ(valuesOf<float>(file,
                            "type=\"Float32\" Name=\"displacement\" unit=\"m\" "
                            "NumberOfComponents=\"3\" format=\"binary\""),
            std::vector<float>(12, 0.25F));
  EXPECT_EQ(valuesOf<std::uint8_t>(file, "type=\"UInt8\" Name=\"fixed\" unit=\"1\""),
            (std::vector<std::uint8_t>{1, 0, 0, 1}));
  EXPECT_EQ(valuesOf<double>(file,
                             "type=\"Float64\" Name=\"force\" unit=\"N\" "
                             "NumberOfComponents=\"3\" NumberOfTuples=\"1\""),
            (std::vector<double>{1, -2, 0.125}));
  EXPECT_EQ(valuesOf<double>(file, "Name=\"Points\""), smallGrid().points);
  EXPECT_EQ(valuesOf<std::int32_t>(file, "Name=\"connectivity\""), smallGrid().cells);
  EXPECT_EQ(valuesOf<std::int32_t>(file, "Name=\"offsets\""), std::vector<std::int32_t>{4});
  EXPECT_EQ(valuesOf<std::uint8_t>(file, "Name=\"types\""), std::vector<std::uint8_t>{10});
}

TEST(Vtu, NamesAreEscaped) {
  Grid grid = smallGrid();
  grid.texts = {{"scene", "a\"b<c>&'d\x01\n"}};
  EXPECT_THAT(vtuBytes(grid), HasSubstr(" scene=\"a&quot;b&lt;c&gt;&amp;&#39;d??\">"));
}

TEST(Vtu, TheListOfASeriesHasFilesAndTimesEscaped) {
  const std::string text = pvdText({{0, "a&b/a&b_0000.vtu"}, {0.5, "a&b/a&b_0001.vtu"}});
  EXPECT_THAT(text, AllOf(HasSubstr("type=\"Collection\""),
                          HasSubstr("timestep=\"0\" group=\"\" part=\"0\" "
                                    "file=\"a&amp;b/a&amp;b_0000.vtu\"/>"),
                          HasSubstr("timestep=\"0.5\" group=\"\" part=\"0\" "
                                    "file=\"a&amp;b/a&amp;b_0001.vtu\"/>"),
                          Not(HasSubstr("a&b"))));
}

}  // namespace
}  // namespace palpate
