#include "tandem/math/so3.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tandem/core/rng.h"

namespace tandem::math {
namespace {

using Eigen::Matrix3d, Eigen::Quaterniond, Eigen::Vector3d;

Vector3d random_unit(Rng& rng) {
  Vector3d v;
  do {
    v = Vector3d(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1));
  } while (v.norm() < 0.1 || v.norm() > 1);
  return v.normalized();
}

Matrix3d cross_matrix(const Vector3d& p) {
  Matrix3d P;
  P << 0, -p.z(), p.y(), p.z(), 0, -p.x(), -p.y(), p.x(), 0;
  return P;
}

/// The exponential by its power series, which knows nothing of quaternions.
Matrix3d rotation_by_series(const Vector3d& p) {
  Matrix3d sum = Matrix3d::Identity(), term = sum;
  for (int k = 1; k < 60; ++k) {
    term = term * cross_matrix(p) / k;
    sum += term;
  }
  return sum;
}

/// Rotation angles from nothing to almost pi, dense where the series take over.
std::vector<double> angles(Rng& rng) {
  std::vector<double> all{0.0,  1e-300,   1e-160, 1e-20,  1e-9, 1e-4,  0.999e-3,
                          1e-3, 1.001e-3, 2e-3,   0.0999, 0.1,  0.1001};
  for (double below : {1e-2, 1e-5, 1e-9, 1e-12}) all.push_back(std::numbers::pi - below);
  for (int i = 0; i < 200; ++i) all.push_back(rng.uniform(0, std::numbers::pi));
  for (int i = 0; i < 200; ++i) all.push_back(std::pow(10, rng.uniform(-12, 0)));
  return all;
}

TEST(ExpMap, IsTheMatrixExponential) {
  Rng rng(1);
  for (double angle : angles(rng)) {
    const Vector3d p = angle * random_unit(rng);
    const Quaterniond u = exp_map(p);
    EXPECT_NEAR(u.norm(), 1, 1e-15);
    EXPECT_LT((u.toRotationMatrix() - rotation_by_series(p)).norm(), 1e-13) << angle;
  }
}

TEST(LogMap, InvertsTheExponentialWithFullRelativePrecision) {
  Rng rng(2);
  for (double angle : angles(rng)) {
    const Vector3d p = angle * random_unit(rng);
    EXPECT_LE((log_map(exp_map(p)) - p).norm(), 2e-15 * angle) << angle;
  }
}

TEST(LogMap, TakesTheShortestArcWhateverTheSignOfTheQuaternion) {
  Rng rng(3);
  for (int i = 0; i < 500; ++i) {
    const double angle = rng.uniform(0, 2 * std::numbers::pi);
    const Vector3d axis = random_unit(rng);
    const Quaterniond u = exp_map(angle * axis), negative(-u.coeffs());
    const Vector3d p = log_map(u);
    const double shortest = std::min(angle, 2 * std::numbers::pi - angle);
    EXPECT_NEAR(p.norm(), shortest, 1e-14);
    EXPECT_LT((log_map(negative) - p).norm(), 1e-14);
    EXPECT_LT((rotation_by_series(p) - u.toRotationMatrix()).norm(), 1e-12);
  }
}

TEST(LogMap, IsExactAtAHalfTurnAndAtNone) {
  EXPECT_EQ(log_map(Quaterniond(1, 0, 0, 0)), Vector3d::Zero());
  EXPECT_EQ(log_map(Quaterniond(-1, 0, 0, 0)), Vector3d::Zero());
  for (double w : {0.0, -0.0}) {
    const Vector3d p = log_map(Quaterniond(w, 0, 1, 0));
    EXPECT_DOUBLE_EQ(p.norm(), std::numbers::pi);
    EXPECT_DOUBLE_EQ(std::abs(p.y()), std::numbers::pi);
  }
}

TEST(LogMapJacobian, MatchesDifferencesInBothFrames) {
  Rng rng(4);
  constexpr double kStep = 1e-5;
  for (int i = 0; i < 500; ++i) {
    // Beyond pi the logarithm jumps to the other arc, so differences end there.
    const double angle = i % 2 ? rng.uniform(0, 3.1) : std::pow(10, rng.uniform(-9, -1));
    const Vector3d p = angle * random_unit(rng), xi = random_unit(rng);
    const Vector3d d_start =
        (log_map(exp_map(kStep * xi) * exp_map(p)) - log_map(exp_map(-kStep * xi) * exp_map(p))) /
        (2 * kStep);
    const Vector3d d_moved =
        (log_map(exp_map(p) * exp_map(kStep * xi)) - log_map(exp_map(p) * exp_map(-kStep * xi))) /
        (2 * kStep);
    EXPECT_LT((log_map_jacobian(p) * xi - d_start).norm(), 1e-8) << angle;
    EXPECT_LT((log_map_jacobian(-p) * xi - d_moved).norm(), 1e-8) << angle;
  }
}

TEST(LogMapJacobian, LeavesTheRotationVectorItself) {
  Rng rng(5);
  for (int i = 0; i < 500; ++i) {
    const Vector3d p = rng.uniform(0, 6) * random_unit(rng);
    EXPECT_LT((p.transpose() * log_map_jacobian(p) - p.transpose()).norm(), 1e-12);
    EXPECT_LT((p.transpose() * log_map_jacobian(-p) - p.transpose()).norm(), 1e-12);
  }
}

TEST(LogMapJacobian, IsContinuousWhereItsSeriesEndsAndRegularAtPi) {
  const Vector3d axis = Vector3d(1, -2, 0.5).normalized();
  const Matrix3d below = log_map_jacobian(0.1 * (1 - 1e-15) * axis),
                 above = log_map_jacobian(0.1 * (1 + 1e-15) * axis);
  EXPECT_LT((below - above).norm(), 1e-14);
  EXPECT_TRUE(log_map_jacobian(Vector3d::Zero()).isIdentity(0));
  EXPECT_TRUE(log_map_jacobian(std::numbers::pi * axis).allFinite());
  EXPECT_LT(log_map_jacobian(std::numbers::pi * axis).norm(), 5);
}

}  // namespace
}  // namespace tandem::math
