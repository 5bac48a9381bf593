#pragma once
/// What every TimeOptimizer must do. Instantiate with
/// INSTANTIATE_TEST_SUITE_P(Name, TimeOptimizerConformance, testing::Values(&make_...)).

#include <gtest/gtest.h>

#include <limits>
#include <numeric>
#include <thread>

#include "conformance/timing_problems.h"
#include "tandem/core/contract.h"
#include "tandem/trajectory/limit_check.h"
#include "tandem/trajectory/spline.h"
#include "tandem/trajectory/time_optimizer.h"

namespace tandem::test {

using MakeTimeOptimizer = std::unique_ptr<trajectory::TimeOptimizer> (*)();

class TimeOptimizerConformance : public testing::TestWithParam<MakeTimeOptimizer> {
 protected:
  using Limits = std::vector<robot::JointLimits>;

  /// Shape and feasibility without any tolerance, and no time left by mere scaling.
  void expect_good(const trajectory::Timing& timing, const motion::JointPath& path,
                   const Limits& limits, const trajectory::TimingOptions& options = {}) const {
    ASSERT_EQ(timing.durations.size(), path.size() + 1);
    const double sum = std::accumulate(timing.durations.begin(), timing.durations.end(), 0.0);
    EXPECT_NEAR(timing.duration, sum, 1e-12 * sum);
    const double shortest = *std::ranges::min_element(timing.durations);
    EXPECT_GE(shortest, options.shortest_interval);
    const auto spline = trajectory::fit_spline(path, timing.durations);
    const auto violations = trajectory::check_limits(spline, limits, 0);
    EXPECT_TRUE(violations.empty())
        << trajectory::describe(violations[0], std::vector<std::string>(limits.size(), "a joint"));
    const double used = trajectory::stretch_factor(trajectory::extremes(spline), limits);
    EXPECT_TRUE(used > 1 - 1e-9 || shortest < options.shortest_interval * (1 + 1e-9)) << used;
  }

  std::unique_ptr<trajectory::TimeOptimizer> optimizer_ = GetParam()();
};

TEST_P(TimeOptimizerConformance, ObeysLimitsExactlyOnRandomPaths) {
  for (int seed = 0; seed < 400; ++seed) {
    Rng rng(static_cast<std::uint64_t>(seed));
    const int count = static_cast<int>(2 + rng.index(9));
    const auto path = random_path(rng, kPathKinds[seed % 4], count, 14);
    const Limits limits = two_panda_limits(seed % 8 < 4);
    SCOPED_TRACE(seed);
    expect_good(optimizer_->optimize(path, limits), path, limits);
  }
}

TEST_P(TimeOptimizerConformance, TakesAnyNumberOfJoints) {
  for (int dof : {1, 2, 6, 28}) {
    Rng rng(static_cast<std::uint64_t>(dof));
    Limits limits(static_cast<std::size_t>(dof));
    for (auto& limit : limits) {
      limit.velocity = std::pow(10, rng.uniform(-2, 2));
      limit.acceleration = std::pow(10, rng.uniform(-2, 2));
      if (rng.index(2)) limit.jerk = std::pow(10, rng.uniform(-1, 4));
    }
    for (int count : {2, 3, 5}) {
      const auto path = random_path(rng, PathKind::kZigzag, count, dof);
      expect_good(optimizer_->optimize(path, limits), path, limits);
    }
  }
}

TEST_P(TimeOptimizerConformance, TakesLongPaths) {
  const Limits limits = two_panda_limits(true);
  for (auto kind : {PathKind::kMixed, PathKind::kSmooth}) {
    Rng rng(1);
    const auto path = random_path(rng, kind, 60, 14);
    // A long path may take a dense solver long; what it has by then must be good.
    expect_good(optimizer_->optimize(path, limits, {}, StopCondition::after(1.0)), path, limits);
  }
}

TEST_P(TimeOptimizerConformance, ResolvesNeedlesAndNearDuplicates) {
  const Limits limits = two_panda_limits(false);
  Rng rng(2);
  for (double gap : {1e-3, 1e-6, 1e-9, 1e-12}) {
    auto path = random_path(rng, PathKind::kZigzag, 4, 14);
    Eigen::VectorXd near = path[1];
    near[3] += gap;
    path.insert(path.begin() + 2, near);
    Eigen::VectorXd back = path.front();
    back[0] -= gap;
    path.push_back(path.back() + (path.front() - back));
    SCOPED_TRACE(gap);
    expect_good(optimizer_->optimize(path, limits), path, limits);
  }
}

TEST_P(TimeOptimizerConformance, KeepsTheShortestIntervalWhereLimitsAllowLess) {
  const Limits limits = two_panda_limits(false);
  const motion::JointPath path{Eigen::VectorXd::Zero(14), Eigen::VectorXd::Constant(14, 1e-10)};
  const trajectory::TimingOptions options{.shortest_interval = 0.01};
  const auto timing = optimizer_->optimize(path, limits, options);
  expect_good(timing, path, limits, options);
  EXPECT_NEAR(timing.duration, 0.03, 1e-3);
}

TEST_P(TimeOptimizerConformance, LeavesPositionLimitsAlone) {
  Rng rng(3);
  const auto path = random_path(rng, PathKind::kZigzag, 6, 14);
  Limits narrow = two_panda_limits(false);
  for (auto& limit : narrow) limit.lower = limit.upper = 0;
  EXPECT_EQ(optimizer_->optimize(path, narrow).durations,
            optimizer_->optimize(path, two_panda_limits(false)).durations);
}

TEST_P(TimeOptimizerConformance, ReturnsAFeasibleTimingWhenStoppedAtOnce) {
  const Limits limits = two_panda_limits(true);
  std::stop_source source;
  source.request_stop();
  for (int count : {2, 3, 10}) {
    Rng rng(4);
    const auto path = random_path(rng, PathKind::kZigzag, count, 14);
    for (const StopCondition& stop :
         {StopCondition::after(0), StopCondition::after(100, source.get_token())}) {
      const auto timing = optimizer_->optimize(path, limits, {}, stop);
      expect_good(timing, path, limits);
      EXPECT_LE(timing.iterations, 1);
    }
  }
}

TEST_P(TimeOptimizerConformance, RepeatsItselfOnSeveralThreads) {
  const Limits limits = two_panda_limits(true);
  Rng rng(5);
  const auto path = random_path(rng, PathKind::kZigzag, 7, 14);
  const auto expected = optimizer_->optimize(path, limits);
  std::vector<trajectory::Timing> timings(4);
  {
    std::vector<std::jthread> threads;
    for (auto& timing : timings) {
      threads.emplace_back([&] { timing = optimizer_->optimize(path, limits); });
    }
  }
  for (const auto& timing : timings) EXPECT_EQ(timing.durations, expected.durations);
}

TEST_P(TimeOptimizerConformance, RefusesBrokenInput) {
  Rng rng(6);
  const Limits limits = two_panda_limits(false);
  const auto path = random_path(rng, PathKind::kZigzag, 4, 14);
  const auto refuses = [&](const motion::JointPath& p, const Limits& l,
                           const trajectory::TimingOptions& o = {}) {
    EXPECT_THROW(optimizer_->optimize(p, l, o), ContractViolation);
  };
  refuses({}, limits);
  refuses({path[0]}, limits);
  refuses({path[0], path[0], path[1]}, limits);
  refuses({path[0], path[1], path[1]}, limits);
  refuses({path[0], path[1].head(13)}, limits);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  motion::JointPath broken = path;
  broken[2][5] = std::nan("");
  refuses(broken, limits);
  refuses(path, Limits(limits.begin(), limits.end() - 1));
  for (double bad : {0.0, -1.0, kInfinity, static_cast<double>(NAN)}) {
    Limits l = limits;
    l[3].velocity = bad;
    refuses(path, l);
    l = limits;
    l[13].acceleration = bad;
    refuses(path, l);
    refuses(path, limits, {.shortest_interval = bad});
  }
  Limits l = limits;
  l[0].jerk = 0;
  refuses(path, l);
}

}  // namespace tandem::test
