#include "tandem/trajectory/timing_problem.h"

#include <gtest/gtest.h>

#include "conformance/timing_problems.h"
#include "tandem/trajectory/spline.h"

namespace tandem::trajectory {
namespace {

using Eigen::Index, Eigen::VectorXd;
using test::kPathKinds, test::random_path, test::two_panda_limits;

VectorXd random_intervals(Rng& rng, Index count) {
  return VectorXd::NullaryExpr(count, [&] { return std::pow(10, rng.uniform(-1, 0.5)); });
}

TEST(TimingProblem, JacobianMatchesDifferences) {
  for (int seed = 0; seed < 120; ++seed) {
    Rng rng(static_cast<std::uint64_t>(seed));
    const int count = static_cast<int>(2 + rng.index(8));
    const auto path = random_path(rng, kPathKinds[seed % 4], count, 14);
    const auto limits = two_panda_limits(seed % 2 == 0);
    TimingProblem problem(path, limits, {});
    const VectorXd h = random_intervals(rng, problem.intervals());
    ASSERT_TRUE(problem.evaluate(h));
    problem.differentiate();
    const Eigen::MatrixXd J = problem.jacobian();
    for (Index l = 0; l < h.size(); ++l) {
      constexpr double kStep = 1e-6;
      VectorXd moved = h;
      moved[l] = h[l] * std::exp(kStep);
      ASSERT_TRUE(problem.evaluate(moved));
      VectorXd difference = problem.ratios();
      moved[l] = h[l] * std::exp(-kStep);
      ASSERT_TRUE(problem.evaluate(moved));
      difference = (difference - problem.ratios()) / (2 * kStep);
      EXPECT_LT((difference - J.col(l)).norm(), 1e-6 * (1 + J.col(l).norm())) << seed << ' ' << l;
    }
  }
}

TEST(TimingProblem, RatiosHoldTheExactExtremes) {
  for (int seed = 0; seed < 200; ++seed) {
    Rng rng(static_cast<std::uint64_t>(seed));
    const int count = static_cast<int>(2 + rng.index(8));
    const auto path = random_path(rng, kPathKinds[seed % 4], count, 14);
    // One kind of limit at a time, the others far away.
    auto limits = two_panda_limits(true);
    for (auto& limit : limits) {
      if (seed % 3 != 0) limit.velocity *= 1e6;
      if (seed % 3 != 1) limit.acceleration *= 1e6;
      if (seed % 3 != 2) limit.jerk *= 1e6;
    }
    TimingProblem problem(path, limits, {.shortest_interval = 1e-9});
    const VectorXd h = random_intervals(rng, problem.intervals());
    ASSERT_TRUE(problem.evaluate(h));
    const auto spline = fit_spline(path, std::vector<double>(h.begin(), h.end()));
    const double exact = stretch_factor(extremes(spline), limits);
    EXPECT_NEAR(problem.scale(), exact, 1e-9 * exact) << seed;
  }
}

TEST(TimingProblem, RatiosAreContinuouslyDifferentiable) {
  // Along a line through many sign changes of accelerations, slopes move by what curvature allows;
  // a constraint that appeared at a sign change would make them jump.
  Rng rng(1);
  const auto path = random_path(rng, test::PathKind::kZigzag, 6, 14);
  const auto limits = two_panda_limits(true);
  TimingProblem problem(path, limits, {});
  const VectorXd from = random_intervals(rng, 7), to = random_intervals(rng, 7);
  const auto largest_slope_change = [&](int steps) {
    Eigen::MatrixXd last;
    double largest = 0;
    for (int i = 0; i <= steps; ++i) {
      const double s = static_cast<double>(i) / steps;
      EXPECT_TRUE(problem.evaluate(from + s * (to - from)));
      problem.differentiate();
      if (i > 0) {
        largest = std::max(largest, (problem.jacobian() - last).cwiseAbs().maxCoeff() /
                                        problem.jacobian().cwiseAbs().maxCoeff());
      }
      last = problem.jacobian();
    }
    return largest;
  };
  EXPECT_LT(largest_slope_change(20000), 0.02 * largest_slope_change(200));
}

TEST(TimingProblem, StretchingStartsWithinTheLimitsAndBelowUniformScaling) {
  int shorter = 0;
  constexpr int kProblems = 100;
  for (int seed = 0; seed < kProblems; ++seed) {
    Rng rng(static_cast<std::uint64_t>(seed));
    const auto path =
        random_path(rng, kPathKinds[seed % 4], static_cast<int>(3 + rng.index(8)), 14);
    const auto limits = two_panda_limits(true);
    TimingProblem problem(path, limits, {});
    const VectorXd start = problem.stretched_intervals();
    ASSERT_TRUE(problem.evaluate(start));
    EXPECT_NEAR(problem.scale(), 1, 1e-9);
    shorter += start.sum() < problem.finish(problem.initial_intervals(), 0).duration;
  }
  EXPECT_GE(shorter, 95);
}

TEST(TimingProblem, FinishesExactlyWhereKnotsAreRounded) {
  // Short intervals late in a motion of an hour: knots carry them to ten digits only.
  robot::JointLimits limit;
  limit.velocity = 1e-3;
  limit.acceleration = 1e-2;
  for (int seed = 0; seed < 50; ++seed) {
    Rng rng(static_cast<std::uint64_t>(seed));
    motion::JointPath path{VectorXd::Zero(1), VectorXd::Constant(1, 4)};
    for (int i = 0; i < 5; ++i) {
      path.push_back(path.back() + VectorXd::Constant(1, rng.uniform(-1e-4, 1e-4)));
    }
    const std::vector<robot::JointLimits> limits{limit};
    const TimingProblem problem(path, limits, {});
    const Timing timing = problem.finish(problem.initial_intervals(), 0);
    EXPECT_GT(timing.duration, 3600);
    EXPECT_TRUE(check_limits(fit_spline(path, timing.durations), limits, 0).empty()) << seed;
  }
}

}  // namespace
}  // namespace tandem::trajectory
