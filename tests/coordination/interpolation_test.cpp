#include "tandem/coordination/interpolation.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "tandem/core/contract.h"
#include "tandem/core/rng.h"

namespace tandem::coordination {
namespace {

using Eigen::VectorXd;
using motion::TimeMap;

constexpr Interpolation kAll[] = {Interpolation::kLinear, Interpolation::kCubic,
                                  Interpolation::kQuintic};

Schedule random_schedule(Rng& rng, std::size_t count, int arms) {
  Schedule schedule;
  for (std::size_t k = 0; k < count; ++k) {
    schedule.places.push_back(VectorXd::NullaryExpr(arms, [&] { return rng.uniform(0, 3); }));
    schedule.times.push_back(k == 0 ? 0 : schedule.times.back() + rng.uniform(0.05, 1));
  }
  return schedule;
}

/// Jump of the n-th derivative of c over knot k, n up to 5.
double jump(const TimeMap& map, std::size_t k, int n) {
  const auto derivative = [&](std::size_t segment, double t) {
    const double s = t - map.knots()[segment];
    double value = 0;
    for (int i = n; i <= TimeMap::kDegree; ++i) {
      double factor = 1;
      for (int f = 0; f < n; ++f) factor *= i - f;
      value += factor * map.segments()[segment][static_cast<std::size_t>(i)] * std::pow(s, i - n);
    }
    return value;
  };
  return derivative(k, map.knots()[k]) - derivative(k - 1, map.knots()[k]);
}

TEST(Interpolate, PassesThroughAllPlacesAsSmoothlyAsItSays) {
  Rng rng(1);
  for (int i = 0; i < 200; ++i) {
    const Schedule schedule = random_schedule(rng, 2 + rng.index(9), 2);
    for (const Interpolation kind : kAll) {
      const auto maps = interpolate(schedule, kind);
      ASSERT_EQ(maps.size(), 2u);
      for (std::size_t arm = 0; arm < 2; ++arm) {
        const TimeMap& map = maps[arm];
        ASSERT_EQ(map.knots(), schedule.times);
        for (std::size_t k = 0; k < schedule.times.size(); ++k) {
          const double place = schedule.places[k][static_cast<Eigen::Index>(arm)];
          EXPECT_NEAR(map(schedule.times[k]), place, 1e-9);
        }
        const int smooth = kind == Interpolation::kLinear  ? 0
                           : kind == Interpolation::kCubic ? 2
                                                           : 4;
        for (std::size_t k = 1; k + 1 < schedule.times.size(); ++k) {
          for (int n = 0; n <= smooth; ++n) {
            // Intervals of 0.05 s make the n-th derivatives of a second's places 20^n large.
            EXPECT_NEAR(jump(map, k, n), 0, 1e-9 * std::pow(20, n)) << "derivative " << n;
          }
        }
        const auto begin = map.at(0), end = map.at(map.duration());
        if (kind == Interpolation::kLinear) continue;
        EXPECT_NEAR(begin[2], 0, 1e-9);
        EXPECT_NEAR(end[2], 0, 1e-7);
        if (kind == Interpolation::kCubic) continue;
        EXPECT_NEAR(begin[1], 0, 1e-9);
        EXPECT_NEAR(end[1], 0, 1e-7);
      }
    }
  }
}

/// The natural spline as a dense system for all coefficients.
TEST(Interpolate, CubicIsTheNaturalSplineOfADenseSolve) {
  Rng rng(2);
  for (int i = 0; i < 50; ++i) {
    const Schedule schedule = random_schedule(rng, 2 + rng.index(6), 1);
    const auto m = static_cast<Eigen::Index>(schedule.times.size()) - 1;
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(4 * m, 4 * m);
    VectorXd b = VectorXd::Zero(4 * m);
    Eigen::Index row = 0;
    for (Eigen::Index k = 0; k < m; ++k) {
      const auto n = static_cast<std::size_t>(k);
      const double h = schedule.times[n + 1] - schedule.times[n];
      A(row, 4 * k) = 1;
      b[row++] = schedule.places[n][0];
      A.row(row).segment(4 * k, 4) << 1, h, h * h, h * h * h;
      b[row++] = schedule.places[n + 1][0];
      if (k + 1 == m) continue;
      A.row(row).segment(4 * k, 4) << 0, 1, 2 * h, 3 * h * h;
      A(row++, 4 * k + 5) = -1;
      A.row(row).segment(4 * k, 4) << 0, 0, 2, 6 * h;
      A(row++, 4 * k + 6) = -2;
    }
    const double h = schedule.times.back() - schedule.times[static_cast<std::size_t>(m) - 1];
    A(row++, 2) = 2;
    A.row(row).segment(4 * (m - 1), 4) << 0, 0, 2, 6 * h;
    const VectorXd expected = A.fullPivLu().solve(b);
    const TimeMap map = interpolate(schedule, Interpolation::kCubic)[0];
    for (Eigen::Index k = 0; k < m; ++k) {
      for (Eigen::Index c = 0; c < 4; ++c) {
        EXPECT_NEAR(map.segments()[static_cast<std::size_t>(k)][static_cast<std::size_t>(c)],
                    expected[4 * k + c], 1e-8 * (1 + std::abs(expected[4 * k + c])));
      }
    }
  }
}

TEST(Interpolate, OfStraightPlacesIsStraightForCubic) {
  Schedule schedule{{VectorXd::Zero(1), VectorXd::Constant(1, 0.5), VectorXd::Constant(1, 2)},
                    {0, 1, 4}};
  const TimeMap map = interpolate(schedule, Interpolation::kCubic)[0];
  for (const double t : {0.3, 1.7, 3.9}) {
    EXPECT_NEAR(map(t), 0.5 * t, 1e-12);
    EXPECT_NEAR(map.at(t)[1], 0.5, 1e-12);
  }
}

TEST(Interpolate, RefusesSchedulesThatAreNone) {
  for (const Interpolation kind : kAll) {
    EXPECT_THROW(interpolate(Schedule{{VectorXd::Zero(2)}, {0}}, kind), ContractViolation);
    EXPECT_THROW(interpolate(Schedule{{VectorXd::Zero(2), VectorXd::Ones(2)}, {0, 0}}, kind),
                 ContractViolation);
    EXPECT_THROW(interpolate(Schedule{{VectorXd::Zero(2), VectorXd::Ones(1)}, {0, 1}}, kind),
                 ContractViolation);
    EXPECT_STRNE(to_string(kind), "unknown");
  }
}

}  // namespace
}  // namespace tandem::coordination
