#include "worker/solver/element_batches.hpp"

#include <utility>

#include "common/base/assertion.hpp"
#include "common/base/index.hpp"
#include "common/mesh/tetrahedron.hpp"

namespace palpate {
namespace {

/// Fills one lane. An unused lane repeats the last element with volume zero.
void fillLane(BatchGeometry& geometry, int lane, const BodyModel& model, std::int32_t element,
              double volume) {
  geometry.volume[lane] = volume;
  const Eigen::Matrix<double, 3, 4> gradients = barycentricGradients(model.mesh, element);
  for (int b = 0; b < 3; ++b)
    for (int I = 0; I < 3; ++I) geometry.gradient[b][I][lane] = gradients(I, b);
  if (!model.fibers.empty())
    for (int family = 0; family < 2; ++family)
      for (int I = 0; I < 3; ++I)
        geometry.fiber[family][I][lane] = model.fibers[element][family][I];
}

}  // namespace

std::vector<ElementParameters> elementParameters(const BodyModel& model, double pressure_scale) {
  std::vector<ElementParameters> all;
  for (const Material& m : model.materials) {
    ElementParameters& p = all.emplace_back();
    p.displacement = model.discretization.displacement;
    p.pressure = pressureSpaceOf(model, all.size() - 1);
    p.constraint = model.discretization.constraint;
    p.pressure_scale = pressure_scale;
    if (p.pressure == PressureSpace::p1_stabilized) p.stabilization = 1 / shearModulus(m);
    p.bulk = m.bulk.value_or(0.0);
    p.law = m.law;
    p.mu = shearModulus(m);
    if (m.poisson) p.lambda = 2 * p.mu * *m.poisson / (1 - 2 * *m.poisson);
    // The pressure replaces the term with lambda (addTraceConstraint()).
    if (isCompressible(m.law) && p.pressure != PressureSpace::none)
      p.bulk = std::exchange(p.lambda, 0);
    p.c10 = m.c10;
    p.c01 = m.c01;
    p.c20 = m.c20;
    p.c30 = m.c30;
    p.c1 = m.c1;
    p.c2 = m.c2;
    p.k1 = m.k1;
    p.k2 = m.k2;
    p.dispersion = m.dispersion;
    PALPATE_ASSERT(m.ogden.size() <= std::size(p.ogden_mu), "a law must have at most three terms");
    for (const OgdenTerm& term : m.ogden) {
      p.ogden_mu[p.ogden_terms] = term.mu;
      p.ogden_alpha[p.ogden_terms++] = term.alpha;
    }
  }
  return all;
}

ElementBatches::ElementBatches(const BodyModel& model, const PressureSlots& pressures)
    : of_node(model.mesh.nodes.size()) {
  std::vector<std::vector<std::int32_t>> elements_of(model.materials.size());
  for (std::int32_t element = 0; at(element) < model.mesh.tetrahedra.size(); ++element)
    elements_of.at(model.region_of[element]).push_back(element);
  for (const std::vector<std::int32_t>& elements : elements_of)
    for (std::size_t first = 0; first < elements.size(); first += lanes)
      add(model, pressures, elements, first);
}

void ElementBatches::add(const BodyModel& model, const PressureSlots& pressures,
                         const std::vector<std::int32_t>& elements, std::size_t first) {
  const auto number = static_cast<std::int32_t>(all.size());
  ElementBatch& batch = all.emplace_back();
  batch.material = model.region_of[elements[first]];
  batch.displacements = 3 * displacementNodes(model.discretization.displacement);
  batch.unknowns = batch.displacements + pressureNodes(pressureSpaceOf(model, batch.material));
  for (int lane = 0; lane < lanes; ++lane) {
    const bool used = first + lane < elements.size();
    const std::int32_t element = used ? elements[first + lane] : elements.back();
    batch.element[lane] = used ? element : -1;
    fillLane(batch.geometry, lane, model, element, used ? sixVolume(model.mesh, element) / 6 : 0.0);
    const std::vector<std::int32_t> nodes = nodesOf(model.mesh, element);
    for (std::size_t a = 0; a < nodes.size(); ++a) {
      batch.geometry.node[a][lane] = nodes[a];
      std::vector<std::int32_t>& touching = of_node[nodes[a]];
      if (touching.empty() || touching.back() != number) touching.push_back(number);
    }
    for (int b = 0; b < batch.unknowns - batch.displacements; ++b)
      batch.geometry.pressure[b][lane] = pressures.slotOf(nodes[b], batch.material);
  }
}

}  // namespace palpate
