#include "tandem/geometry/shape.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "random_shapes.h"
#include "tandem/core/contract.h"

namespace tandem::geometry {
namespace {

using Eigen::Isometry3d, Eigen::Vector2d, Eigen::Vector3d;

const Vector3d kOrigin = Vector3d::Zero();
const double kNan = std::numeric_limits<double>::quiet_NaN();
const double kInf = std::numeric_limits<double>::infinity();

void expect_rejected(const Result<Shape>& shape, const std::string& field,
                     const std::string& value) {
  ASSERT_FALSE(shape) << field << " " << value;
  EXPECT_EQ(shape.error().code, ErrorCode::kInvalidInput);
  EXPECT_NE(shape.error().message.find(field), std::string::npos) << shape.error().message;
  EXPECT_NE(shape.error().message.find(value), std::string::npos) << shape.error().message;
}

TEST(Shape, RejectsWithFieldAndValue) {
  const Isometry3d I = Isometry3d::Identity();
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), nan(0, kNan, 1), inf(0, 0, -kInf);
  expect_rejected(Shape::sphere(kOrigin, 0), "radius", "is 0");
  expect_rejected(Shape::sphere(kOrigin, -0.125), "radius", "-0.125");
  expect_rejected(Shape::sphere(kOrigin, kNan), "radius", "nan");
  expect_rejected(Shape::sphere(nan, 1), "centre", "nan");
  expect_rejected(Shape::capsule(kOrigin, x, 0), "radius", "is 0");
  expect_rejected(Shape::capsule(nan, x, 1), "end P", "nan");
  expect_rejected(Shape::capsule(x, inf, 1), "end Q", "-inf");
  expect_rejected(Shape::rounded_triangle(kOrigin, x, y, 0), "radius", "is 0");
  expect_rejected(Shape::rounded_triangle(kOrigin, nan, y, 1), "vertex Q", "nan");
  expect_rejected(Shape::rounded_triangle(kOrigin, x, inf, 1), "vertex R", "-inf");
  expect_rejected(Shape::rounded_rectangle(I, {1, -2.5}, 1), "size", "-2.5");
  expect_rejected(Shape::rounded_rectangle(I, {1, 1}, 0), "radius", "is 0");
  expect_rejected(Shape::box(I, {1, 0, 1}), "size", "1 0 1");
  expect_rejected(Shape::box(I, {1, kNan, 1}), "size", "nan");
  expect_rejected(Shape::box(I, {1, 1, 1}, -1e-3), "radius", "-0.001");
  expect_rejected(Shape::cylinder(I, 0, 1), "core radius", "is 0");
  expect_rejected(Shape::cylinder(I, 1, -3), "length", "-3");
  expect_rejected(Shape::cylinder(I, 1, 1, kInf), "radius", "inf");
  Isometry3d skewed = I, mirrored = I, away = I;
  skewed.matrix()(0, 1) = 0.25;
  mirrored.matrix()(2, 2) = -1;
  away.translation().y() = kInf;
  expect_rejected(Shape::box(skewed, {1, 1, 1}), "rotation", "0.25");
  expect_rejected(Shape::box(mirrored, {1, 1, 1}), "rotation", "-1");
  expect_rejected(Shape::cylinder(away, 1, 1), "position", "inf");
}

TEST(Shape, AcceptsDegenerateCoresThatHaveVolume) {
  const Vector3d x = Vector3d::UnitX();
  EXPECT_TRUE(Shape::capsule(x, x, 0.1));
  EXPECT_TRUE(Shape::rounded_triangle(x, x, x, 0.1));
  EXPECT_TRUE(Shape::rounded_triangle(kOrigin, x, 2 * x, 0.1));
  EXPECT_TRUE(Shape::box(Isometry3d::Identity(), {1, 1, 1e-9}));
}

TEST(Shape, KeepsWhatItWasMadeOf) {
  Isometry3d X = Isometry3d::Identity();
  X.translation() = Vector3d(1, 2, 3);
  X.linear() = Eigen::AngleAxisd(0.5, Vector3d::UnitX()).toRotationMatrix();
  const Shape box = *Shape::box(X, {2, 4, 6}, 0.25);
  EXPECT_EQ(box.type(), CoreType::kBox);
  EXPECT_EQ(box.size_count(), 3);
  EXPECT_EQ(box.radius(), 0.25);
  EXPECT_TRUE(box.origin().isApprox(X.translation()));
  EXPECT_TRUE(box.extents().isApprox(X.linear() * Vector3d(1, 2, 3).asDiagonal()));
  EXPECT_TRUE(box.inverse_squares().isApprox(Vector3d(1, 0.25, 1.0 / 9)));
  const Shape tube = *Shape::capsule({1, 0, 0}, {1, 0, 4}, 0.5);
  EXPECT_TRUE(tube.origin().isApprox(Vector3d(1, 0, 2)));
  EXPECT_TRUE(tube.extents().col(0).isApprox(Vector3d(0, 0, 2)));
  EXPECT_EQ(tube.extents().col(1), kOrigin);
  EXPECT_EQ(Shape::capsule({1, 0, 0}, {1, 0, 0}, 0.5)->inverse_squares(), kOrigin);
  const Shape can = *Shape::cylinder(X, 0.5, 4);
  EXPECT_TRUE(can.extents().col(0).isApprox(2 * X.linear().col(2)));
  EXPECT_EQ(can.core_radius(), 0.5);
}

TEST(Shape, PaddingAddsToTheRadiusAndMayNotMakeItNegative) {
  const Shape ball = *Shape::sphere(kOrigin, 0.5);
  EXPECT_EQ(ball.padded(0.25).radius(), 0.75);
  EXPECT_EQ(ball.padded(-0.5).radius(), 0);
  EXPECT_THROW(ball.padded(-0.75), ContractViolation);
  EXPECT_THROW(ball.padded(kNan), ContractViolation);
}

class EveryType : public testing::TestWithParam<CoreType> {};

TEST_P(EveryType, SupportIsTheFurthestCorePoint) {
  Rng rng(11);
  for (const Draw draw : kDraws) {
    for (int i = 0; i < 100; ++i) {
      const Shape shape = random_shape(rng, GetParam(), draw, 1);
      const Vector3d n = random_direction(rng), p = shape.support(3.5 * n);
      EXPECT_LT(distance_to_core(shape, p), 1e-14) << describe(shape);
      for (int k = 0; k < 50; ++k) {
        // The library's own support in another direction is another core point.
        EXPECT_LE(shape.support(random_direction(rng)).dot(n), p.dot(n) + 1e-14);
      }
      for (const Vector3d& axis : {Vector3d(shape.extents().col(0)), kOrigin}) {
        EXPECT_LT(distance_to_core(shape, shape.support(axis)), 1e-14) << "along an extent";
      }
    }
  }
}

TEST_P(EveryType, HullVerticesEncloseTheCoreAndFollowIt) {
  Rng rng(12);
  const std::size_t counts[] = {1, 2, 3, 4, 8, 8};
  for (int i = 0; i < 200; ++i) {
    const Shape shape = random_shape(rng, GetParam(), Draw::kGeneric, 1);
    const auto vertices = shape.hull_vertices();
    if (GetParam() == CoreType::kConvex) {
      EXPECT_EQ(vertices.size(), shape.hull().vertices.size());
    } else {
      EXPECT_EQ(vertices.size(), counts[static_cast<std::size_t>(GetParam())]);
    }
    const Vector3d n = random_direction(rng);
    double furthest = -kInf;
    for (const Vector3d& v : vertices) {
      furthest = std::max(furthest, v.dot(n));
      if (GetParam() != CoreType::kCylinder) {
        EXPECT_LT(distance_to_core(shape, v), 1e-14);
      }
    }
    EXPECT_LE(shape.support(n).dot(n), furthest + 1e-14);
    const Isometry3d X = random_pose(rng, 1);
    EXPECT_LT((shape.in(X).support(X.linear() * n) - X * shape.support(n)).norm(), 1e-13);
  }
}

TEST_P(EveryType, BoundingSphereIsTight) {
  Rng rng(13);
  for (const Draw draw : kDraws) {
    for (int i = 0; i < 100; ++i) {
      const Shape shape = random_shape(rng, GetParam(), draw, 1);
      const Vector3d c = shape.bounding_center();
      double furthest = 0;
      auto points = shape.hull_vertices();
      for (int k = 0; k < 20; ++k) points.push_back(shape.support(random_direction(rng)));
      if (GetParam() == CoreType::kCylinder) {
        points.erase(points.begin(), points.begin() + 8);
        points.push_back(shape.support(shape.extents().col(0) + 1e-3 * Vector3d(1, 2, 3)));
      }
      for (const Vector3d& p : points) furthest = std::max(furthest, (p - c).norm());
      EXPECT_NEAR(furthest + shape.radius(), shape.bounding_radius(), 1e-14) << describe(shape);
      // No sphere about another centre nearby is smaller.
      for (int k = 0; k < 20; ++k) {
        const Vector3d other = c + 0.05 * random_direction(rng);
        double reach = 0;
        for (const Vector3d& p : points) reach = std::max(reach, (p - other).norm());
        const double nearly = GetParam() == CoreType::kConvex ? 1e-3 * furthest : 1e-14;
        EXPECT_GE(reach, GetParam() == CoreType::kCylinder ? 0.0 : furthest - nearly);
      }
    }
  }
}

TEST_P(EveryType, VolumeMatchesSampling) {
  Rng rng(14);
  for (int i = 0; i < 3; ++i) {
    const Shape shape = random_shape(rng, GetParam(), Draw::kGeneric, 1).padded(0.1);
    // A box about it, not about its bounding sphere: more samples hit.
    Eigen::AlignedBox3d box;
    for (const Vector3d& v : shape.hull_vertices()) box.extend(v);
    box.extend(box.min() - Vector3d::Constant(shape.radius()));
    box.extend(box.max() + Vector3d::Constant(shape.radius()));
    constexpr int kSamples = 100000;
    int hits = 0;
    for (int k = 0; k < kSamples; ++k) {
      const Vector3d f(rng.uniform(), rng.uniform(), rng.uniform());
      hits += distance_to_core(shape, box.min() + f.cwiseProduct(box.sizes())) <= shape.radius();
    }
    const double share = hits / double(kSamples);
    const double sigma = std::sqrt(share * (1 - share) / kSamples);
    EXPECT_NEAR(shape.volume(), share * box.volume(), 4 * sigma * box.volume());
  }
}

INSTANTIATE_TEST_SUITE_P(Shape, EveryType, testing::ValuesIn(kCoreTypes),
                         [](const auto& instance) { return to_string(instance.param); });

TEST(Shape, ACylindersEndIsNoFurtherThanItsLength) {
  // Directions along the axis leave rounding across it, which must not count as a direction.
  Rng rng(8);
  for (int n = 0; n < 5000; ++n) {
    const double length = rng.uniform(0.01, 2), radius = rng.uniform(0.01, 1);
    const Shape upright = *Shape::cylinder(Isometry3d::Identity(), radius, length);
    for (double sign : {-1.0, 1.0}) {
      const Vector3d along(0, 0, sign * rng.uniform(0.1, 10));
      EXPECT_NEAR(sign * upright.support(along).z(), length / 2, 1e-14);
    }
  }
}

TEST(Shape, VolumeInClosedForm) {
  const Isometry3d I = Isometry3d::Identity();
  EXPECT_NEAR(Shape::sphere(kOrigin, 2)->volume(), 4.0 / 3 * M_PI * 8, 1e-12);
  EXPECT_NEAR(Shape::capsule(kOrigin, {0, 0, 3}, 1)->volume(), M_PI * (3 + 4.0 / 3), 1e-12);
  EXPECT_NEAR(Shape::box(I, {1, 2, 3})->volume(), 6, 1e-12);
  EXPECT_NEAR(Shape::cylinder(I, 2, 3)->volume(), 12 * M_PI, 1e-12);
}

// Beyond this, squares and products of lengths would overflow, and distances with them.
TEST(Shape, RefusesLengthsWithoutMeaning) {
  const Vector3d o = Vector3d::Zero(), far(0, 1e51, 0);
  Isometry3d X = Isometry3d::Identity();
  EXPECT_TRUE(Shape::sphere(o, 1e50));
  EXPECT_TRUE(Shape::box(X, Vector3d(1e-50, 1, 1)));
  EXPECT_FALSE(Shape::sphere(o, 1e51));
  EXPECT_FALSE(Shape::sphere(o, 1e-320));
  EXPECT_FALSE(Shape::sphere(far, 1));
  EXPECT_FALSE(Shape::capsule(o, far, 1));
  EXPECT_FALSE(Shape::rounded_triangle(-far, far, o, 1));
  EXPECT_FALSE(Shape::box(X, Vector3d(1, 1, 1e-200)));
  EXPECT_FALSE(Shape::box(X, Vector3d(1, 1, 1), 1e51));
  EXPECT_FALSE(Shape::cylinder(X, 1, 1e51));
  EXPECT_FALSE(Shape::convex(std::vector<Vector3d>{o, far, Vector3d(1, 0, 0), Vector3d(0, 0, 1)}));
  X.translation() = far;
  EXPECT_FALSE(Shape::box(X, Vector3d(1, 1, 1)));
}

}  // namespace
}  // namespace tandem::geometry
