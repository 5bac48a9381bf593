#include "tandem/trajectory/limit_check.h"

#include <gtest/gtest.h>

#include <cmath>

#include "conformance/timing_problems.h"
#include "tandem/core/contract.h"
#include "tandem/trajectory/spline.h"

namespace tandem::trajectory {
namespace {

using Eigen::VectorXd;
using motion::PiecewiseCubic;
using Coefficients = PiecewiseCubic::Coefficients;

PiecewiseCubic one_segment(double T, double c0, double c1, double c2, double c3) {
  Coefficients c(1, 4);
  c << c0, c1, c2, c3;
  return *PiecewiseCubic::make({0, T}, {c});
}

TEST(Extremes, AreExactOnKnownCubics) {
  // s^3 - 3 s: turns at 1 with value -2, ends at 2 with value 2.
  const Extremes turn = extremes(one_segment(2, 0, -3, 0, 1));
  EXPECT_DOUBLE_EQ(turn.lowest[0], -2);
  EXPECT_DOUBLE_EQ(turn.highest[0], 2);
  EXPECT_DOUBLE_EQ(turn.velocity[0], 9);
  EXPECT_DOUBLE_EQ(turn.acceleration[0], 12);
  EXPECT_DOUBLE_EQ(turn.jerk[0], 6);
  // Velocity 3 s - 3 s^2 peaks inside, at 1/2.
  EXPECT_DOUBLE_EQ(extremes(one_segment(1, 0, 0, 1.5, -1)).velocity[0], 0.75);
  const Extremes still = extremes(one_segment(1, -4, 0, 0, 0));
  EXPECT_EQ(still.lowest[0], -4);
  EXPECT_EQ(still.highest[0], -4);
  EXPECT_EQ(still.velocity[0], 0);
}

TEST(Extremes, MatchDenseSampling) {
  for (int seed = 0; seed < 150; ++seed) {
    Rng rng(static_cast<std::uint64_t>(seed));
    const int count = static_cast<int>(2 + rng.index(8));
    const auto path = test::random_path(rng, test::kPathKinds[seed % 4], count, 4);
    std::vector<double> h(path.size() + 1);
    for (double& x : h) x = std::pow(10, rng.uniform(-1.5, 0));
    const PiecewiseCubic spline = fit_spline(path, h);
    const Extremes e = extremes(spline);
    VectorXd low = VectorXd::Constant(4, 1e9), high = -low, v = VectorXd::Zero(4), a = v, jerk = v;
    constexpr int kSamples = 400;
    for (std::size_t k = 0; k + 1 < spline.knots().size(); ++k) {
      for (int i = 0; i < kSamples; ++i) {
        const double s = static_cast<double>(i) / kSamples;
        const auto state = spline.at((1 - s) * spline.knots()[k] + s * spline.knots()[k + 1]);
        low = low.cwiseMin(state.q);
        high = high.cwiseMax(state.q);
        v = v.cwiseMax(state.qd.cwiseAbs());
        a = a.cwiseMax(state.qdd.cwiseAbs());
        jerk = jerk.cwiseMax(state.qddd.cwiseAbs());
      }
    }
    for (int j = 0; j < 4; ++j) {
      // Samples lie within h / 800 of every peak: they miss less than a parabola's drop there.
      const double drop = 1e-5 * (e.highest[j] - e.lowest[j] + 1);
      EXPECT_LE(e.lowest[j], low[j] + 1e-12);
      EXPECT_GE(e.lowest[j], low[j] - drop - 1e-6 * e.acceleration[j]);
      EXPECT_GE(e.highest[j], high[j] - 1e-12);
      EXPECT_LE(e.highest[j], high[j] + drop + 1e-6 * e.acceleration[j]);
      EXPECT_GE(e.velocity[j], v[j] - 1e-9);
      EXPECT_LE(e.velocity[j], v[j] + 1e-6 * e.jerk[j] + 1e-9);
      EXPECT_NEAR(e.acceleration[j], a[j], 1e-9 * (1 + a[j]));
      EXPECT_NEAR(e.jerk[j], jerk[j], 1e-9 * (1 + jerk[j]));
    }
  }
}

TEST(CheckLimits, FindsEveryKindWorstFirst) {
  robot::JointLimits limit{-1, 1, 6, 3, 5};
  // As above: position -2 .. 2, velocity 9, acceleration 12, jerk 6.
  const auto violations = check_limits(one_segment(2, 0, -3, 0, 1), {limit});
  ASSERT_EQ(violations.size(), 5u);
  EXPECT_EQ(violations[0].kind, LimitKind::kAcceleration);  // 300 % over.
  EXPECT_EQ(violations[0].value, 12);
  EXPECT_EQ(violations[0].limit, 3);
  EXPECT_EQ(violations[1].kind, LimitKind::kPosition);  // 1 rad over, at both sides.
  EXPECT_EQ(violations[1].value, -2);
  EXPECT_EQ(violations[1].limit, -1);
  EXPECT_EQ(violations[2].value, 2);
  EXPECT_EQ(violations[2].limit, 1);
  EXPECT_EQ(violations[3].kind, LimitKind::kVelocity);  // 50 %.
  EXPECT_EQ(violations[4].kind, LimitKind::kJerk);      // 20 %.
  EXPECT_EQ(violations[4].joint, 0);
}

TEST(CheckLimits, ToleratesWhatItIsTold) {
  const PiecewiseCubic motion = one_segment(2, 0, -3, 0, 1);
  robot::JointLimits limit;
  EXPECT_TRUE(check_limits(motion, {limit}, 0).empty());  // No limits, no violations.
  limit.velocity = 9;
  EXPECT_TRUE(check_limits(motion, {limit}, 0).empty());  // Equal is within.
  limit.velocity = std::nextafter(9, 0);
  EXPECT_EQ(check_limits(motion, {limit}, 0).size(), 1u);
  EXPECT_TRUE(check_limits(motion, {limit}).empty());
  limit.velocity = 9 / 1.01;
  EXPECT_EQ(check_limits(motion, {limit}, 0.0099).size(), 1u);
  EXPECT_TRUE(check_limits(motion, {limit}, 0.0101).empty());
  limit = {};
  limit.upper = 1.9;
  EXPECT_TRUE(check_limits(motion, {limit}, 0.11).empty());
  EXPECT_EQ(check_limits(motion, {limit}, 0.09).size(), 1u);
  EXPECT_THROW(check_limits(motion, {}), ContractViolation);
}

TEST(Describe, NamesJointQuantityAndBothValues) {
  const LimitViolation violation{1, LimitKind::kVelocity, 2.3, 2.175};
  EXPECT_EQ(describe(violation, {"a", "left/panda_joint2"}),
            "velocity of left/panda_joint2 reaches 2.3, its limit is 2.175 [rad/s or m/s]");
  EXPECT_THROW(describe(violation, {"a"}), ContractViolation);
}

TEST(StretchFactor, JustRestoresTheLimits) {
  for (int seed = 0; seed < 100; ++seed) {
    Rng rng(static_cast<std::uint64_t>(seed));
    const auto path = test::random_path(rng, test::PathKind::kZigzag, 5, 14);
    const auto limits = test::two_panda_limits(seed % 2 == 0);
    std::vector<double> h(path.size() + 1);
    for (double& x : h) x = rng.uniform(0.05, 3);
    const PiecewiseCubic spline = fit_spline(path, h);
    const double factor = stretch_factor(extremes(spline), limits);
    EXPECT_TRUE(check_limits(spline.stretched(factor), limits, 1e-9).empty());
    EXPECT_FALSE(check_limits(spline.stretched(factor * (1 - 1e-6)), limits, 1e-9).empty());
  }
}

}  // namespace
}  // namespace tandem::trajectory
