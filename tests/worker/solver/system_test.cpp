#include "worker/solver/system.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <random>
#include <set>
#include <vector>

#include "tests/support/body_models.hpp"
#include "tests/support/problems.hpp"
#include "tests/worker/solver/dense_tangent.hpp"
#include "worker/elements/kernel_family.hpp"

namespace palpate {
namespace {

struct Formulation {
  std::string name;
  Discretization discretization;
  Material material;
};

/// Every element with every law that it supports, and every form of the volume constraint.
std::vector<Formulation> everyFormulation() {
  std::vector<Formulation> all;
  for (const Discretization& element : test::everyElement())
    for (const auto& [law, material] : test::everyMaterial()) {
      const std::string name = test::nameOf(element) + ", " + law;
      if (element.pressure == PressureSpace::none) {
        all.push_back({name, element, material});
        continue;
      }
      Formulation formulation{name, element, material};
      if (isCompressible(material.law)) formulation.material.poisson = 0.499;
      all.push_back(formulation);
      if (isCompressible(material.law)) continue;
      formulation.discretization.constraint = Constraint::det_F_minus_1;
      formulation.name += ", det F - 1";
      all.push_back(formulation);
      formulation.material.bulk = 40000;
      formulation.name += ", nearly incompressible";
      all.push_back(formulation);
    }
  return all;
}

/// One formulation of each element.
std::vector<Formulation> oneFormulationPerElement() {
  std::vector<Formulation> all;
  for (const Discretization& element : test::everyElement())
    all.push_back({test::nameOf(element), element, test::materialOf(LawName::mooney_rivlin)});
  return all;
}

/// A small body, fixed at one end and held by a tool at the other, in a random admissible state.
class SystemTest : public ::testing::Test {
 protected:
  static BodyModel clamped(const Formulation& formulation) {
    BodyModel model = test::freeBody(test::distortedBoxMesh({0.1, 0.1, 0.05}, {2, 2, 1}),
                                     formulation.discretization, formulation.material);
    test::fix(model, "xmin");
    model.tools = {test::toolOf(model, "xmax"), test::toolOf(model, "xmax", true)};
    return model;
  }

  void prepare(BodyModel model, const ElementKernels& kernels = chooseKernels()) {
    system_.emplace(std::move(model), kernels);
    drawState();
  }
  void prepare(const Formulation& formulation) { prepare(clamped(formulation)); }

  void drawState() {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform(-1, 1);
    Eigen::VectorXd step(system_->unknowns() + system_->multipliers());
    for (double& component : step) component = 1e-3 * uniform(random);
    p_ = Eigen::Vector3d(2e-3, -3e-3, 1e-3);
    state_ = system_->moved(system_->restState(), step, 1, p_);
    system_->assemble(state_, residual_, tangent_);
    ASSERT_GT(residual_.min_det_F, 0);
  }

  Residual residualAt(const State& state) const {
    Residual residual;
    system_->assemble(state, residual);
    return residual;
  }

  /// The state with one unknown, or the tool, moved by `amount`.
  State nudged(Eigen::Index unknown, double amount) const {
    Eigen::VectorXd step = Eigen::VectorXd::Zero(residual_.free.size());
    step[unknown] = amount;
    return system_->moved(state_, step, 1, p_);
  }
  State toolNudged(int direction, double amount) const {
    const Eigen::VectorXd nothing = Eigen::VectorXd::Zero(residual_.free.size());
    return system_->moved(state_, nothing, 1, p_ + amount * Eigen::Vector3d::Unit(direction));
  }

  /// Rows of tool nodes are rows of a multiple of the identity.
  Eigen::MatrixXd dense() const { return test::dense(*system_, tangent_); }

  bool isHeld(Eigen::Index unknown) const {
    const State moved = nudged(unknown, 1e-3);
    return moved.u == state_.u && moved.q == state_.q && moved.multiplier == state_.multiplier;
  }

  void expectResidualIsTheDerivativeOfTheEnergy(const std::string& name) const {
    constexpr double h = 1e-6;
    const double tolerance = 1e-6 * residual_.free.cwiseAbs().maxCoeff();
    for (Eigen::Index unknown = 0; unknown < residual_.free.size(); ++unknown) {
      const double slope =
          (residualAt(nudged(unknown, h)).energy - residualAt(nudged(unknown, -h)).energy) /
          (2 * h);
      ASSERT_NEAR(slope, residual_.free[unknown], tolerance) << name << ", unknown " << unknown;
    }
    for (int direction = 0; direction < 3 && system_->tool(); ++direction) {
      const double slope = (residualAt(toolNudged(direction, h)).energy -
                            residualAt(toolNudged(direction, -h)).energy) /
                           (2 * h);
      ASSERT_NEAR(slope, residual_.tool[direction], tolerance)
          << name << ", tool direction " << direction;
    }
  }

  void expectTangentIsTheDerivativeOfTheResidual(const std::string& name) const {
    // The step is so small that no fibre becomes slack or taut within it.
    constexpr double h = 1e-7;
    const Eigen::MatrixXd K = dense();
    const double tolerance = 1e-6 * K.cwiseAbs().maxCoeff();
    for (Eigen::Index unknown = 0; unknown < residual_.free.size(); ++unknown) {
      if (isHeld(unknown)) continue;
      const Residual up = residualAt(nudged(unknown, h)), down = residualAt(nudged(unknown, -h));
      const Eigen::VectorXd column = (up.free - down.free) / (2 * h);
      ASSERT_LT((column - K.col(unknown)).cwiseAbs().maxCoeff(), tolerance)
          << name << ", unknown " << unknown;
      const Eigen::Vector3d coupling = (up.tool - down.tool) / (2 * h);
      if (system_->tool()) {
        ASSERT_LT((coupling - tangent_.tool_coupling.row(unknown).transpose()).norm(), tolerance)
            << name;
      }
    }
    for (int direction = 0; direction < 3 && system_->tool(); ++direction) {
      const Residual up = residualAt(toolNudged(direction, h)),
                     down = residualAt(toolNudged(direction, -h));
      ASSERT_LT(((up.tool - down.tool) / (2 * h) - tangent_.tool.col(direction)).norm(), tolerance)
          << name;
      ASSERT_LT(((up.free - down.free) / (2 * h) - tangent_.tool_coupling.col(direction))
                    .cwiseAbs()
                    .maxCoeff(),
                tolerance)
          << name;
    }
  }

  std::optional<System> system_;
  Eigen::Vector3d p_;
  State state_;
  Residual residual_;
  Tangent tangent_;
};

TEST_F(SystemTest, ResidualIsTheDerivativeOfTheEnergyForEveryElementAndLaw) {
  for (const Formulation& formulation : everyFormulation()) {
    prepare(formulation);
    expectResidualIsTheDerivativeOfTheEnergy(formulation.name);
  }
}

TEST_F(SystemTest, TangentIsTheDerivativeOfTheResidualForEveryElementAndLaw) {
  for (const Formulation& formulation : everyFormulation()) {
    prepare(formulation);
    expectTangentIsTheDerivativeOfTheResidual(formulation.name);
  }
}

TEST_F(SystemTest, AWeightedToolIsAMultiplierForEveryElement) {
  for (const Formulation& formulation : oneFormulationPerElement()) {
    prepare(formulation);
    system_->chooseTool(1);
    ASSERT_EQ(system_->multipliers(), 3);
    drawState();
    expectResidualIsTheDerivativeOfTheEnergy(formulation.name);
    expectTangentIsTheDerivativeOfTheResidual(formulation.name);
    EXPECT_EQ(residual_.tool, state_.multiplier);
  }
}

TEST_F(SystemTest, LoadsAndSingleFixedComponentsKeepTheDerivatives) {
  for (const Formulation& formulation : oneFormulationPerElement()) {
    BodyModel model = clamped(formulation);
    model.materials[0].density = 1000;
    model.tools.clear();
    test::fix(model, "zmin", {2});
    addGravity(model, {1, -9.81, 2});
    addTraction(model, test::facesOf(model.mesh, "xmax"), {300, 200, -100});
    prepare(std::move(model));
    system_->setLoadFactor(0.7);
    drawState();
    ASSERT_FALSE(system_->tool());
    expectResidualIsTheDerivativeOfTheEnergy(formulation.name);
    expectTangentIsTheDerivativeOfTheResidual(formulation.name);
  }
}

/// A body of three laws, one of them without pressure.
BodyModel layered(const Discretization& discretization) {
  BodyModel model = test::freeBody(test::distortedBoxMesh({0.1, 0.1, 0.05}, {2, 2, 1}),
                                   discretization, test::materialOf(LawName::mooney_rivlin));
  model.materials.push_back(test::materialOf(LawName::st_venant_kirchhoff));
  model.materials.push_back(test::materialOf(LawName::holzapfel_gasser_ogden));
  model.materials[2].bulk = 30000;
  for (std::size_t element = 0; element < model.region_of.size(); ++element)
    model.region_of[element] = static_cast<std::uint16_t>(element < 6 ? 1 : element % 2 * 2);
  model.fibers.assign(model.region_of.size(),
                      {Eigen::Vector3d(0.6, 0.8, 0), Eigen::Vector3d::Zero()});
  test::fix(model, "xmin");
  model.tools = {test::toolOf(model, "xmax")};
  return model;
}

TEST_F(SystemTest, RegionsOfDifferentLawsKeepTheDerivatives) {
  for (const Discretization& element : test::everyElement()) {
    prepare(layered(element));
    expectResidualIsTheDerivativeOfTheEnergy(test::nameOf(element));
    expectTangentIsTheDerivativeOfTheResidual(test::nameOf(element));
  }
}

TEST_F(SystemTest, HasPressuresOnlyInMixedMaterials) {
  const Discretization taylor_hood{DisplacementSpace::p2, PressureSpace::p1, Constraint::ln_det_F};
  const BodyModel model = layered(taylor_hood);
  std::set<std::int32_t> mixed;
  std::set<std::pair<std::int32_t, std::uint16_t>> pressures;  // one per material at a vertex
  for (std::size_t element = 6; element < model.mesh.tetrahedra.size(); ++element)
    for (const std::int32_t vertex : model.mesh.tetrahedra[element]) {
      mixed.insert(vertex);
      pressures.emplace(vertex, model.region_of[element]);
    }
  ASSERT_LT(std::ssize(mixed), model.mesh.vertices());
  const System system(model, chooseKernels());
  EXPECT_EQ(system.expectedNegativePivots(), std::ssize(pressures));
  EXPECT_EQ(system.restState().q.size(),
            static_cast<std::size_t>(model.mesh.vertices()) + pressures.size() - mixed.size());
}

/// If a tool holds all nodes of some elements, the pressures inside have no equation.
TEST_F(SystemTest, FixesPressuresWhoseNodesTheToolHolds) {
  const auto half = [](const Formulation& formulation) {
    BodyModel model = test::freeBody(test::distortedBoxMesh({0.1, 0.05, 0.05}, {3, 1, 1}),
                                     formulation.discretization, formulation.material);
    test::fix(model, "xmin");
    Tool tool;
    for (std::int32_t node = 0; node < static_cast<std::int32_t>(model.mesh.nodes.size()); ++node)
      if (model.mesh.nodes[static_cast<std::size_t>(node)].x() > 0.05) tool.nodes.push_back(node);
    model.tools = {tool};
    return model;
  };
  for (const Formulation& formulation : oneFormulationPerElement()) {
    prepare(half(formulation));
    expectResidualIsTheDerivativeOfTheEnergy(formulation.name);
    expectTangentIsTheDerivativeOfTheResidual(formulation.name);
    if (!isInfSupStable(formulation.discretization)) continue;
    const Eigen::MatrixXd K = dense();
    EXPECT_TRUE(K.fullPivLu().isInvertible()) << formulation.name;
    system_->releaseTool();
    system_->chooseTool(0);
    system_->assemble(state_, residual_, tangent_);
    EXPECT_EQ(dense(), K) << formulation.name << ": the same when chosen again";
  }
}

TEST_F(SystemTest, ExpectsNoPivotCountForElementsWithSpuriousPressures) {
  for (const Discretization& element : test::everyElement()) {
    const bool unstable = test::nameOf(element) == "P1/P1" || test::nameOf(element) == "P2/P2";
    prepare({"", element, test::materialOf(LawName::mooney_rivlin)});
    EXPECT_EQ(system_->expectedNegativePivots().has_value(), !unstable) << test::nameOf(element);
  }
}

TEST_F(SystemTest, ScalesByTheSoftestMaterial) {
  const System system(layered({DisplacementSpace::p1, PressureSpace::none, Constraint::ln_det_F}),
                      chooseKernels());
  EXPECT_DOUBLE_EQ(system.pressureScale() * system.meanEdge(), 3000);
}

TEST_F(SystemTest, EveryKernelFamilyComputesTheSameToRounding) {
  for (const Formulation& formulation : everyFormulation()) {
    prepare(clamped(formulation), *supportedKernels().back());
    const Residual baseline = residual_;
    const Tangent baseline_tangent = tangent_;
    for (const ElementKernels* kernels : supportedKernels()) {
      prepare(clamped(formulation), *kernels);
      EXPECT_NEAR(residual_.energy, baseline.energy, 1e-12 * std::abs(baseline.energy))
          << kernels->family;
      EXPECT_LT((residual_.free - baseline.free).norm(), 1e-12 * baseline.free.norm())
          << kernels->family;
      for (std::size_t entry = 0; entry < tangent_.values.size(); ++entry)
        ASSERT_NEAR(tangent_.values[entry], baseline_tangent.values[entry], 1e-9)
            << kernels->family << ", " << formulation.name;
    }
  }
}

TEST_F(SystemTest, ResidualAloneEqualsTheOneWithTheTangent) {
  for (const Formulation& formulation : oneFormulationPerElement()) {
    prepare(formulation);
    const Residual alone = residualAt(state_);
    EXPECT_EQ(alone.free, residual_.free) << formulation.name;
    EXPECT_EQ(alone.energy, residual_.energy) << formulation.name;
  }
}

TEST_F(SystemTest, RestIsAnEquilibriumOfEveryFormulation) {
  for (const Formulation& formulation : everyFormulation())
    for (const ElementKernels* kernels : supportedKernels()) {
      prepare(clamped(formulation), *kernels);
      const Residual rest = residualAt(system_->restState());
      EXPECT_LT(rest.norm, 1e-13 * system_->forceScale()) << formulation.name;
      EXPECT_NEAR(rest.energy, 0, 1e-14 * system_->forceScale() * system_->meanEdge())
          << formulation.name;
      EXPECT_EQ(rest.min_det_F, 1) << formulation.name;
    }
}

TEST_F(SystemTest, RotatingAndMovingTheWholeBodyRotatesItsForces) {
  const Eigen::Matrix3d R = (Eigen::AngleAxisd(0.8, Eigen::Vector3d::UnitX()) *
                             Eigen::AngleAxisd(-1.3, Eigen::Vector3d::UnitZ()))
                                .toRotationMatrix();
  for (const Formulation& formulation : everyFormulation()) {
    if (formulation.material.law == LawName::linear) continue;
    BodyModel model = clamped(formulation);
    model.tools.clear();
    std::fill(model.fixed.begin(), model.fixed.end(), 0);
    const std::vector<Eigen::Vector3d> rest_positions = model.mesh.nodes;
    prepare(std::move(model));
    State turned = state_;
    for (std::size_t node = 0; node < rest_positions.size(); ++node) {
      Eigen::Map<Eigen::Vector3d> u(&turned.u[3 * node]);
      u = R * (rest_positions[node] + u) + Eigen::Vector3d(0.3, -0.1, 0.2) - rest_positions[node];
    }
    const Residual after = residualAt(turned);
    EXPECT_NEAR(after.energy, residual_.energy, 1e-11 * std::abs(residual_.energy))
        << formulation.name;
    const double tolerance = 1e-10 * residual_.free.cwiseAbs().maxCoeff();
    const auto vertices = static_cast<std::size_t>(system_->model().mesh.vertices());
    const bool with_pressure = !state_.q.empty();
    Eigen::Index row = 0;
    for (std::size_t node = 0; node < rest_positions.size(); ++node, row += 3) {
      ASSERT_LT((after.free.segment<3>(row) - R * residual_.free.segment<3>(row)).norm(), tolerance)
          << formulation.name;
      const bool pressure_here = with_pressure && (node < vertices || state_.q.size() > vertices);
      if (pressure_here) {
        ASSERT_NEAR(after.free[row + 3], residual_.free[row + 3], tolerance) << formulation.name;
        ++row;
      }
    }
  }
}

TEST_F(SystemTest, AnInvertedElementIsNamedAndHasNoLogarithm) {
  for (const Formulation& formulation : oneFormulationPerElement()) {
    prepare(formulation);
    const Residual residual = residualAt(toolNudged(0, -1.0));
    EXPECT_LT(residual.min_det_F, 0) << formulation.name;
    EXPECT_GE(residual.worst_element, 0) << formulation.name;
    EXPECT_FALSE(std::isfinite(residual.norm)) << formulation.name;
  }
}

TEST_F(SystemTest, MeasuresFromTheGivenRestState) {
  const Formulation formulation = oneFormulationPerElement()[1];
  for (const std::size_t tool : {0, 1}) {
    BodyModel model = clamped(formulation);
    model.materials[0].density = 1000;
    addGravity(model, {0, -9.81, 0});
    prepare(std::move(model));
    system_->chooseTool(tool);
    const double before = residual_.energy;
    system_->setRest(state_);
    EXPECT_EQ(system_->restState().u, state_.u);
    EXPECT_EQ(system_->restState().displacement, Eigen::Vector3d::Zero());
    EXPECT_EQ(residualAt(system_->restState()).energy, 0);
    const Eigen::VectorXd nothing =
        Eigen::VectorXd::Zero(system_->unknowns() + system_->multipliers());
    const State back = system_->moved(system_->restState(), nothing, 0, Eigen::Vector3d::Zero());
    EXPECT_EQ(back.u, state_.u);
    system_->assemble(back, residual_, tangent_);
    if (tool == 1) {
      EXPECT_EQ(residual_.free.tail<3>(), Eigen::Vector3d::Zero());
    }
    EXPECT_NE(before, 0);
    drawState();
    expectResidualIsTheDerivativeOfTheEnergy("from a rest of its own");
  }
}

TEST_F(SystemTest, AReleasedToolHoldsNothing) {
  prepare(oneFormulationPerElement()[2]);
  system_->releaseTool();
  EXPECT_FALSE(system_->tool());
  for (Eigen::Index unknown = 0; unknown < system_->unknowns(); ++unknown)
    EXPECT_FALSE(isHeld(unknown));
  drawState();
  expectResidualIsTheDerivativeOfTheEnergy("released");
  expectTangentIsTheDerivativeOfTheResidual("released");
}

TEST_F(SystemTest, ChangingTheToolAndBackChangesNothing) {
  const BodyModel model = clamped(oneFormulationPerElement()[2]);
  System fresh(model, chooseKernels()), used(model, chooseKernels());
  used.chooseTool(1);
  used.releaseTool();
  used.chooseTool(0);
  const State state = fresh.moved(
      fresh.restState(), Eigen::VectorXd::Constant(fresh.unknowns(), 1e-3), 1, {0, 0, 1e-3});
  Residual a, b;
  Tangent ka, kb;
  fresh.assemble(state, a, ka);
  used.assemble(state, b, kb);
  EXPECT_EQ(a.free, b.free);
  EXPECT_EQ(ka.values, kb.values);
  EXPECT_EQ(ka.tool_coupling, kb.tool_coupling);
  EXPECT_EQ(ka.tool, kb.tool);
}

Material youngMaterial(LawName law, double poisson) {
  return test::youngScene(law, poisson).regions[0].material;
}

/// Homogeneous states are exact on any mesh (closed forms: docs/solver.md). The body is stretched
/// along x with stress-free sides; the resultant on the end face divided by its area is the nominal
/// stress.
class HomogeneousState : public ::testing::Test {
 protected:
  /// Nominal stress along x, Pa, for the diagonal deformation `stretches` and pressure `p`; all
  /// inner and side forces must vanish.
  static double nominalStress(const Discretization& discretization, const Material& material,
                              const Eigen::Vector3d& stretches, double p) {
    const Eigen::Vector3d size(0.2, 0.1, 0.1);
    const BodyModel model =
        test::freeBody(test::distortedBoxMesh(size, {3, 2, 2}), discretization, material);
    const System system(model, chooseKernels());
    State state = system.restState();
    for (std::size_t node = 0; node < model.mesh.nodes.size(); ++node)
      for (int i = 0; i < 3; ++i)
        state.u[3 * node + i] = (stretches[i] - 1) * model.mesh.nodes[node][i];
    std::fill(state.q.begin(), state.q.end(), p / system.pressureScale());
    Residual residual;
    system.assemble(state, residual);
    double end_force = 0, elsewhere = 0;
    Eigen::Index row = 0;
    for (std::size_t node = 0; node < model.mesh.nodes.size(); ++node) {
      const double x = model.mesh.nodes[node][0];
      for (int i = 0; i < 3; ++i, ++row) {
        if (i == 0 && x > size[0] - 1e-9) {
          end_force += residual.free[row];
        } else if (i != 0 || x > 1e-9) {
          elsewhere = std::max(elsewhere, std::abs(residual.free[row]));
        }
      }
      if (node < state.q.size()) elsewhere = std::max(elsewhere, std::abs(residual.free[row++]));
    }
    EXPECT_LT(elsewhere, 1e-11 * system.forceScale()) << test::nameOf(discretization);
    return end_force / (size[1] * size[2]);
  }

  /// The elements with or without a pressure, with each form of the constraint.
  static std::vector<Discretization> elements(bool with_pressure) {
    std::vector<Discretization> all;
    for (Discretization element : test::everyElement())
      for (const Constraint constraint : {Constraint::ln_det_F, Constraint::det_F_minus_1}) {
        element.constraint = constraint;
        if ((element.pressure != PressureSpace::none) == with_pressure) all.push_back(element);
      }
    return all;
  }
};

TEST_F(HomogeneousState, MooneyRivlinInUniaxialStretch) {
  const struct {
    double stretch, stress_kPa;
  } table[] = {{0.5, -27.02},  {0.8, -4.4225}, {0.9, -1.82154}, {1.1, 1.34787},
               {1.2, 2.39296}, {1.5, 4.54593}, {2, 6.79}};
  for (const auto& row : table)
    for (const Discretization& element : elements(true)) {
      const double l = row.stretch, across = 1 / std::sqrt(l);
      // The pressure that makes the sides stress-free: sigma_yy = 0.
      const double c10 = 1300, c01 = 1280, I1 = l * l + 2 / l, I2 = 2 * l + 1 / (l * l);
      const double p = 2 * c10 * (1 / l - I1 / 3) + 2 * c01 * ((I1 - 1 / l) / l - 2 * I2 / 3);
      const double exact = 2 * (l - 1 / (l * l)) * (c10 + c01 / l);
      ASSERT_NEAR(exact / 1000, row.stress_kPa, 1e-4);
      EXPECT_NEAR(
          nominalStress(element, test::materialOf(LawName::mooney_rivlin), {l, across, across}, p),
          exact, 1e-9 * std::abs(exact))
          << test::nameOf(element) << ", stretch " << l;
    }
}

TEST_F(HomogeneousState, StVenantKirchhoffInUniaxialStretch) {
  const double E = 15480, nu = 0.49;
  const struct {
    double stretch, stress_kPa;
  } table[] = {{0.57735, -2.97913}, {0.8, -2.22912}, {1.1, 1.78794}, {1.5, 14.5125}};
  for (const auto& row : table) {
    const double l = row.stretch, across = std::sqrt(1 - nu * (l * l - 1));
    const double exact = E / 2 * l * (l * l - 1);
    ASSERT_NEAR(exact / 1000, row.stress_kPa, 1e-4);
    for (const Discretization& element : elements(false))
      EXPECT_NEAR(nominalStress(element, youngMaterial(LawName::st_venant_kirchhoff, nu),
                                {l, across, across}, 0),
                  exact, 1e-9 * std::abs(exact))
          << test::nameOf(element);
  }
}

TEST_F(HomogeneousState, ModifiedStVenantKirchhoffWithAndWithoutLambda) {
  for (const bool keep_lambda : {false, true}) {
    Material material = youngMaterial(LawName::modified_st_venant_kirchhoff, 0.49);
    const double E = 15480, nu = 0.49;
    const double mu = keep_lambda ? E / (2 * (1 + nu)) : E / 3;
    const double lambda = keep_lambda ? E * nu / ((1 + nu) * (1 - 2 * nu)) : 0;
    if (!keep_lambda) material.poisson.reset();
    for (const double l : {0.6, 0.8, 1.2, 1.5}) {
      const double g1 = (l * l - 1) / 2, g2 = (1 / l - 1) / 2, trace = g1 + 2 * g2;
      const double S1 = lambda * trace + 2 * mu * g1, S2 = lambda * trace + 2 * mu * g2;
      const double p = S2 / l;  // makes the sides stress-free: S2 - p C22^-1 = 0
      const double exact = l * (S1 - p / (l * l));
      const double across = 1 / std::sqrt(l);
      for (const Discretization& element : elements(true))
        EXPECT_NEAR(nominalStress(element, material, {l, across, across}, p), exact,
                    1e-9 * std::abs(exact))
            << test::nameOf(element) << ", stretch " << l;
    }
  }
}

}  // namespace
}  // namespace palpate
