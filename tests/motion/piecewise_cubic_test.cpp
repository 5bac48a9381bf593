#include "tandem/motion/piecewise_cubic.h"

#include <gtest/gtest.h>

#include <cmath>

#include "motion/random_motions.h"
#include "tandem/core/contract.h"

namespace tandem::motion {
namespace {

using Eigen::VectorXd;
using Coefficients = PiecewiseCubic::Coefficients;

/// 1 + 2s + 3s^2 + 4s^3 on [0, 1], then 10 + s on [1, 3].
PiecewiseCubic known_motion() {
  Coefficients a(1, 4), b(1, 4);
  a << 1, 2, 3, 4;
  b << 10, 1, 0, 0;
  return *PiecewiseCubic::make({0, 1, 3}, {a, b});
}

TEST(PiecewiseCubic, EvaluatesItsPolynomials) {
  const PiecewiseCubic motion = known_motion();
  EXPECT_EQ(motion.dof(), 1);
  EXPECT_EQ(motion.duration(), 3);
  const JointState s = motion.at(0.5);
  EXPECT_DOUBLE_EQ(s.q[0], 3.25);
  EXPECT_DOUBLE_EQ(s.qd[0], 8);
  EXPECT_DOUBLE_EQ(s.qdd[0], 18);
  EXPECT_DOUBLE_EQ(s.qddd[0], 24);
  VectorXd q(1);
  motion.position(0.5, q);
  EXPECT_EQ(q[0], s.q[0]);
  // A knot belongs to the segment after it, the last to the one before.
  EXPECT_EQ(motion.at(1).q[0], 10);
  EXPECT_EQ(motion.at(1).qddd[0], 0);
  EXPECT_EQ(motion.at(3).q[0], 12);
  EXPECT_EQ(motion.at(3).qd[0], 1);
}

TEST(PiecewiseCubic, StandsStillOutsideItsTime) {
  const PiecewiseCubic motion = known_motion();
  VectorXd q(1);
  motion.position(-1, q);
  EXPECT_EQ(q[0], 1);
  motion.position(99, q);
  EXPECT_EQ(q[0], 12);
  for (double t : {-1e-9, 3 + 1e-9}) {
    EXPECT_EQ(motion.at(t).qd[0], 0);
    EXPECT_EQ(motion.at(t).qdd[0], 0);
    EXPECT_EQ(motion.at(t).qddd[0], 0);
  }
}

TEST(PiecewiseCubic, FindsSegments) {
  const PiecewiseCubic motion = known_motion();
  const std::vector<std::pair<double, int>> expected{{-1, 0}, {0, 0}, {0.999, 0}, {1, 1},
                                                     {2, 1},  {3, 1}, {4, 1}};
  for (const auto& [t, k] : expected) EXPECT_EQ(motion.segment_at(t), k) << t;
}

TEST(PiecewiseCubic, RefusesMalformedInputAndSaysWhere) {
  const Coefficients one = Coefficients::Zero(1, 4), two = Coefficients::Zero(2, 4);
  Coefficients infinite = one;
  infinite(0, 2) = std::numeric_limits<double>::infinity();
  const auto message = [](std::vector<double> knots, std::vector<Coefficients> segments) {
    const auto motion = PiecewiseCubic::make(std::move(knots), std::move(segments));
    if (motion) return std::string("accepted");
    EXPECT_EQ(motion.error().code, ErrorCode::kInvalidInput);
    return motion.error().message;
  };
  const auto contains = [](const std::string& text, const char* part) {
    return text.find(part) != std::string::npos;
  };
  EXPECT_TRUE(contains(message({}, {}), "at least 2 knots"));
  EXPECT_TRUE(contains(message({0}, {}), "at least 2 knots"));
  EXPECT_TRUE(contains(message({0, 1, 2}, {one}), "3 knots need 2 segments"));
  EXPECT_TRUE(contains(message({0.5, 1}, {one}), "knot 0"));
  EXPECT_TRUE(contains(message({0, 1, 1}, {one, one}), "knot 2"));
  EXPECT_TRUE(contains(message({0, 2, 1}, {one, one}), "knot 2"));
  EXPECT_TRUE(contains(message({0, std::nan("")}, {one}), "knot 1"));
  EXPECT_TRUE(contains(message({0, 1, 2}, {one, two}), "segment 1 has 2 joints"));
  EXPECT_TRUE(contains(message({0, 1, 2}, {one, infinite}), "segment 1"));
  EXPECT_TRUE(contains(message({0, 1}, {Coefficients(0, 4)}), "no joints"));
}

TEST(StationaryPoints, FindEveryRootOfTheSlope) {
  Rng rng(1);
  for (int i = 0; i < 2000; ++i) {
    // From roots that are near, far apart or equal, at any scale.
    const double a = rng.uniform(-2, 2);
    const double b = i % 3 == 0 ? a : a * std::pow(10, rng.uniform(-8, 8));
    const double c3 = std::pow(10, rng.uniform(-6, 6)) * (i % 2 ? 1 : -1);
    const double c2 = -1.5 * c3 * (a + b), c1 = 3 * c3 * a * b;
    const StationaryPoints points = stationary_points(c1, c2, c3);
    if (i % 3 == 0) continue;  // A double root may round to none.
    ASSERT_EQ(points.count, 2);
    for (double root : {a, b}) {
      const double error =
          std::min(std::abs(points.s[0] - root), std::abs(points.s[1] - root)) / std::abs(root);
      const double separation = std::abs(a - b) / std::max(std::abs(a), std::abs(b));
      EXPECT_LT(error * separation, 1e-14) << a << ' ' << b;
    }
  }
  EXPECT_EQ(stationary_points(0, 0, 0).count, 0);
  EXPECT_EQ(stationary_points(1, 0, 0).count, 0);
  EXPECT_EQ(stationary_points(1, 0, 1).count, 0);
  ASSERT_EQ(stationary_points(-3, 1.5, 0).count, 1);
  EXPECT_DOUBLE_EQ(stationary_points(-3, 1.5, 0).s[0], 1);
}

TEST(PiecewiseCubic, DeviationIsTheExactMaximum) {
  Rng rng(2);
  for (int i = 0; i < 300; ++i) {
    const PiecewiseCubic motion = random_motion(rng, static_cast<int>(1 + rng.index(5)), 3);
    const double T = motion.duration();
    double t0 = rng.uniform(-0.1, 1) * T, t1 = rng.uniform(0, 1.2) * T;
    if (t0 > t1) std::swap(t0, t1);
    if (i % 4 == 0) t1 = t0 + 1e-3 * (t1 - t0);
    VectorXd D(3), q(3), q_m(3);
    motion.deviation(t0, t1, D);
    motion.position(0.5 * (t0 + t1), q_m);
    VectorXd sampled = VectorXd::Zero(3);
    constexpr int kSamples = 2000;
    for (int k = 0; k <= kSamples; ++k) {
      motion.position(t0 + (t1 - t0) * k / kSamples, q);
      sampled = sampled.cwiseMax((q - q_m).cwiseAbs());
    }
    // The motion jumps at its knots; both sides count, and samples see only one of them.
    for (double knot : motion.knots()) {
      if (knot <= t0 || knot > t1) continue;
      motion.position(std::nextafter(knot, -1), q);
      sampled = sampled.cwiseMax((q - q_m).cwiseAbs());
      motion.position(knot, q);
      sampled = sampled.cwiseMax((q - q_m).cwiseAbs());
    }
    const double step = (t1 - t0) / kSamples;
    for (int j = 0; j < 3; ++j) {
      EXPECT_GE(D[j], sampled[j] - 1e-12);
      // Between samples a smooth extreme rises by at most |qdd| step^2 / 8.
      EXPECT_LE(D[j], sampled[j] + 50 * step * step + 1e-12);
    }
  }
}

TEST(PiecewiseCubic, DeviationSeesPeaksInEverySegment) {
  // Still, then a bump of height 1 in the last segment; the middle of the whole lies on the floor.
  Coefficients still = Coefficients::Zero(1, 4), bump = still;
  bump << 0, 4, -4, 0;
  VectorXd D(1);
  PiecewiseCubic::make({0, 1, 2, 3}, {still, still, bump})->deviation(0, 3, D);
  EXPECT_DOUBLE_EQ(D[0], 1);
  PiecewiseCubic::make({0, 1, 2, 3}, {bump, still, still})->deviation(0, 3, D);
  EXPECT_DOUBLE_EQ(D[0], 1);
}

TEST(PiecewiseCubic, DeviationOfAnInstantIsZero) {
  Rng rng(3);
  const PiecewiseCubic motion = random_motion(rng, 3, 2);
  VectorXd D(2);
  motion.deviation(0.3, 0.3, D);
  EXPECT_EQ(D, VectorXd::Zero(2));
  motion.deviation(motion.duration() + 1, motion.duration() + 2, D);
  EXPECT_EQ(D, VectorXd::Zero(2));
}

TEST(PiecewiseCubic, JointsAreTheSameCurves) {
  Rng rng(4);
  const PiecewiseCubic motion = random_motion(rng, 4, 5), part = motion.joints(1, 3);
  EXPECT_EQ(part.dof(), 3);
  EXPECT_EQ(part.knots(), motion.knots());
  for (int i = 0; i < 100; ++i) {
    const double t = rng.uniform(0, motion.duration());
    EXPECT_EQ(part.at(t).q, motion.at(t).q.segment(1, 3));
    EXPECT_EQ(part.at(t).qddd, motion.at(t).qddd.segment(1, 3));
  }
  EXPECT_THROW(motion.joints(3, 3), ContractViolation);
  EXPECT_THROW(motion.joints(-1, 3), ContractViolation);
  EXPECT_THROW(motion.joints(0, 0), ContractViolation);
}

TEST(PiecewiseCubic, ThenRunsOneAfterTheOther) {
  Rng rng(5);
  const PiecewiseCubic a = random_motion(rng, 3, 2), b = random_motion(rng, 4, 2), both = a.then(b);
  EXPECT_DOUBLE_EQ(both.duration(), a.duration() + b.duration());
  EXPECT_EQ(both.knots().size(), a.knots().size() + b.knots().size() - 1);
  for (int i = 0; i < 100; ++i) {
    const double t = rng.uniform(0, a.duration() * 0.999), s = rng.uniform(0, b.duration());
    EXPECT_EQ(both.at(t).q, a.at(t).q);
    EXPECT_LT((both.at(a.duration() + s).qd - b.at(s).qd).norm(), 1e-9);
  }
  EXPECT_EQ(both.segments().back(), b.segments().back());
  EXPECT_THROW(a.then(random_motion(rng, 2, 3)), ContractViolation);
}

TEST(PiecewiseCubic, StretchingSlowsTheSameCurve) {
  Rng rng(6);
  for (double factor : {0.25, 1.0, 3.7}) {
    const PiecewiseCubic motion = random_motion(rng, 4, 2), slow = motion.stretched(factor);
    EXPECT_DOUBLE_EQ(slow.duration(), factor * motion.duration());
    for (int i = 0; i < 100; ++i) {
      const double t = rng.uniform(0, motion.duration());
      const JointState fast = motion.at(t), stretched = slow.at(factor * t);
      EXPECT_LT((stretched.q - fast.q).norm(), 1e-12);
      EXPECT_LT((stretched.qd * factor - fast.qd).norm(), 1e-12);
      EXPECT_LT((stretched.qdd * factor * factor - fast.qdd).norm(), 1e-12);
      EXPECT_LT((stretched.qddd * std::pow(factor, 3) - fast.qddd).norm(), 1e-12);
    }
  }
  EXPECT_THROW(known_motion().stretched(0), ContractViolation);
  EXPECT_THROW(known_motion().stretched(std::nan("")), ContractViolation);
}

TEST(PiecewiseCubic, MeasuresJumps) {
  // Ends of the first segment: 10, 20, 30; starts of the second: 10, 1, 0.
  EXPECT_TRUE(known_motion().largest_jumps().isApprox(Eigen::Vector3d(0, 19, 30)));
  Coefficients one = Coefficients::Ones(2, 4);
  EXPECT_EQ(PiecewiseCubic::make({0, 1}, {one})->largest_jumps(), Eigen::Vector3d::Zero());
}

}  // namespace
}  // namespace tandem::motion
