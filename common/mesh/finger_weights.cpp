#include "common/mesh/finger_weights.hpp"

#include "common/base/assertion.hpp"

namespace palpate {
namespace {

void accumulateIntegral(BumpIntegral& sum, const BumpIntegral& term) {
  sum.value += term.value;
  sum.gradient += term.gradient;
  sum.curvature += term.curvature;
}

/// Returns whether the bump reaches the node. Checks all derivatives too, because the value alone
/// may be zero by chance.
bool isReached(const BumpIntegral& integral) {
  return integral.value != 0 || !integral.gradient.isZero(0) || !integral.curvature.isZero(0);
}

/// Returns the quotient a / b with its derivatives.
BumpIntegral quotient(const BumpIntegral& a, const BumpIntegral& b) {
  BumpIntegral q;
  q.value = a.value / b.value;
  q.gradient = (a.gradient - q.value * b.gradient) / b.value;
  const Eigen::Matrix3d mixed = q.gradient * b.gradient.transpose();
  q.curvature = (a.curvature - q.value * b.curvature - mixed - mixed.transpose()) / b.value;
  return q;
}

}  // namespace

FingerWeights fingerWeights(const Mesh& mesh, const NodeSet& fixed, const Eigen::Vector3d& center,
                            double radius, bool derivatives) {
  PALPATE_ASSERT(center.allFinite(), "the centre of a finger must be finite");
  const std::vector<BumpIntegral> integrals = bumpIntegrals(mesh, center, radius, derivatives);
  FingerWeights finger;
  BumpIntegral sum;
  double whole = 0;
  for (std::size_t n = 0; n < integrals.size(); ++n) {
    const auto node = static_cast<std::int32_t>(n);
    whole += integrals[n].value;
    if (!isReached(integrals[n]) || contains(fixed, node)) continue;
    finger.nodes.push_back(node);
    accumulateIntegral(sum, integrals[n]);
  }
  // With quadratic shape functions, single integrals may be negative. If fixed nodes are left out,
  // the sum may be negative too.
  if (!(sum.value > 0)) return {};
  finger.free_share = sum.value / whole;
  for (const std::int32_t node : finger.nodes) {
    const BumpIntegral weight = quotient(integrals[node], sum);
    finger.weights.push_back(weight.value);
    finger.gradients.push_back(weight.gradient);
    finger.curvatures.push_back(weight.curvature);
  }
  return finger;
}

}  // namespace palpate
