#include <cstring>

#include "tests/fuzz/fuzzer.hpp"
#include "worker/meshing/closed_surface.hpp"

namespace palpate::fuzz {
namespace {

/// Corners on a grid of 16^3, so that many coincide, and arbitrary triangles between them.
TriangleSoup soupOf(std::string_view bytes) {
  TriangleSoup soup;
  const std::size_t corners = bytes.empty() ? 0 : static_cast<unsigned char>(bytes[0]);
  bytes.remove_prefix(std::min<std::size_t>(1, bytes.size()));
  for (std::size_t n = 0; n < corners && bytes.size() >= 2; ++n, bytes.remove_prefix(2)) {
    const auto low = static_cast<unsigned char>(bytes[0]),
               high = static_cast<unsigned char>(bytes[1]);
    soup.points.emplace_back(low % 16, low / 16, high % 16 + (high / 16) * 1e-7);
  }
  for (; bytes.size() >= 3; bytes.remove_prefix(3)) {
    Triangle triangle;
    for (int i = 0; i < 3; ++i) triangle[i] = static_cast<unsigned char>(bytes[i]);
    soup.triangles.push_back(triangle);
  }
  return soup;
}

void closeSurface(std::string_view bytes) {
  for (const Bodies bodies : {Bodies::only, Bodies::largest}) try {
      const ClosedSurface surface = closedSurface(soupOf(bytes), "s.stl", bodies);
      require(surface.volume > 0 && surface.area > 0, "a closed surface has no body");
      for (const Triangle& triangle : surface.triangles)
        for (const std::int32_t corner : triangle)
          require(corner >= 0 && static_cast<std::size_t>(corner) < surface.points.size(),
                  "a triangle has a corner that is not there");
    } catch (const Error&) {
    }
}

/// A tetrahedron inside another one.
std::vector<std::string> surfaceSeeds() {
  std::string seed = "\x08";
  for (const char* corner : {"\x01\x01", "\x0d\x01", "\xd1\x01", "\x11\x0d"}) seed += corner;
  for (const char* corner : {"\x22\x02", "\x25\x02", "\x52\x02", "\x22\x05"}) seed += corner;
  for (char first = 0; first < 8; first += 4)
    for (const auto& [a, b, c] : {std::array<int, 3>{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}})
      for (const int corner : {a, b, c}) seed += static_cast<char>(first + corner);
  return {seed};
}

const Registration surface_fuzzer({"surface", closeSurface, surfaceSeeds});

}  // namespace
}  // namespace palpate::fuzz
