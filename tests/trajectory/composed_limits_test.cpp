#include <gtest/gtest.h>

#include <cmath>

#include "conformance/timing_problems.h"
#include "motion/random_motions.h"
#include "tandem/trajectory/limit_check.h"
#include "tandem/trajectory/piece_derivatives.h"
#include "tandem/trajectory/spline.h"

namespace tandem::trajectory {
namespace {

using Eigen::VectorXd;
using motion::ArmMotion;
using motion::TimeMap;

constexpr int kJoints = 4;

motion::PiecewiseCubic random_spline(Rng& rng) {
  const int count = static_cast<int>(2 + rng.index(5));
  const auto path = test::random_path(rng, test::kPathKinds[rng.index(4)], count, kJoints);
  std::vector<double> h(path.size() + 1);
  for (double& x : h) x = std::pow(10, rng.uniform(-1, 0));
  return fit_spline(path, h);
}

/// A spline along a map that jumps at its knots, in degrees from 0 to 5.
ArmMotion composed(Rng& rng) {
  const ArmMotion arm = random_spline(rng);
  return *arm.along(motion::random_map(rng, static_cast<int>(1 + rng.index(3)), arm.duration()));
}

TEST(PieceDerivatives, AreTheDerivatives) {
  Rng rng(1);
  for (int i = 0; i < 100; ++i) {
    const ArmMotion arm = i % 4 == 0 ? ArmMotion(random_spline(rng)) : composed(rng);
    for (const ArmMotion::Piece& piece : arm.pieces()) {
      const PieceDerivatives derivatives(arm, piece);
      for (const double u : {0.0, 0.3, 1.0}) {
        const auto state = arm.on_piece(piece, piece.t0 + u * (piece.t1 - piece.t0));
        for (int j = 0; j < kJoints; ++j) {
          const double expected[] = {state.qd[j], state.qdd[j], state.qddd[j]};
          for (int order = 1; order <= 3; ++order) {
            const math::Bernstein p = derivatives(order, j);
            EXPECT_NEAR(p(u), expected[order - 1], 1e-9 * (1 + p.magnitude()));
          }
        }
      }
    }
  }
}

TEST(ComposedExtremes, MatchDenseSampling) {
  Rng rng(2);
  for (int i = 0; i < 100; ++i) {
    const ArmMotion arm = composed(rng);
    const Extremes e = extremes(arm);
    VectorXd low = VectorXd::Constant(kJoints, 1e9), high = -low;
    VectorXd v = VectorXd::Zero(kJoints), a = v, jerk = v;
    for (const ArmMotion::Piece& piece : arm.pieces()) {
      constexpr int kSamples = 1000;
      for (int k = 0; k <= kSamples; ++k) {
        const double s = static_cast<double>(k) / kSamples;
        const auto state = arm.on_piece(piece, (1 - s) * piece.t0 + s * piece.t1);
        low = low.cwiseMin(state.q);
        high = high.cwiseMax(state.q);
        v = v.cwiseMax(state.qd.cwiseAbs());
        a = a.cwiseMax(state.qdd.cwiseAbs());
        jerk = jerk.cwiseMax(state.qddd.cwiseAbs());
      }
    }
    for (int j = 0; j < kJoints; ++j) {
      // Samples lie within h / 2000 of every peak: of degree 14 they miss at most 1e-4 of it.
      const auto agrees = [](double exact, double sampled) {
        EXPECT_GE(exact, sampled * (1 - 1e-9) - 1e-9);
        EXPECT_LE(exact, sampled * (1 + 1e-4) + 1e-9);
      };
      agrees(e.velocity[j], v[j]);
      agrees(e.acceleration[j], a[j]);
      agrees(e.jerk[j], jerk[j]);
      EXPECT_LE(e.lowest[j], low[j] + 1e-9);
      EXPECT_GE(e.highest[j], high[j] - 1e-9);
    }
  }
}

TEST(ComposedExtremes, OfPositionAreOverTheLocalTimesThatAreVisited) {
  Rng rng(3);
  for (int i = 0; i < 50; ++i) {
    const ArmMotion arm = random_spline(rng);
    const double T = arm.duration(), from = rng.uniform(0, 0.5) * T, to = rng.uniform(0.5, 1) * T;
    const ArmMotion part = *arm.along(*TimeMap::make({0, 2}, {{{from, (to - from) / 2}}}));
    const Extremes e = extremes(part);
    VectorXd q(kJoints), low = VectorXd::Constant(kJoints, 1e9), high = -low;
    for (int k = 0; k <= 2000; ++k) {
      arm.position(from + (to - from) * k / 2000, q);
      low = low.cwiseMin(q);
      high = high.cwiseMax(q);
    }
    EXPECT_LT((e.highest - high).cwiseAbs().maxCoeff(), 1e-4);
    EXPECT_LT((e.lowest - low).cwiseAbs().maxCoeff(), 1e-4);
  }
}

TEST(ComposedExtremes, AlongTheIdentityAreThoseOfTheSpline) {
  Rng rng(4);
  for (int i = 0; i < 50; ++i) {
    const motion::PiecewiseCubic spline = random_spline(rng);
    const ArmMotion arm =
        *ArmMotion(spline).along(*TimeMap::make({0, spline.duration()}, {{{0, 1}}}));
    const Extremes exact = extremes(spline), e = extremes(arm);
    EXPECT_LT((e.velocity - exact.velocity).norm(), 1e-8 * (1 + exact.velocity.norm()));
    EXPECT_LT((e.acceleration - exact.acceleration).norm(), 1e-8 * exact.acceleration.norm());
    EXPECT_LT((e.jerk - exact.jerk).norm(), 1e-8 * exact.jerk.norm());
    EXPECT_LT((e.lowest - exact.lowest).norm(), 1e-12);
    EXPECT_LT((e.highest - exact.highest).norm(), 1e-12);
  }
}

TEST(ComposedExtremes, SeeANarrowPeakBetweenSamples) {
  // c dashes ahead and back within 4 ms, between two samples of any even hundred.
  const motion::PiecewiseCubic::Coefficients line =
      (motion::PiecewiseCubic::Coefficients(1, 4) << 0, 1, 0, 0).finished();
  const ArmMotion arm = *motion::PiecewiseCubic::make({0, 1}, {line});
  const double w = 4e-3, size = 16 / (w * w * w * w);
  const ArmMotion dash = *arm.along(*TimeMap::make(
      {0, 1.013, 1.013 + w, 2},
      {{{0.5}}, {{0.5, 0, 0.25 * size * w * w, -0.5 * size * w, 0.25 * size}}, {{0.5}}}));
  const Extremes e = extremes(dash);
  EXPECT_NEAR(e.highest[0], 0.75, 1e-9);
  // u^2 (1 - u)^2 has the slope 2 u (1 - u) (1 - 2 u), at most sqrt(3) / 9.
  EXPECT_NEAR(e.velocity[0], 4 / w * std::sqrt(3) / 9, 1e-6);
}

TEST(ComposedLimits, AreCheckedForTheWholeCell) {
  Rng rng(5);
  for (int i = 0; i < 50; ++i) {
    const motion::CellMotion cell({composed(rng), ArmMotion(random_spline(rng))});
    std::vector<robot::JointLimits> limits(2 * kJoints);
    for (robot::JointLimits& limit : limits) {
      limit.velocity = 2;
      limit.acceleration = 3;
      limit.jerk = 60;
    }
    const Extremes e = extremes(cell);
    EXPECT_EQ(e.velocity.tail(kJoints), extremes(cell.arms()[1]).velocity);
    const double factor = stretch_factor(e, limits);
    const motion::CellMotion slow(
        {cell.arms()[0].stretched(factor), cell.arms()[1].stretched(factor)});
    EXPECT_TRUE(check_limits(slow, limits).empty());
    const double less = factor * (1 - 1e-5);
    const motion::CellMotion fast({cell.arms()[0].stretched(less), cell.arms()[1].stretched(less)});
    EXPECT_FALSE(check_limits(fast, limits).empty());
  }
}

}  // namespace
}  // namespace tandem::trajectory
