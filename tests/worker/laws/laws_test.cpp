#include "worker/laws/laws.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "common/scene/material.hpp"
#include "worker/elements/element_kernels.hpp"

namespace palpate::kernels_default {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Fibers = std::array<Vector3d, 2>;

const Fibers no_fibers = {Vector3d::Zero(), Vector3d::Zero()};

struct Response {
  double W = 0;
  Vector6d S;
  Matrix6d D;
};

Vector6d strainVoigt(const Matrix3d& F) {
  const Matrix3d green = (F.transpose() * F - Matrix3d::Identity()) / 2;
  Vector6d e;
  for (int v = 0; v < 6; ++v) e[v] = (v < 3 ? 1 : 2) * green(voigt_row[v], voigt_column[v]);
  return e;
}

Matrix3d tensorOf(const Vector6d& voigt) {
  Matrix3d tensor;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) tensor(i, j) = voigt[voigt_of[i][j]];
  return tensor;
}

Strain<double> strainOf(const Vector6d& e, const Fibers& fibers) {
  Strain<double> strain{};
  Matrix3d C;
  for (int v = 0; v < 6; ++v) {
    strain.e[v] = e[v];
    const int I = voigt_row[v], K = voigt_column[v];
    C(I, K) = C(K, I) = (I == K ? 1.0 + 2 * e[v] : e[v]);
  }
  const Matrix3d inverse = C.inverse();
  for (int v = 0; v < 6; ++v) strain.C_inverse[v] = inverse(voigt_row[v], voigt_column[v]);
  strain.J = std::sqrt(C.determinant());
  for (int f = 0; f < 2; ++f)
    for (int i = 0; i < 3; ++i) strain.fiber[f][i] = fibers[f][i];
  return strain;
}

template <class Law>
Response respondToStrain(const Law& law, const Vector6d& e, const Fibers& fibers = no_fibers) {
  Response response;
  double S[6], D[6][6];
  law.evaluate(strainOf(e, fibers), response.W, S);
  law.tangent(strainOf(e, fibers), D);
  for (int v = 0; v < 6; ++v) {
    response.S[v] = S[v];
    for (int w = 0; w < 6; ++w) response.D(v, w) = D[v][w];
  }
  return response;
}

template <class Law>
Response respond(const Law& law, const Matrix3d& F, const Fibers& fibers = no_fibers) {
  return respondToStrain(law, strainVoigt(F), fibers);
}

void expectSame(const Response& a, const Response& b, double tolerance) {
  EXPECT_NEAR(a.W, b.W, tolerance);
  EXPECT_LT((a.S - b.S).cwiseAbs().maxCoeff(), tolerance);
  EXPECT_LT((a.D - b.D).cwiseAbs().maxCoeff(), tolerance);
}

/// Random deformation gradients from a fixed seed.
class Deformations {
 public:
  /// Draws F - I with entries up to `size`, then scales F to this volume ratio.
  Matrix3d draw(double size, double det_F) {
    Matrix3d F;
    do F = Matrix3d::Identity() + size * matrix();
    while (F.determinant() < 0.1);
    return F * std::cbrt(det_F / F.determinant());
  }
  Matrix3d rotation() {
    const Matrix3d Q = Eigen::HouseholderQR<Matrix3d>(matrix()).householderQ();
    return Q.determinant() * Q;
  }
  Matrix3d withStretches(double l1, double l2, double l3) {
    return rotation() * Vector3d(l1, l2, l3).asDiagonal() * rotation();
  }
  Vector3d direction() { return rotation().col(0); }

  /// Large and small deformation gradients with volume ratios from 0.5 to 2, and some with equal or
  /// nearly equal principal stretches.
  std::vector<Matrix3d> various() {
    std::vector<Matrix3d> all;
    for (int i = 0; i < 20; ++i) all.push_back(draw(0.4, 0.5 * std::pow(4.0, i / 19.0)));
    for (int i = 0; i < 5; ++i) all.push_back(draw(0.02, 1));
    for (int i = 0; i < 5; ++i) all.push_back(draw(1e-4, 1));
    for (const double apart : {0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3}) {
      all.push_back(withStretches(1.3, 1.3 + apart, 0.7));
      all.push_back(withStretches(1.1, 1.1 + apart, 1.1 - 2 * apart));
    }
    for (const double stretch : {0.8, 1.0, 1.25}) all.push_back(stretch * Matrix3d::Identity());
    return all;
  }

 private:
  Matrix3d matrix() {
    std::uniform_real_distribution<double> uniform(-1, 1);
    return Matrix3d::NullaryExpr([&] { return uniform(random_); });
  }

  std::mt19937 random_{7};
};

// Parameters of EveryLaw: a law, its material, fibres, and where D is continuous.
struct Isotropic {
  static Fibers fibers() { return no_fibers; }
  static bool isSmoothAt(const Matrix3d&) { return true; }
};
struct StVenantKirchhoffSample : Isotropic {
  static StVenantKirchhoff law() { return {254537, 5194.630872483221}; }
  static Material material() {
    return {.law = LawName::st_venant_kirchhoff, .young = 15480, .poisson = 0.49};
  }
};
struct NeoHookeanSample : Isotropic {
  static NeoHookean law() { return {5160}; }
  static Material material() { return {.law = LawName::neo_hookean, .mu = 5160}; }
};
struct MooneyRivlinSample : Isotropic {
  static MooneyRivlin law() { return {1300, 1280}; }
  static Material material() { return {.law = LawName::mooney_rivlin, .c10 = 1300, .c01 = 1280}; }
};
struct YeohSample : Isotropic {
  static Yeoh law() { return {1300, 400, 150}; }
  static Material material() { return {.law = LawName::yeoh, .c10 = 1300, .c20 = 400, .c30 = 150}; }
};
struct VerondaWestmannSample : Isotropic {
  static VerondaWestmann law() { return {900, 2.5}; }
  static Material material() { return {.law = LawName::veronda_westmann, .c1 = 900, .c2 = 2.5}; }
};
struct OgdenSample : Isotropic {
  static Ogden law() { return {{450}, {9.5}, 1}; }
  static Material material() { return {.law = LawName::ogden, .ogden = {{450, 9.5}}}; }
};
struct OgdenThreeTermsSample : Isotropic {
  static Ogden law() { return {{6300, 12, -100}, {1.3, 5, -2}, 3}; }
  static Material material() {
    return {.law = LawName::ogden, .ogden = {{6300, 1.3}, {12, 5}, {-100, -2}}};
  }
};
struct HolzapfelGasserOgdenSample {
  static HolzapfelGasserOgden law() { return {5160, 3000, 2.0, 0.1}; }
  static Material material() {
    return {.law = LawName::holzapfel_gasser_ogden,
            .mu = 5160,
            .k1 = 3000,
            .k2 = 2.0,
            .dispersion = 0.1};
  }
  static Fibers fibers() { return {Vector3d(1, 2, -2) / 3, Vector3d(0.6, 0, 0.8)}; }
  static double fiberStrain(const Matrix3d& F, const Vector3d& a) {
    const double scale = std::pow(F.determinant(), -2.0 / 3);
    const double j1 = scale * F.squaredNorm(), j4 = scale * (F * a).squaredNorm();
    return 0.1 * (j1 - 3) + 0.7 * (j4 - 1);
  }
  static bool isSmoothAt(const Matrix3d& F) {
    for (const Vector3d& a : fibers())
      if (std::abs(fiberStrain(F, a)) < 2e-3) return false;
    return true;
  }
};
struct HolzapfelGasserOgdenOneFamilySample : HolzapfelGasserOgdenSample {
  static Fibers fibers() { return {HolzapfelGasserOgdenSample::fibers()[0], Vector3d::Zero()}; }
};

template <class Sample>
class EveryLaw : public ::testing::Test {
 protected:
  Response respondToStrain(const Vector6d& e) const {
    return kernels_default::respondToStrain(law_, e, fibers_);
  }
  Response respond(const Matrix3d& F) const { return kernels_default::respond(law_, F, fibers_); }

  const decltype(Sample::law()) law_ = Sample::law();
  const Fibers fibers_ = Sample::fibers();
  const double modulus_ = shearModulus(Sample::material());
  Deformations deformations_;
};

using Samples =
    ::testing::Types<StVenantKirchhoffSample, NeoHookeanSample, MooneyRivlinSample, YeohSample,
                     VerondaWestmannSample, OgdenSample, OgdenThreeTermsSample,
                     HolzapfelGasserOgdenSample, HolzapfelGasserOgdenOneFamilySample>;
struct SampleNames {
  template <class Sample>
  static std::string GetName(int) {  // NOLINT(readability-identifier-naming): GoogleTest's
    const std::string name = ::testing::internal::GetTypeName<Sample>();
    const std::size_t start = name.rfind("::") + 2;
    return name.substr(start, name.rfind("Sample") - start);
  }
};
TYPED_TEST_SUITE(EveryLaw, Samples, SampleNames);

/// The derivative by central differences of fourth order.
template <class Value, class Function>
Value difference(const Function& f, double h) {
  return (8 * (f(h) - f(-h)) - (f(2 * h) - f(-2 * h))) / (12 * h);
}

TYPED_TEST(EveryLaw, HasStressAndTangentThatAreDerivativesOfItsEnergy) {
  constexpr double h = 2e-4;
  int checked = 0;
  for (const Matrix3d& F : this->deformations_.various()) {
    if (!TypeParam::isSmoothAt(F)) continue;
    const Vector6d e = strainVoigt(F);
    const Response here = this->respondToStrain(e);
    const double scale = here.D.cwiseAbs().maxCoeff();
    for (int v = 0; v < 6; ++v) {
      const auto moved = [&](double step) {
        return this->respondToStrain(e + step * Vector6d::Unit(v));
      };
      const double dW = difference<double>([&](double step) { return moved(step).W; }, h);
      const Vector6d dS = difference<Vector6d>([&](double step) { return moved(step).S; }, h);
      EXPECT_NEAR(dW, here.S[v], 1e-8 * scale) << "component " << v << ", F =\n" << F;
      EXPECT_LT((dS - here.D.col(v)).cwiseAbs().maxCoeff(), 1e-7 * scale)
          << "column " << v << ", F =\n"
          << F << "\nis\n"
          << here.D.col(v) << "\ndifferences\n"
          << dS;
    }
    ++checked;
  }
  EXPECT_GE(checked, 30);
}

TYPED_TEST(EveryLaw, HasASymmetricTangent) {
  for (const Matrix3d& F : this->deformations_.various()) {
    const Matrix6d D = this->respond(F).D;
    EXPECT_EQ((D - D.transpose()).cwiseAbs().maxCoeff(), 0);
  }
}

TYPED_TEST(EveryLaw, IsInvariantUnderARotationOfTheDeformedBody) {
  for (const Matrix3d& F : this->deformations_.various()) {
    if (!TypeParam::isSmoothAt(F)) continue;
    const Response here = this->respond(F);
    expectSame(this->respond(this->deformations_.rotation() * F), here,
               1e-11 * here.D.cwiseAbs().maxCoeff());
  }
}

TYPED_TEST(EveryLaw, RotatesWithTheBodyAtRestAndItsFibers) {
  for (const Matrix3d& F : this->deformations_.various()) {
    if (!TypeParam::isSmoothAt(F)) continue;
    const Matrix3d Q = this->deformations_.rotation();
    const Fibers turned = {Q * this->fibers_[0], Q * this->fibers_[1]};
    const Response here = this->respond(F);
    const Response there = kernels_default::respond(this->law_, F * Q.transpose(), turned);
    const double tolerance = 1e-11 * here.D.cwiseAbs().maxCoeff();
    EXPECT_NEAR(there.W, here.W, tolerance);
    EXPECT_LT((tensorOf(there.S) - Q * tensorOf(here.S) * Q.transpose()).cwiseAbs().maxCoeff(),
              tolerance);
  }
}

TYPED_TEST(EveryLaw, GivesEveryLaneOfAPackTheResultOfADouble) {
  const std::vector<Matrix3d> all = this->deformations_.various();
  for (std::size_t first = 0; first + lanes <= all.size(); first += lanes) {
    Strain<Pack> strain{};
    for (int l = 0; l < lanes; ++l) {
      const Strain<double> lane = strainOf(strainVoigt(all[first + l]), this->fibers_);
      for (int v = 0; v < 6; ++v) {
        strain.e[v][l] = lane.e[v];
        strain.C_inverse[v][l] = lane.C_inverse[v];
      }
      strain.J[l] = lane.J;
      for (int f = 0; f < 2; ++f)
        for (int i = 0; i < 3; ++i) strain.fiber[f][i][l] = lane.fiber[f][i];
    }
    Pack W, S[6], D[6][6];
    this->law_.evaluate(strain, W, S);
    this->law_.tangent(strain, D);
    for (int l = 0; l < lanes; ++l) {
      Response lane;
      lane.W = W[l];
      for (int v = 0; v < 6; ++v) {
        lane.S[v] = S[v][l];
        for (int w = 0; w < 6; ++w) lane.D(v, w) = D[v][w][l];
      }
      const Response expected = this->respond(all[first + l]);
      expectSame(lane, expected, 1e-12 * expected.D.cwiseAbs().maxCoeff());
    }
  }
}

/// The mean contribution of taut and slack fibers to D at rest: half of 4 k1 dE/dC (x) dE/dC.
Matrix6d meanOfFibersAtRest(const HolzapfelGasserOgden& law, const Fibers& fibers) {
  Matrix6d sum = Matrix6d::Zero();
  for (const Vector3d& a : fibers) {
    if (a.isZero()) continue;
    const Matrix3d gradient =
        (1 - 3 * law.dispersion) * (a * a.transpose() - Matrix3d::Identity() / 3);
    Vector6d voigt;
    for (int v = 0; v < 6; ++v) voigt[v] = gradient(voigt_row[v], voigt_column[v]);
    sum += 2 * law.k1 * voigt * voigt.transpose();
  }
  return sum;
}

TYPED_TEST(EveryLaw, IsFreeOfStressAtRestAndHasTheShearModulusOfItsMaterial) {
  Response rest = this->respond(Matrix3d::Identity());
  EXPECT_NEAR(rest.W, 0, 1e-12 * this->modulus_);
  EXPECT_LT(rest.S.cwiseAbs().maxCoeff(), 1e-12 * this->modulus_);
  // The modulus is that of the matrix between the fibers.
  if constexpr (std::is_base_of_v<HolzapfelGasserOgdenSample, TypeParam>)
    rest.D -= meanOfFibersAtRest(this->law_, this->fibers_);
  for (int v = 0; v < 3; ++v) {
    EXPECT_NEAR((rest.D(v, v) - rest.D(v, (v + 1) % 3)) / 2, this->modulus_, 1e-9 * this->modulus_);
    EXPECT_NEAR(rest.D(3 + v, 3 + v), this->modulus_, 1e-9 * this->modulus_);
  }
}

TYPED_TEST(EveryLaw, StoresVolumetricEnergyOnlyAsStVenantKirchhoff) {
  for (const double stretch : {0.7, 1.0, 1.4}) {
    const Response response = this->respond(stretch * Matrix3d::Identity());
    if (std::is_base_of_v<StVenantKirchhoff, decltype(TypeParam::law())>) {
      EXPECT_EQ(response.W > 0, stretch != 1);
    } else {
      EXPECT_NEAR(response.W, 0, 1e-11 * this->modulus_);
      EXPECT_LT(response.S.cwiseAbs().maxCoeff(), 1e-11 * this->modulus_);
    }
  }
}

/// The nominal stress along the first stretch if the third direction is free: the pressure of det F
/// = 1 is eliminated.
template <class Law>
double nominalStress(const Law& law, double l1, double l2, const Fibers& fibers = no_fibers) {
  const double l3 = 1 / (l1 * l2);
  const Matrix3d F = Vector3d(l1, l2, l3).asDiagonal();
  const Vector6d S = respond(law, F, fibers).S;
  return (l1 * l1 * S[0] - l3 * l3 * S[2]) / l1;
}
template <class Law>
double uniaxial(const Law& law, double l, const Fibers& fibers = no_fibers) {
  return nominalStress(law, l, 1 / std::sqrt(l), fibers);
}
template <class Law>
double equibiaxial(const Law& law, double l) {
  return nominalStress(law, l, l);
}
template <class Law>
double pureShear(const Law& law, double l) {
  return nominalStress(law, l, 1);
}

const std::vector<double> stretches = {0.5, 0.8, 0.9, 1.0, 1.1, 1.2, 1.5, 2.0};

TEST(MooneyRivlinLaw, HasTheTabulatedStressesOfHomogeneousStates) {
  const MooneyRivlin law{1300, 1280};
  struct Row {
    double stretch, uniaxial, equibiaxial, pure_shear;  // kPa
  };
  for (const Row& row :
       {Row{0.5, -27.0200, -102.0600, -38.7000}, Row{0.8, -4.42250, -9.54385, -5.95013},
        Row{0.9, -1.82154, -3.70854, -2.43419}, Row{1.1, 1.34787, 2.72960, 1.79922},
        Row{1.2, 2.39296, 5.01732, 3.20589}, Row{1.5, 4.54593, 11.43910, 6.21111},
        Row{2.0, 6.79000, 25.27875, 9.67500}}) {
    EXPECT_NEAR(uniaxial(law, row.stretch), 1e3 * row.uniaxial, 6e-3);
    EXPECT_NEAR(equibiaxial(law, row.stretch), 1e3 * row.equibiaxial, 6e-3);
    EXPECT_NEAR(pureShear(law, row.stretch), 1e3 * row.pure_shear, 6e-3);
  }
}

TEST(MooneyRivlinLaw, IsThePapersCorrectedEnergyForIsochoricStates) {
  Deformations deformations;
  for (int round = 0; round < 20; ++round) {
    const Vector6d e = strainVoigt(deformations.draw(0.2, 1));
    const Matrix3d green = (tensorOf(e) + Matrix3d(tensorOf(e).diagonal().asDiagonal())) / 2;
    const double trace = green.trace(), squares = green.squaredNorm();
    const double paper = 2 * ((1300 + 2 * 1280) * trace + 1280 * (trace * trace - squares));
    EXPECT_NEAR(respondToStrain(MooneyRivlin{1300, 1280}, e).W, paper, 1e-8);
  }
}

TEST(NeoHookeanLaw, HasTheStressesOfHomogeneousStates) {
  const double mu = 5160;
  for (const double l : stretches) {
    EXPECT_NEAR(uniaxial(NeoHookean{mu}, l), mu * (l - std::pow(l, -2)), 1e-9 * mu);
    EXPECT_NEAR(equibiaxial(NeoHookean{mu}, l), mu * (l - std::pow(l, -5)), 1e-9 * mu);
    EXPECT_NEAR(pureShear(NeoHookean{mu}, l), mu * (l - std::pow(l, -3)), 1e-9 * mu);
  }
}

TEST(YeohLaw, HasTheStressOfUniaxialTension) {
  for (const double l : stretches) {
    const double x = l * l + 2 / l - 3;
    const double expected = 2 * (l - 1 / (l * l)) * (1300 + 2 * 400 * x + 3 * 150 * x * x);
    EXPECT_NEAR(uniaxial(Yeoh{1300, 400, 150}, l), expected, 1e-6);
  }
}

TEST(VerondaWestmannLaw, HasTheStressOfUniaxialTension) {
  const double c1 = 900, c2 = 2.5;
  for (const double l : stretches) {
    const double growth = std::exp(c2 * (l * l + 2 / l - 3));
    EXPECT_NEAR(uniaxial(VerondaWestmann{c1, c2}, l),
                2 * (l - 1 / (l * l)) * c1 * c2 * (growth - 0.5 / l), 1e-10 * c1 * c2 * growth);
  }
}

TEST(OgdenLaw, HasTheStressesOfHomogeneousStates) {
  // Treloar's rubber (Ogden 1972), Pa.
  const Ogden law{{6.3e5, 1.2e3, -1e4}, {1.3, 5, -2}, 3};
  for (const double l : stretches) {
    double tension = 0, biaxial = 0, shear = 0;
    for (int p = 0; p < 3; ++p) {
      const double mu = law.mu[p], alpha = law.alpha[p];
      tension += mu * (std::pow(l, alpha - 1) - std::pow(l, -alpha / 2 - 1));
      biaxial += mu * (std::pow(l, alpha - 1) - std::pow(l, -2 * alpha - 1));
      shear += mu * (std::pow(l, alpha - 1) - std::pow(l, -alpha - 1));
    }
    EXPECT_NEAR(uniaxial(law, l), tension, 1e-10 * 4e5);
    EXPECT_NEAR(equibiaxial(law, l), biaxial, 1e-10 * 4e5);
    EXPECT_NEAR(pureShear(law, l), shear, 1e-10 * 4e5);
  }
}

template <class Law, class Other>
void expectSameLaw(const Law& law, const Other& other, const Fibers& fibers = no_fibers) {
  Deformations deformations;
  for (const Matrix3d& F : deformations.various()) {
    const Response expected = respond(other, F, fibers);
    expectSame(respond(law, F, fibers), expected, 1e-11 * expected.D.cwiseAbs().maxCoeff());
  }
}

TEST(Laws, CoincideIfOneContainsTheOther) {
  const NeoHookean neo_hookean{5160};
  expectSameLaw(Ogden{{5160}, {2}, 1}, neo_hookean);
  expectSameLaw(Ogden{{2 * 1300, -2 * 1280}, {2, -2}, 2}, MooneyRivlin{1300, 1280});
  expectSameLaw(MooneyRivlin{2580, 0}, neo_hookean);
  expectSameLaw(Yeoh{2580, 0, 0}, neo_hookean);
  const Fibers fibers = HolzapfelGasserOgdenSample::fibers();
  expectSameLaw(HolzapfelGasserOgden{5160, 1e-12, 2, 0.1}, neo_hookean, fibers);
  expectSameLaw(HolzapfelGasserOgden{5160, 3000, 2, 0.1}, neo_hookean, no_fibers);
}

TEST(HolzapfelGasserOgdenLaw, HasTheStressOfUniaxialTensionAlongItsFibersAndNoFibersInCompression) {
  const double mu = 5160, k1 = 3000, k2 = 2;
  const Fibers along = {Vector3d::UnitX(), Vector3d::Zero()};
  for (const double l : stretches) {
    const double E = std::max(0.0, l * l - 1);
    const double fiber = 2 * k1 * l * E * std::exp(k2 * E * E);
    EXPECT_NEAR(uniaxial(HolzapfelGasserOgden{mu, k1, k2, 0}, l, along),
                mu * (l - 1 / (l * l)) + fiber, 1e-10 * (mu + fiber));
  }
}

TEST(HolzapfelGasserOgdenLaw, AtRestHasTheMeanTangentOfTautAndSlackFibers) {
  const HolzapfelGasserOgden law{5160, 3000, 2, 0.1};
  const Fibers fibers = HolzapfelGasserOgdenSample::fibers();
  // A strain that slightly stretches the fibers; minus this strain compresses them.
  const Vector6d e = strainVoigt(Vector3d(1 + 1e-9, 1 + 1e-9, 1 - 2e-9).asDiagonal());
  const Fibers family = {fibers[0], Vector3d::Zero()};
  const Matrix6d one = respondToStrain(law, e, family).D,
                 other = respondToStrain(law, -e, family).D,
                 rest = respondToStrain(law, Vector6d::Zero(), family).D;
  EXPECT_GT((one - other).cwiseAbs().maxCoeff(), 1000);
  EXPECT_LT((rest - (one + other) / 2).cwiseAbs().maxCoeff(), 1e-2);
}

TEST(HolzapfelGasserOgdenLaw, IsIsotropicWhenItsFibersAreFullyDispersed) {
  const HolzapfelGasserOgden law{5160, 3000, 2, 1.0 / 3};
  Deformations deformations;
  const Fibers fibers = {deformations.direction(), Vector3d::Zero()};
  const Fibers others = {deformations.direction(), Vector3d::Zero()};
  for (int round = 0; round < 10; ++round) {
    const Matrix3d F = deformations.draw(0.3, 1);
    expectSame(respond(law, F, fibers), respond(law, F, others), 1e-8);
  }
}

TEST(HolzapfelGasserOgdenLaw, SumsItsFamiliesOfFibers) {
  const HolzapfelGasserOgden law{5160, 3000, 2, 0.1};
  const auto [a, b] = HolzapfelGasserOgdenSample::fibers();
  Deformations deformations;
  for (int round = 0; round < 10; ++round) {
    const Matrix3d F = deformations.draw(0.3, 1);
    const double both = respond(law, F, {a, b}).W, none = respond(law, F).W;
    EXPECT_NEAR(both - none,
                respond(law, F, {a, Vector3d::Zero()}).W +
                    respond(law, F, {Vector3d::Zero(), b}).W - 2 * none,
                1e-9);
  }
}

TEST(Laws, GiveAnInfiniteEnergyWhereTheExponentialOverflows) {
  const Matrix3d F = Vector3d(30, 1, 1.0 / 30).asDiagonal();
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(respond(VerondaWestmann{900, 2.5}, F).W, infinity);
  EXPECT_EQ(
      respond(HolzapfelGasserOgden{5160, 3000, 2, 0.1}, F, {Vector3d::UnitX(), Vector3d::Zero()}).W,
      infinity);
}

TEST(PrincipalStrains, HaveAnOrthonormalBasisEvenIfTheyCoincide) {
  Deformations deformations;
  for (const Matrix3d& F : deformations.various()) {
    const Vector6d voigt = strainVoigt(F);
    double e[6];
    std::copy(voigt.begin(), voigt.end(), e);
    const PrincipalStrains<double> principal = principalStrains(e);
    Matrix3d N;
    Vector3d values;
    for (int i = 0; i < 3; ++i) {
      values[i] = principal.value[i];
      for (int I = 0; I < 3; ++I) N(I, i) = principal.direction[i][I];
    }
    const Matrix3d green = (F.transpose() * F - Matrix3d::Identity()) / 2;
    const double size = green.norm();
    EXPECT_LT((N.transpose() * N - Matrix3d::Identity()).norm(), 1e-14);
    EXPECT_LE((N * values.asDiagonal() * N.transpose() - green).norm(), 2e-15 * size + 1e-18)
        << green;
    std::sort(values.begin(), values.end());
    EXPECT_LE((values - Eigen::SelfAdjointEigenSolver<Matrix3d>(green).eigenvalues()).norm(),
              4e-15 * size + 1e-18);
  }
}

TEST(VolumetricEnergy, VanishesAtRestAndHasTheStatedDerivatives) {
  const double bulk = 1e5, h = 1e-4;
  const VolumeDerivatives<double> rest = volumetricEnergy(bulk, 1.0);
  EXPECT_EQ(rest.U, 0);
  EXPECT_EQ(rest.dU, 0);
  EXPECT_EQ(rest.ddU, bulk);
  for (const double J : {0.3, 0.8, 0.999, 1.0, 1.001, 1.2, 2.5}) {
    const VolumeDerivatives<double> here = volumetricEnergy(bulk, J);
    EXPECT_NEAR(here.U, bulk / 4 * (J * J - 1 - 2 * std::log(J)), 1e-15 * bulk);
    const auto U = [&](double step) { return volumetricEnergy(bulk, J + step).U; };
    const auto dU = [&](double step) { return volumetricEnergy(bulk, J + step).dU; };
    EXPECT_NEAR(difference<double>(U, h), here.dU, 1e-9 * bulk);
    EXPECT_NEAR(difference<double>(dU, h), here.ddU, 1e-9 * bulk);
  }
  EXPECT_TRUE(std::isnan(volumetricEnergy(bulk, -0.1).U));
}

TEST(VolumetricEnergy, GivesEveryLaneOfAPackTheResultOfADouble) {
  const Pack J = {0.3, 0.5, 0.9, 1.0, 1.1, 1.5, 2.0, 9.0};
  const VolumeDerivatives<Pack> pack = volumetricEnergy(1e5, J);
  for (int l = 0; l < lanes; ++l) {
    const VolumeDerivatives<double> lane = volumetricEnergy(1e5, static_cast<double>(J[l]));
    EXPECT_DOUBLE_EQ(pack.U[l], lane.U);
    EXPECT_DOUBLE_EQ(pack.dU[l], lane.dU);
    EXPECT_DOUBLE_EQ(pack.ddU[l], lane.ddU);
  }
}

}  // namespace
}  // namespace palpate::kernels_default
