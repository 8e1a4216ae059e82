// A slender cantilever under a dead tip load: the elastica (Bisshopp and Drucker 1945).
#include <fmt/format.h>

#include <cmath>

#include "tests/verification/rig.hpp"

namespace palpate::verification {
namespace {

constexpr double length = 1, height = length / 50, modulus = 1e6;  ///< m, m, Pa
constexpr double second_moment = height * height * height * height / 12;

/// A point of the centre line of a beam of length 1: its position along and down, angle and
/// curvature.
using Section = Eigen::Vector4d;

/// Returns the centre line at `stations` + 1 points, clamped at the first one. Integrates angle'' =
/// -load cos(angle) by the method of Runge and Kutta, and finds by bisection the curvature at the
/// clamp for which the moment at the tip is zero.
std::vector<Section> elastica(double load, int stations) {
  constexpr int substeps = 20;
  const double ds = 1.0 / (stations * substeps);
  const auto slope = [load](const Section& at) {
    return Section(std::cos(at[2]), std::sin(at[2]), at[3], -load * std::cos(at[2]));
  };
  const auto shot = [&](double curvature) {
    std::vector<Section> line = {Section(0, 0, 0, curvature)};
    for (int station = 0; station < stations; ++station) {
      Section at = line.back();
      for (int substep = 0; substep < substeps; ++substep) {
        const Section k1 = slope(at), k2 = slope(at + ds / 2 * k1), k3 = slope(at + ds / 2 * k2);
        at += ds / 6 * (k1 + 2 * k2 + 2 * k3 + slope(at + ds * k3));
      }
      line.push_back(at);
    }
    return line;
  };
  double low = 0, high = load;
  for (int halving = 0; halving < 60; ++halving) {
    const double middle = (low + high) / 2;
    (shot(middle).back()[3] < 0 ? low : high) = middle;
  }
  return shot(low);
}

/// Returns the displacement of the point X by Bernoulli's hypothesis: sections stay plane and
/// normal to the centre line. Newton starts from these displacements. A step from the straight beam
/// would stretch the beam, and stretching is thousands of times stiffer than bending.
Eigen::Vector3d bentAlong(const std::vector<Section>& line, const Eigen::Vector3d& X) {
  const auto station =
      static_cast<std::size_t>(std::lround(X[0] / length * double(line.size() - 1)));
  const double along = line[station][0], down = line[station][1], angle = line[station][2];
  const double off_centre = X[2] - height / 2;
  return {length * along + std::sin(angle) * off_centre - X[0], 0,
          -length * down + (std::cos(angle) - 1) * off_centre};
}

struct Tip {
  double down, back;  ///< relative to the length: v/L and u/L
};

/// Returns the tip of the solved beam. `load` is P L^2/(E I).
Tip bent(double load, int cells) {
  BodyModel body = bodyOf(boxMesh({length, height, height}, {cells, 1, 1}), p2_displacement,
                          stVenantKirchhoff(modulus, 0));
  hold(body, "xmin", "xyz");
  const double force = load * modulus * second_moment / (length * length);
  const auto end =
      facesWhere(body.mesh, [](const Eigen::Vector3d& X) { return X[0] > length * (1 - 1e-9); });
  addTraction(body, end, {0, 0, -force / (height * height)});
  Rig rig(body);
  const std::vector<Section> line = elastica(load, 2 * cells);
  const NewtonResult result = rig.equilibrium(
      displaced(rig.system(), [&](const Eigen::Vector3d& X) { return bentAlong(line, X); }));
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  const auto& nodes = body.mesh.node_groups.at("xmax");
  for (const std::int32_t node : nodes) mean += ofNode(result.state.u, node);
  mean /= static_cast<double>(nodes.size());
  return {-mean[2] / length, -mean[0] / length};
}

std::vector<Row> tipRows(double load, int cells, const Tip& reference) {
  const Tip tip = bent(load, cells);
  const std::string name = fmt::format("P2, {} elements long, P L^2/(E I) = {}", cells, load);
  return {{name + ": v/L", tip.down, reference.down, 0.002},
          {name + ": u/L", tip.back, reference.back, 0.002}};
}

}  // namespace

std::vector<Case> elasticaCases() {
  return {
      {"elastica", false, [] {
         return joined({tipRows(1, 50, {0.30172, 0.05643}), tipRows(10, 100, {0.81061, 0.55500})});
       }}};
}

}  // namespace palpate::verification
