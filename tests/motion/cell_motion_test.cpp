#include "tandem/motion/cell_motion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "motion/random_motions.h"
#include "tandem/core/contract.h"

namespace tandem::motion {
namespace {

using Eigen::VectorXd;
using Coefficients = PiecewiseCubic::Coefficients;

/// C2 and zero-clamped: jerk +1, -1, -1, +1 times a size in four equal intervals.
PiecewiseCubic smooth_motion(Rng& rng, int dof) {
  const double h = rng.uniform(0.2, 0.8);
  std::vector<Coefficients> segments(4, Coefficients::Zero(dof, 4));
  for (Eigen::Index j = 0; j < dof; ++j) {
    double q = rng.uniform(-1, 1), v = 0, a = 0;
    const double size = rng.uniform(-20, 20);
    for (std::size_t k = 0; k < 4; ++k) {
      constexpr double kJerk[] = {1, -1, -1, 1};
      const double jerk = size * kJerk[k];
      segments[k].row(j) << q, v, a / 2, jerk / 6;
      q += h * (v + h * (a / 2 + h * jerk / 6));
      v += h * (a + h * jerk / 2);
      a += h * jerk;
    }
  }
  return *PiecewiseCubic::make({0, h, 2 * h, 3 * h, 4 * h}, segments);
}

ArmMotion composed(Rng& rng, bool smooth = false) {
  PiecewiseCubic spline = smooth ? smooth_motion(rng, 3) : random_motion(rng, 4, 3);
  const TimeMap map = random_map(rng, static_cast<int>(1 + rng.index(3)), spline.duration());
  return *ArmMotion(std::move(spline)).along(map);
}

TEST(ArmMotion, WithoutAMapIsItsSpline) {
  Rng rng(1);
  const PiecewiseCubic spline = random_motion(rng, 4, 2);
  const ArmMotion arm = spline;
  EXPECT_EQ(arm.duration(), spline.duration());
  EXPECT_FALSE(arm.map());
  EXPECT_EQ(arm.largest_jumps(), spline.largest_jumps());
  VectorXd D(2), D_spline(2);
  for (int i = 0; i < 50; ++i) {
    const double t = rng.uniform(-0.1, 1.1) * spline.duration();
    EXPECT_EQ(arm.at(t).q, spline.at(t).q);
    EXPECT_EQ(arm.at(t).qddd, spline.at(t).qddd);
    arm.deviation(t, t + 0.2, D);
    spline.deviation(t, t + 0.2, D_spline);
    EXPECT_EQ(D, D_spline);
  }
  const auto pieces = arm.pieces();
  ASSERT_EQ(pieces.size(), spline.segments().size());
  EXPECT_EQ(pieces[2].t0, spline.knots()[2]);
  EXPECT_EQ(pieces[2].t1, spline.knots()[3]);
}

TEST(ArmMotion, AlongTheIdentityIsItsSpline) {
  Rng rng(2);
  const PiecewiseCubic spline = random_motion(rng, 4, 3);
  const auto arm = ArmMotion(spline).along(*TimeMap::make({0, spline.duration()}, {{{0, 1}}}));
  ASSERT_TRUE(arm);
  EXPECT_EQ(arm->pieces().size(), spline.segments().size());
  for (int i = 0; i < 100; ++i) {
    const double t = rng.uniform(0, spline.duration());
    EXPECT_LT((arm->at(t).q - spline.at(t).q).norm(), 1e-12);
    EXPECT_LT((arm->at(t).qdd - spline.at(t).qdd).norm(), 1e-12);
    EXPECT_LT((arm->at(t).qddd - spline.at(t).qddd).norm(), 1e-12);
  }
  EXPECT_LT((arm->largest_jumps() - spline.largest_jumps()).norm(), 1e-9);
}

TEST(ArmMotion, IsTheCompositionOfBoth) {
  Rng rng(3);
  for (int i = 0; i < 200; ++i) {
    const ArmMotion arm = composed(rng);
    VectorXd q(3);
    for (int k = 0; k < 20; ++k) {
      const double t = rng.uniform(-0.1, 1.1) * arm.duration();
      arm.position(t, q);
      EXPECT_EQ(q, arm.at(t).q);
      EXPECT_LT((q - arm.spline().at((*arm.map())(t)).q).norm(), 1e-12);
    }
  }
}

TEST(ArmMotion, DerivativesAgreeWithDifferences) {
  Rng rng(4);
  for (int i = 0; i < 300; ++i) {
    const ArmMotion arm = composed(rng);
    for (const ArmMotion::Piece& piece : arm.pieces()) {
      // Within a piece everything is a polynomial, of up to degree 15.
      const double h = 1e-4 * (piece.t1 - piece.t0), t = 0.5 * (piece.t0 + piece.t1);
      if (h < 1e-7) continue;
      const JointState s = arm.at(t), before = arm.at(t - h), after = arm.at(t + h);
      const auto check = [&](const VectorXd& d, const VectorXd& low, const VectorXd& high) {
        const double scale = d.norm() + low.norm() / (piece.t1 - piece.t0) + 1;
        EXPECT_LT(((high - low) / (2 * h) - d).norm(), 2e-4 * scale);
      };
      check(s.qd, before.q, after.q);
      check(s.qdd, before.qd, after.qd);
      check(s.qddd, before.qdd, after.qdd);
      EXPECT_LT((arm.on_piece(piece, t).qddd - s.qddd).norm(), 1e-9 * (1 + s.qddd.norm()));
    }
  }
}

TEST(ArmMotion, WaitsWhereItsTimeIsCutOff) {
  Rng rng(5);
  const PiecewiseCubic spline = random_motion(rng, 2, 2);
  const double T = spline.duration();
  // From 0 below it and back, then from T above it and back.
  const auto arm = ArmMotion(spline).along(*TimeMap::make({0, 1, 2}, {{{0, -1, 1}}, {{T, 1, -1}}}));
  ASSERT_TRUE(arm);
  for (const double t : {0.1, 0.5, 0.9}) {
    EXPECT_EQ(arm->at(t).q, spline.at(0).q);
    EXPECT_EQ(arm->at(t).qd, VectorXd::Zero(2));
    EXPECT_EQ(arm->at(t).qddd, VectorXd::Zero(2));
    EXPECT_EQ(arm->at(1 + t).q, spline.at(T).q);
  }
  for (const ArmMotion::Piece& piece : arm->pieces()) EXPECT_EQ(piece.spline, -1);
}

TEST(ArmMotion, PiecesCoverTheMotionWithoutAGap) {
  Rng rng(6);
  for (int i = 0; i < 300; ++i) {
    const ArmMotion arm = composed(rng);
    const auto pieces = arm.pieces();
    ASSERT_FALSE(pieces.empty());
    EXPECT_EQ(pieces.front().t0, 0);
    EXPECT_EQ(pieces.back().t1, arm.duration());
    for (std::size_t k = 0; k < pieces.size(); ++k) {
      EXPECT_EQ(pieces[k].t0, k > 0 ? pieces[k - 1].t1 : 0);
      ASSERT_LT(pieces[k].t0, pieces[k].t1);
      for (int s = 0; s < 5; ++s) {
        const double t = rng.uniform(pieces[k].t0, pieces[k].t1);
        const JointState whole = arm.at(t), piece = arm.on_piece(pieces[k], t);
        EXPECT_LT((piece.q - whole.q).norm(), 1e-9);
        EXPECT_LT((piece.qddd - whole.qddd).norm(), 1e-6 * (1 + whole.qddd.norm()));
      }
    }
  }
}

TEST(ArmMotion, DeviationIsTheExactMaximum) {
  Rng rng(7);
  for (int i = 0; i < 300; ++i) {
    const ArmMotion arm = composed(rng, i % 2 == 0);
    double t0 = rng.uniform(-0.1, 1) * arm.duration(), t1 = rng.uniform(0, 1.1) * arm.duration();
    if (t0 > t1) std::swap(t0, t1);
    if (i % 3 == 0) t1 = t0 + 1e-2 * (t1 - t0);
    VectorXd D(3), q(3), q_m(3), sampled = VectorXd::Zero(3);
    arm.deviation(t0, t1, D);
    arm.position(0.5 * (t0 + t1), q_m);
    constexpr int kSamples = 4000;
    for (int k = 0; k <= kSamples; ++k) {
      arm.position(t0 + (t1 - t0) * k / kSamples, q);
      sampled = sampled.cwiseMax((q - q_m).cwiseAbs());
    }
    EXPECT_TRUE((D.array() >= sampled.array() - 1e-12).all());
    // A smooth spline along a map that jumps nowhere on the interval is sampled closely.
    const bool one_segment = arm.map()->segment_at(t0) == arm.map()->segment_at(t1);
    if (i % 2 != 0 || !one_segment) continue;
    EXPECT_LT((D - sampled).maxCoeff(), 1e-3 * (1 + D.maxCoeff()));
  }
}

TEST(ArmMotion, KeepsTheContinuityOfTheLesser) {
  Rng rng(8);
  for (int i = 0; i < 100; ++i) {
    const PiecewiseCubic spline = smooth_motion(rng, 3);
    const double T = spline.duration(), w = rng.uniform(0.3, 0.7);
    // Slope 1 to w T, then another: position stays continuous, velocity jumps.
    const TimeMap kinked =
        *TimeMap::make({0, w * T, 2 * T}, {{{0, 1}}, {{w * T, (1 - w) / (2 - w)}}});
    const ArmMotion bent = *ArmMotion(spline).along(kinked);
    const VectorXd jump = spline.at(w * T).qd * (1 - (1 - w) / (2 - w));
    EXPECT_LT(bent.largest_jumps()[0], 1e-12);
    EXPECT_NEAR(bent.largest_jumps()[1], jump.cwiseAbs().maxCoeff(), 1e-9);
    // There and back, T t^2 (2 - t)^2: C2 across the knots of the spline.
    const ArmMotion smooth =
        *ArmMotion(spline).along(*TimeMap::make({0, 2}, {{{0, 0, 4 * T, -4 * T, T}}}));
    EXPECT_LT(smooth.largest_jumps().maxCoeff(), 1e-9);
  }
}

TEST(ArmMotion, StretchingSlowsIt) {
  Rng rng(9);
  const ArmMotion arm = composed(rng), slow = arm.stretched(2);
  EXPECT_DOUBLE_EQ(slow.duration(), 2 * arm.duration());
  const ArmMotion plain = ArmMotion(random_motion(rng, 2, 3)).stretched(2);
  EXPECT_FALSE(plain.map());
  for (int i = 0; i < 50; ++i) {
    const double t = rng.uniform(0, arm.duration());
    EXPECT_LT((slow.at(2 * t).qd * 2 - arm.at(t).qd).norm(), 1e-9 * (1 + arm.at(t).qd.norm()));
  }
}

TEST(ArmMotion, RefusesAMapThatLeavesTheSplinesTime) {
  Rng rng(10);
  const PiecewiseCubic spline = smooth_motion(rng, 2);
  const double T = spline.duration();
  const auto message = [&](const TimeMap& map) {
    const auto arm = ArmMotion(spline).along(map);
    EXPECT_FALSE(arm);
    return arm ? std::string() : arm.error().message;
  };
  EXPECT_NE(message(*TimeMap::make({0, 1}, {{{-0.5, 1}}})).find("c is -0.500000 at knot 0"),
            std::string::npos);
  EXPECT_NE(message(*TimeMap::make({0, 1}, {{{0, T + 1}}})).find("at knot 1"), std::string::npos);
  EXPECT_TRUE(ArmMotion(spline).along(*TimeMap::make({0, 1}, {{{0, T + 1e-12}}})));
}

TEST(CellMotion, RunsArmsSideBySideAndLetsShorterOnesWait) {
  Rng rng(7);
  const PiecewiseCubic left = random_motion(rng, 3, 2), right = random_motion(rng, 5, 3);
  const CellMotion cell({left, right});
  EXPECT_EQ(cell.dof(), 5);
  EXPECT_EQ(cell.duration(), std::max(left.duration(), right.duration()));
  VectorXd q(5), D(5), D_left(2), D_right(3);
  for (int i = 0; i < 200; ++i) {
    const double t = rng.uniform(-0.2, 1.2 * cell.duration()), t1 = t + rng.uniform(0, 0.3);
    const JointState state = cell.at(t);
    cell.position(t, q);
    EXPECT_EQ(q, state.q);
    EXPECT_EQ(q.head(2), left.at(t).q);
    EXPECT_EQ(q.tail(3), right.at(t).q);
    EXPECT_EQ(state.qd.head(2), left.at(t).qd);
    EXPECT_EQ(state.qdd.tail(3), right.at(t).qdd);
    EXPECT_EQ(state.qddd.head(2), left.at(t).qddd);
    cell.deviation(t, t1, D);
    left.deviation(t, t1, D_left);
    right.deviation(t, t1, D_right);
    EXPECT_EQ(D.head(2), D_left);
    EXPECT_EQ(D.tail(3), D_right);
  }
  EXPECT_THROW(CellMotion({}), ContractViolation);
}

}  // namespace
}  // namespace tandem::motion
