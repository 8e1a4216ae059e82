#pragma once

#include <cmath>
#include <fstream>
#include <map>
#include <numbers>
#include <string>
#include <tuple>

#include "tests/support/command.hpp"
#include "worker/meshing/closed_surface.hpp"

/// Closed surfaces made in code, facing outward, in a unit chosen by the test.
namespace palpate::test {

/// Collects triangles and merges coincident corners.
class SurfaceMaker {
 public:
  void add(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
    soup.triangles.push_back({at(a), at(b), at(c)});
  }
  void addQuad(const std::array<Eigen::Vector3d, 4>& q) {
    add(q[0], q[1], q[2]);
    add(q[0], q[2], q[3]);
  }
  TriangleSoup soup;

 private:
  std::int32_t at(const Eigen::Vector3d& x) {
    const auto key = [](double v) { return std::llround(v * 1e9); };
    const auto [found, is_new] =
        numbers_.emplace(std::tuple(key(x[0]), key(x[1]), key(x[2])), soup.points.size());
    if (is_new) soup.points.push_back(x);
    return static_cast<std::int32_t>(found->second);
  }
  std::map<std::tuple<long long, long long, long long>, std::size_t> numbers_;
};

/// The cube [-1, 1]^3 with n x n quadrilaterals on each side, with all corners moved by `move`.
template <class Move>
TriangleSoup movedCube(int n, Move move) {
  SurfaceMaker made;
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {-1, 1})
      for (int i = 0; i < n; ++i)
        for (int k = 0; k < n; ++k) {
          std::array<Eigen::Vector3d, 4> quad;
          for (int corner = 0; corner < 4; ++corner) {
            Eigen::Vector3d& x = quad[corner];
            x[axis] = side;
            x[(axis + 1) % 3] = -1 + 2.0 * (i + (corner == 1 || corner == 2)) / n;
            x[(axis + 2) % 3] = -1 + 2.0 * (k + (corner >= 2)) / n;
            x = move(x);
          }
          if (side < 0) std::swap(quad[1], quad[3]);
          made.addQuad(quad);
        }
  return made.soup;
}

inline TriangleSoup boxSurface(const Eigen::Vector3d& size, int n = 2,
                               const Eigen::Vector3d& center = Eigen::Vector3d::Zero()) {
  return movedCube(n, [&](const Eigen::Vector3d& x) {
    return Eigen::Vector3d(center + x.cwiseProduct(size) / 2);
  });
}

inline TriangleSoup sphereSurface(double radius, int n = 6,
                                  const Eigen::Vector3d& center = Eigen::Vector3d::Zero()) {
  return movedCube(n, [&](const Eigen::Vector3d& x) {
    const Eigen::Vector3d q = x.cwiseProduct(x);
    const Eigen::Vector3d ball(x[0] * std::sqrt(1 - q[1] / 2 - q[2] / 2 + q[1] * q[2] / 3),
                               x[1] * std::sqrt(1 - q[2] / 2 - q[0] / 2 + q[2] * q[0] / 3),
                               x[2] * std::sqrt(1 - q[0] / 2 - q[1] / 2 + q[0] * q[1] / 3));
    return Eigen::Vector3d(center + radius * ball);
  });
}

/// A torus around the z axis.
inline TriangleSoup torusSurface(double ring, double tube, int n = 24, int m = 12) {
  SurfaceMaker made;
  const auto at = [&](int i, int k) {
    const double u = 2 * std::numbers::pi * (i % n) / n, v = 2 * std::numbers::pi * (k % m) / m;
    const double r = ring + tube * std::cos(v);
    return Eigen::Vector3d(r * std::cos(u), r * std::sin(u), tube * std::sin(v));
  };
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < m; ++k)
      made.addQuad({at(i, k), at(i + 1, k), at(i + 1, k + 1), at(i, k + 1)});
  return made.soup;
}

/// Both surfaces in one file.
inline TriangleSoup together(TriangleSoup a, const TriangleSoup& b) {
  const auto first = static_cast<std::int32_t>(a.points.size());
  a.points.insert(a.points.end(), b.points.begin(), b.points.end());
  for (const Triangle& t : b.triangles)
    a.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  return a;
}

inline TriangleSoup insideOut(TriangleSoup soup) {
  for (Triangle& t : soup.triangles) std::swap(t[1], t[2]);
  return soup;
}

/// ASCII, as CAD programs write it: every triangle has separate corners.
inline void writeStl(const TriangleSoup& soup, const std::filesystem::path& file) {
  std::ofstream out(file);
  out.precision(9);
  out << "solid made in code\n";
  for (const Triangle& t : soup.triangles) {
    out << "facet normal 0 0 0\nouter loop\n";
    for (const std::int32_t corner : t) out << "vertex " << soup.points[corner].transpose() << "\n";
    out << "endloop\nendfacet\n";
  }
  out << "endsolid\n";
}

inline void writeBinaryStl(const TriangleSoup& soup, const std::filesystem::path& file) {
  std::ofstream out(file, std::ios::binary);
  const auto put = [&out](const auto& value) {
    out.write(reinterpret_cast<const char*>(&value), sizeof value);
  };
  out << std::string("solid, or so it says") + std::string(60, ' ');
  put(static_cast<std::uint32_t>(soup.triangles.size()));
  for (const Triangle& t : soup.triangles) {
    put(std::array<float, 3>{});
    for (const std::int32_t corner : t)
      for (const double x : soup.points[corner]) put(static_cast<float>(x));
    put(std::uint16_t{0});
  }
}

inline void writeObj(const TriangleSoup& soup, const std::filesystem::path& file) {
  std::ofstream out(file);
  out.precision(17);
  for (const Eigen::Vector3d& x : soup.points) out << "v " << x.transpose() << "\n";
  for (const Triangle& t : soup.triangles)
    out << "f " << t[0] + 1 << "/7 " << t[1] + 1 << "//3 " << t[2] + 1 << "\n";
}

inline void writeOff(const TriangleSoup& soup, const std::filesystem::path& file) {
  std::ofstream out(file);
  out.precision(17);
  out << "OFF\n# made in code\n" << soup.points.size() << " " << soup.triangles.size() << " 0\n";
  for (const Eigen::Vector3d& x : soup.points) out << x.transpose() << "\n";
  for (const Triangle& t : soup.triangles)
    out << "3 " << t[0] << " " << t[1] << " " << t[2] << "\n";
}

inline void writePly(const TriangleSoup& soup, const std::filesystem::path& file) {
  std::ofstream out(file);
  out.precision(17);
  out << "ply\nformat ascii 1.0\nelement vertex " << soup.points.size()
      << "\nproperty double x\nproperty double y\nproperty double z\nelement face "
      << soup.triangles.size() << "\nproperty list uchar int vertex_index\nend_header\n";
  for (const Eigen::Vector3d& x : soup.points) out << x.transpose() << "\n";
  for (const Triangle& t : soup.triangles)
    out << "3 " << t[0] << " " << t[1] << " " << t[2] << "\n";
}

inline bool hasMeshio() { return runCommand("/usr/bin/python3 -c 'import meshio'").exit_code == 0; }
inline bool hasProgram(const std::string& name) {
  return runCommand("command -v " + name).exit_code == 0;
}

}  // namespace palpate::test

/// Skips the running test with a visible message.
#define PALPATE_NEEDS(there, what)                  \
  if (!(there))                                     \
  GTEST_SKIP() << "NOT RUN: there is no " << (what) \
               << "; deploy/install-packages --tests installs it"
