#include "tandem/trajectory/time_optimizer.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "conformance/time_optimizer_conformance.h"
#include "tandem/trajectory/nlopt/slsqp_time_optimizer.h"

namespace tandem::test {

INSTANTIATE_TEST_SUITE_P(UniformScaling, TimeOptimizerConformance,
                         testing::Values(&trajectory::make_uniform_scaling));
INSTANTIATE_TEST_SUITE_P(Barrier, TimeOptimizerConformance,
                         testing::Values(&trajectory::make_barrier_optimizer));
INSTANTIATE_TEST_SUITE_P(Slsqp, TimeOptimizerConformance,
                         testing::Values(&trajectory::make_slsqp_time_optimizer));

}  // namespace tandem::test

namespace tandem::trajectory {
namespace {

using Eigen::VectorXd;

TEST(BarrierOptimizer, IsAsShortAsSlsqpAndShorterThanUniformScaling) {
  const auto barrier = make_barrier_optimizer(), slsqp = make_slsqp_time_optimizer(),
             uniform = make_uniform_scaling();
  constexpr int kProblems = 200;
  int worse = 0;
  std::vector<double> against_slsqp, against_uniform;
  for (int seed = 0; seed < kProblems; ++seed) {
    Rng rng(static_cast<std::uint64_t>(seed));
    const int count = static_cast<int>(3 + rng.index(8));
    const auto path = test::random_path(rng, test::kPathKinds[seed % 4], count, 14);
    const auto limits = test::two_panda_limits(seed % 8 < 4);
    const double duration = barrier->optimize(path, limits).duration;
    against_slsqp.push_back(slsqp->optimize(path, limits).duration / duration);
    against_uniform.push_back(uniform->optimize(path, limits).duration / duration);
    worse += against_slsqp.back() < 1 / 1.02;
    EXPECT_GE(against_uniform.back(), 1) << seed;
  }
  EXPECT_LE(worse, kProblems / 20);
  std::ranges::sort(against_slsqp);
  std::ranges::sort(against_uniform);
  EXPECT_GT(against_slsqp[kProblems / 2], 0.999);
  EXPECT_GT(against_uniform[kProblems / 2], 1.15);
  std::printf("slsqp / barrier: least %.4f median %.4f most %.4f; uniform / barrier: median %.3f\n",
              against_slsqp.front(), against_slsqp[kProblems / 2], against_slsqp.back(),
              against_uniform[kProblems / 2]);
}

TEST(BarrierOptimizer, FindsTheKnownOptimumOfOneEdge) {
  // One joint, way D, acceleration A alone: by symmetry T (T - h_1) = 6 D / A, so the outer
  // intervals shrink to the shortest allowed.
  constexpr double kShortest = 0.01;
  for (double D : {0.1, 1.0, 3.0}) {
    for (double A : {0.5, 5.0}) {
      robot::JointLimits limit;
      limit.velocity = 100;
      limit.acceleration = A;
      const auto timing = make_barrier_optimizer()->optimize(
          {VectorXd::Zero(1), VectorXd::Constant(1, D)}, {limit}, {.shortest_interval = kShortest});
      const double best = 0.5 * kShortest + std::sqrt(0.25 * kShortest * kShortest + 6 * D / A);
      EXPECT_GE(timing.duration, best * (1 - 1e-12));
      EXPECT_LE(timing.duration, best * (1 + 1e-4));
    }
  }
}

TEST(BarrierOptimizer, IsNearlyBlindToTheDirectionOfTravel) {
  const auto limits = test::two_panda_limits(true);
  for (int seed = 0; seed < 20; ++seed) {
    Rng rng(static_cast<std::uint64_t>(seed));
    auto path = test::random_path(rng, test::PathKind::kZigzag, 6, 14);
    const double there = make_barrier_optimizer()->optimize(path, limits).duration;
    std::ranges::reverse(path);
    EXPECT_NEAR(make_barrier_optimizer()->optimize(path, limits).duration / there, 1, 0.01);
  }
}

}  // namespace
}  // namespace tandem::trajectory
