#include "tandem/math/bernstein.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "tandem/core/contract.h"
#include "tandem/core/rng.h"

namespace tandem::math {
namespace {

double horner(const std::vector<double>& a, double u) {
  double value = 0;
  for (std::size_t i = a.size(); i-- > 0;) value = value * u + a[i];
  return value;
}

std::vector<double> random_powers(Rng& rng, std::size_t degree) {
  std::vector<double> a(degree + 1);
  for (double& c : a) c = rng.uniform(-2, 2) * (rng.index(5) == 0 ? 1e-12 : 1);
  return a;
}

/// (u - r_0) (u - r_1) ..., times a scale.
std::vector<double> with_roots(const std::vector<double>& roots, double scale) {
  std::vector<double> a{scale};
  for (const double r : roots) {
    a.push_back(0);
    for (std::size_t i = a.size() - 1; i > 0; --i) a[i] = a[i - 1] - r * a[i];
    a[0] *= -r;
  }
  return a;
}

/// Real eigenvalues of the companion matrix.
std::vector<double> companion_roots(const std::vector<double>& a) {
  const auto n = static_cast<Eigen::Index>(a.size()) - 1;
  Eigen::MatrixXd C = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i + 1 < n; ++i) C(i + 1, i) = 1;
  for (Eigen::Index i = 0; i < n; ++i) C(i, n - 1) = -a[static_cast<std::size_t>(i)] / a.back();
  std::vector<double> real;
  for (const auto& z : C.eigenvalues()) {
    if (std::abs(z.imag()) < 1e-9) real.push_back(z.real());
  }
  std::ranges::sort(real);
  return real;
}

TEST(Bernstein, IsThePolynomialAndEnclosesIt) {
  Rng rng(1);
  for (int i = 0; i < 400; ++i) {
    const std::vector<double> a = random_powers(rng, rng.index(16));
    const Bernstein p(a);
    const auto [first, second] = p.halves();
    EXPECT_EQ(p.degree() + 1, static_cast<int>(a.size()));
    EXPECT_NEAR(p.front(), a[0], 1e-14);
    EXPECT_NEAR(p.back(), horner(a, 1), 1e-12);
    EXPECT_EQ(first.back(), second.front());
    for (int k = 0; k <= 50; ++k) {
      const double u = k / 50.0, value = horner(a, u);
      EXPECT_NEAR(p(u), value, 1e-12);
      EXPECT_NEAR(first(u), horner(a, u / 2), 1e-12);
      EXPECT_NEAR(second(u), horner(a, 0.5 + u / 2), 1e-12);
      EXPECT_LE(p.lower(), value + 1e-12);
      EXPECT_GE(p.upper(), value - 1e-12);
      EXPECT_GE(p.magnitude(), std::abs(value) - 1e-12);
    }
  }
  const Bernstein one(std::vector<double>{1, 0}), u(std::vector<double>{0, 1});
  EXPECT_DOUBLE_EQ(Bernstein::combination(2, one, -3, u, 4, u)(0.25), 2.25);
  EXPECT_THROW(Bernstein::combination(1, one, 1, u, 1, Bernstein(std::vector<double>{1})),
               ContractViolation);
  EXPECT_THROW(Bernstein(std::vector<double>{}), ContractViolation);
  EXPECT_THROW(Bernstein(std::vector<double>(17, 1.0)), ContractViolation);
}

TEST(Bernstein, FindsTheRootsOfTheCompanionMatrix) {
  Rng rng(2);
  int compared = 0;
  for (int i = 0; i < 800; ++i) {
    std::vector<double> a(2 + rng.index(6));
    for (double& c : a) c = rng.uniform(-1, 1);
    std::vector<double> expected;
    bool is_plain = true;  // No root at an end or beside another, where both ways may differ.
    for (const double r : companion_roots(a)) {
      if (std::min(std::abs(r), std::abs(r - 1)) < 1e-6) is_plain = false;
      if (r <= 0 || r >= 1) continue;
      if (!expected.empty() && r - expected.back() < 1e-4) is_plain = false;
      expected.push_back(r);
    }
    if (!is_plain) continue;
    const std::vector<double> found = roots(Bernstein(a));
    ASSERT_EQ(found.size(), expected.size()) << i;
    for (std::size_t k = 0; k < found.size(); ++k) EXPECT_NEAR(found[k], expected[k], 1e-9);
    compared += static_cast<int>(found.size());
  }
  EXPECT_GT(compared, 200);
}

TEST(Bernstein, FindsRootsThatItWasMadeOf) {
  Rng rng(3);
  for (int i = 0; i < 300; ++i) {
    std::vector<double> made(1 + rng.index(5));
    for (double& r : made) r = rng.uniform(0.02, 0.98);
    std::ranges::sort(made);
    bool apart = true;
    for (std::size_t k = 1; k < made.size(); ++k) apart = apart && made[k] - made[k - 1] > 1e-2;
    if (!apart) continue;
    const std::vector<double> found = roots(Bernstein(with_roots(made, rng.uniform(0.1, 10))));
    ASSERT_EQ(found.size(), made.size());
    for (std::size_t k = 0; k < made.size(); ++k) EXPECT_NEAR(found[k], made[k], 1e-9);
  }
}

TEST(Bernstein, SeesRootsAtTheEndsAndDoubleOnes) {
  const auto near = [](const std::vector<double>& found, double root) {
    return std::ranges::any_of(found, [&](double u) { return std::abs(u - root) < 1e-6; });
  };
  EXPECT_EQ(roots(Bernstein(std::vector<double>{0, 1})), (std::vector<double>{0}));
  EXPECT_EQ(roots(Bernstein(std::vector<double>{1, -1})), (std::vector<double>{1}));
  EXPECT_EQ(roots(Bernstein(std::vector<double>{0, 1, -1})), (std::vector<double>{0, 1}));
  EXPECT_TRUE(near(roots(Bernstein(with_roots({0.3, 0.3, 0.7}, 1))), 0.7));
  EXPECT_EQ(roots(Bernstein(with_roots({0.5, 0.5}, 1))), (std::vector<double>{0.5}));
  EXPECT_TRUE(roots(Bernstein(std::vector<double>{0, 0, 0})).empty());
  EXPECT_TRUE(roots(Bernstein(std::vector<double>{2})).empty());
  EXPECT_TRUE(roots(Bernstein(std::vector<double>{1, 0, 1})).empty());
}

TEST(Bernstein, FindsTheLargestMagnitude) {
  Rng rng(4);
  for (int i = 0; i < 300; ++i) {
    const std::vector<double> a = random_powers(rng, rng.index(16));
    double sampled = 0;
    constexpr int kSamples = 4000;
    for (int k = 0; k <= kSamples; ++k) {
      sampled = std::max(sampled, std::abs(horner(a, static_cast<double>(k) / kSamples)));
    }
    const double found = largest_magnitude(Bernstein(a), 0);
    EXPECT_GE(found, sampled * (1 - 1e-9) - 1e-13);
    EXPECT_LE(found, sampled + 2000.0 / kSamples / kSamples + 1e-13);  // |p''| / 8 is below 2000.
    EXPECT_EQ(largest_magnitude(Bernstein(a), 1e3), 1e3);
  }
}

TEST(Bernstein, FindsAPeakBesideAnEnd) {
  // u^14 (1 - u).
  std::vector<double> late(16, 0.0);
  late[14] = 1;
  late[15] = -1;
  const double peak = 14.0 / 15;
  EXPECT_NEAR(largest_magnitude(Bernstein(late), 0), std::pow(peak, 14) - std::pow(peak, 15),
              1e-10);
}

}  // namespace
}  // namespace tandem::math
