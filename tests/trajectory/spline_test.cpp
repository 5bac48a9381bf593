#include "tandem/trajectory/spline.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "conformance/timing_problems.h"
#include "tandem/core/contract.h"
#include "tandem/trajectory/spline_system.h"

namespace tandem::trajectory {
namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;
using test::PathKind, test::random_path;

/// Coefficients of all segments, from one dense system: every waypoint, three continuities at every
/// inner knot, rest at both ends. Knows nothing of accelerations or virtual positions.
/// @return 4 (N + 1) x joints; rows 4k .. 4k + 3 belong to segment k.
MatrixXd dense_spline(const motion::JointPath& waypoints, const std::vector<double>& h) {
  const auto count = static_cast<int>(waypoints.size());
  const auto m = static_cast<Index>(h.size());
  MatrixXd A = MatrixXd::Zero(4 * m, 4 * m), B = MatrixXd::Zero(4 * m, waypoints[0].size());
  Index row = 0;
  // The order-th derivative of segment k at s, added with a sign.
  const auto add = [&](Index k, double s, int order, double sign) {
    for (int power = order; power < 4; ++power) {
      double factor = sign * std::pow(s, power - order);
      for (int i = 0; i < order; ++i) factor *= power - i;
      A(row, 4 * k + power) += factor;
    }
  };
  for (int i = 0; i < count; ++i, ++row) {
    const Index knot = knot_of_waypoint(i, count);
    add(std::min(knot, m - 1), knot == m ? h.back() : 0, 0, 1);
    B.row(row) = waypoints[static_cast<std::size_t>(i)];
  }
  for (Index k = 0; k + 1 < m; ++k) {
    for (int order = 0; order < 3; ++order, ++row) {
      add(k, h[static_cast<std::size_t>(k)], order, 1);
      add(k + 1, 0, order, -1);
    }
  }
  for (int order : {1, 2}) {
    add(0, 0, order, 1);
    ++row;
    add(m - 1, h.back(), order, 1);
    ++row;
  }
  EXPECT_EQ(row, 4 * m);
  return A.fullPivLu().solve(B);
}

std::vector<double> random_durations(Rng& rng, std::size_t count, double decades) {
  std::vector<double> h(count);
  for (double& x : h) x = std::pow(10, rng.uniform(-decades, 0));
  return h;
}

TEST(FitSpline, EqualsADenseSolveOfTheWholeSystem) {
  for (int count = 2; count <= 12; ++count) {
    for (int seed = 0; seed < 30; ++seed) {
      Rng rng(static_cast<std::uint64_t>(100 * count + seed));
      const auto path = random_path(rng, PathKind::kZigzag, count, 3);
      const auto h = random_durations(rng, path.size() + 1, seed % 3);
      const auto spline = fit_spline(path, h);
      const MatrixXd expected = dense_spline(path, h);
      for (std::size_t k = 0; k < h.size(); ++k) {
        const MatrixXd c = expected.middleRows(4 * static_cast<Index>(k), 4).transpose();
        // What the coefficients do over the segment, so that all weigh alike.
        const Eigen::RowVector4d reach(1, h[k], h[k] * h[k], std::pow(h[k], 3));
        const MatrixXd error = (spline.segments()[k] - c) * reach.asDiagonal();
        EXPECT_LT(error.cwiseAbs().maxCoeff(), 1e-9) << count << ' ' << seed << ' ' << k;
      }
    }
  }
}

TEST(FitSpline, PassesEveryWaypointAndRestsAtBothEnds) {
  for (int seed = 0; seed < 200; ++seed) {
    Rng rng(static_cast<std::uint64_t>(seed));
    const int count = static_cast<int>(2 + rng.index(60));
    const auto path = random_path(rng, test::kPathKinds[seed % 4], count, 7);
    const auto h = random_durations(rng, path.size() + 1, 2);
    const auto spline = fit_spline(path, h);
    ASSERT_EQ(spline.knots().size(), path.size() + 2);
    for (int i = 0; i < count; ++i) {
      const double t = spline.knots()[static_cast<std::size_t>(knot_of_waypoint(i, count))];
      EXPECT_LT((spline.at(t).q - path[static_cast<std::size_t>(i)]).norm(), 1e-12);
    }
    const auto start = spline.at(0), end = spline.at(spline.duration());
    const double v = 1 / h.back(), a = v / h.back();  // What rounding is measured against.
    EXPECT_EQ(start.qd.norm(), 0);
    EXPECT_EQ(start.qdd.norm(), 0);
    EXPECT_LT(end.qd.norm(), 1e-10 * v);
    EXPECT_LT(end.qdd.norm(), 1e-10 * a);
  }
}

TEST(FitSpline, IsTwiceContinuouslyDifferentiable) {
  for (int seed = 0; seed < 200; ++seed) {
    Rng rng(static_cast<std::uint64_t>(seed));
    const int count = static_cast<int>(2 + rng.index(30));
    const auto path = random_path(rng, PathKind::kZigzag, count, 7);
    const auto h = random_durations(rng, path.size() + 1, 1);
    const Eigen::Vector3d jumps = fit_spline(path, h).largest_jumps();
    // Velocities reach about 1e2 and accelerations 1e4 at these durations.
    EXPECT_LT(jumps[0], 1e-12);
    EXPECT_LT(jumps[1], 1e-10);
    EXPECT_LT(jumps[2], 1e-8);
  }
}

TEST(FitSpline, ScalesWithTime) {
  Rng rng(1);
  const auto path = random_path(rng, PathKind::kZigzag, 6, 7);
  auto h = random_durations(rng, 7, 1);
  const auto fast = fit_spline(path, h).stretched(3);
  for (double& x : h) x *= 3;
  const auto slow = fit_spline(path, h);
  for (int i = 0; i < 100; ++i) {
    const double t = rng.uniform(0, slow.duration());
    EXPECT_LT((slow.at(t).q - fast.at(t).q).norm(), 1e-10);
    EXPECT_LT((slow.at(t).qdd - fast.at(t).qdd).norm(), 1e-9 * (1 + fast.at(t).qdd.norm()));
  }
}

TEST(FitSpline, SurvivesVeryUnevenDurations) {
  for (int seed = 0; seed < 200; ++seed) {
    Rng rng(static_cast<std::uint64_t>(seed));
    const int count = static_cast<int>(2 + rng.index(10));
    const auto path = random_path(rng, PathKind::kZigzag, count, 2);
    const auto h = random_durations(rng, path.size() + 1, 6);
    const auto spline = fit_spline(path, h);
    EXPECT_LT(spline.largest_jumps()[0], 1e-3);
  }
}

TEST(FitSpline, RefusesBrokenInput) {
  const motion::JointPath path{VectorXd::Zero(2), VectorXd::Ones(2)};
  const auto refuses = [](const motion::JointPath& waypoints, const std::vector<double>& h) {
    EXPECT_THROW(fit_spline(waypoints, h), ContractViolation);
  };
  refuses({}, {});
  refuses({path[0]}, {1, 1});
  refuses(path, {1, 1});
  refuses(path, {1, 1, 1, 1});
  refuses(path, {1, 0, 1});
  refuses(path, {1, -1, 1});
  refuses(path, {1, std::nan(""), 1});
  refuses(path, {1, std::numeric_limits<double>::infinity(), 1});
  refuses({path[0], VectorXd::Zero(3)}, {1, 1, 1});
}

TEST(KnotOfWaypoint, SkipsTheFreeKnots) {
  EXPECT_EQ(knot_of_waypoint(0, 2), 0);
  EXPECT_EQ(knot_of_waypoint(1, 2), 3);
  EXPECT_EQ(knot_of_waypoint(0, 5), 0);
  EXPECT_EQ(knot_of_waypoint(1, 5), 2);
  EXPECT_EQ(knot_of_waypoint(3, 5), 4);
  EXPECT_EQ(knot_of_waypoint(4, 5), 6);
}

TEST(SplineSystem, GradientsMatchDifferences) {
  for (int seed = 0; seed < 120; ++seed) {
    Rng rng(static_cast<std::uint64_t>(seed));
    const int count = static_cast<int>(2 + rng.index(7));
    SplineSystem system(stacked(random_path(rng, PathKind::kZigzag, count, 3)));
    const auto durations = random_durations(rng, static_cast<std::size_t>(count) + 1, seed % 3);
    const VectorXd h = VectorXd::Map(durations.data(), count + 1);
    ASSERT_TRUE(system.solve(h));
    system.differentiate();
    const math::RowMatrix da = system.acceleration_gradients(), dv = system.velocity_gradients();
    for (Index l = 0; l < h.size(); ++l) {
      const double step = 1e-5 * h[l];
      VectorXd moved = h;
      moved[l] = h[l] + step;
      ASSERT_TRUE(system.solve(moved));
      math::RowMatrix a = system.accelerations(), v = system.velocities();
      moved[l] = h[l] - step;
      ASSERT_TRUE(system.solve(moved));
      a = (a - system.accelerations()) / (2 * step);
      v = (v - system.velocities()) / (2 * step);
      EXPECT_LT((a - da.middleCols(3 * l, 3)).norm(), 1e-6 * (1 + da.norm())) << seed << ' ' << l;
      EXPECT_LT((v - dv.middleCols(3 * l, 3)).norm(), 1e-6 * (1 + dv.norm())) << seed << ' ' << l;
    }
  }
}

}  // namespace
}  // namespace tandem::trajectory
