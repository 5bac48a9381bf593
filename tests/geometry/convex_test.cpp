#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "random_shapes.h"
#include "tandem/core/contract.h"
#include "tandem/geometry/distance.h"

namespace tandem::geometry {
namespace {

using Eigen::Isometry3d, Eigen::Matrix3d, Eigen::Vector3d;

using Points = std::vector<Vector3d>;

Points random_points(Rng& rng, std::size_t count, const Vector3d& size) {
  Points points(count);
  for (Vector3d& p : points) p = random_point(rng, 1).cwiseProduct(size);
  return points;
}

Points on_sphere(Rng& rng, std::size_t count) {
  Points points(count);
  for (Vector3d& p : points) p = random_direction(rng);
  return points;
}

/// The core of a box as a convex core.
Shape as_convex(const Shape& box) { return *Shape::convex(box.hull_vertices(), box.radius()); }

double furthest(const Points& points, const Vector3d& n) {
  double most = -1e300;
  for (const Vector3d& p : points) most = std::max(most, n.dot(p));
  return most;
}

TEST(ConvexHull, ContainsItsPointsAndIsClosed) {
  Rng rng(71);
  for (int i = 0; i < 200; ++i) {
    const std::size_t count = 4 + rng.index(60);
    const double thin = std::pow(10, -rng.uniform(0, 9));
    const Points points = random_points(rng, count, Vector3d(1, 1, i % 2 ? thin : 1));
    const Shape shape = *Shape::convex(points);
    const ConvexHull& hull = shape.hull();
    ASSERT_EQ(shape.type(), CoreType::kConvex);
    EXPECT_FALSE(hull.flat);
    // Euler: a closed surface of triangles without handles.
    EXPECT_EQ(hull.triangles.size(), 2 * hull.vertices.size() - 4);
    for (const Vector3d& n_H : hull.normals) {
      const double offset = n_H.dot(hull.vertices[static_cast<std::size_t>(hull.support(n_H))]);
      EXPECT_GT(offset, 0) << "the origin is inside";
      EXPECT_LT(furthest(points, n_H) - n_H.dot(shape.origin()), offset + 1e-14);
    }
    for (const Vector3d& v : shape.hull_vertices()) {
      const auto nearest =
          std::ranges::min(points, {}, [&](const Vector3d& p) { return (p - v).squaredNorm(); });
      EXPECT_LT((nearest - v).norm(), 1e-15) << "a vertex is one of the points";
    }
    for (int k = 0; k < 30; ++k) {
      const Vector3d n = random_direction(rng);
      EXPECT_NEAR(n.dot(shape.support(n)), furthest(points, n), 1e-14);
    }
  }
}

TEST(ConvexHull, ClimbsToTheFurthestOfManyVertices) {
  Rng rng(72);
  for (const std::size_t count : {25u, 128u, 1000u}) {
    Points points = on_sphere(rng, count);
    if (count == 128) {
      for (Vector3d& p : points) p = (8 * p).array().round() / 8;  // Many in common planes.
    }
    const Shape shape = *Shape::convex(points);
    for (int k = 0; k < 1500; ++k) {
      const Vector3d n = k % 3 == 0 ? Vector3d(Vector3d::Unit(k / 3 % 3)) : random_direction(rng);
      EXPECT_NEAR(n.dot(shape.support(n)), furthest(points, n), 1e-14);
    }
  }
}

TEST(Convex, OfTooFewDimensionsIsASimplerShapeOrRefused) {
  const Vector3d p(1, 2, 3), u(0.3, -0.1, 0.2), v(0, 0.4, 0.1);
  const Points line{p, p + u, p - 2 * u, p + 0.5 * u};
  const auto expect_refused = [](const Points& points, double radius, const std::string& part) {
    const auto shape = Shape::convex(points, radius);
    ASSERT_FALSE(shape) << part;
    EXPECT_EQ(shape.error().code, ErrorCode::kInvalidInput);
    EXPECT_NE(shape.error().message.find(part), std::string::npos) << shape.error().message;
  };
  expect_refused({}, 1, "needs a point");
  expect_refused({p, {0, NAN, 0}}, 1, "point 1 is not finite");
  expect_refused({p, p + u, p + v, Vector3d::Zero()}, -0.5, "radius is -0.5");
  expect_refused({p, p}, 0, "at one place");
  expect_refused(line, 0, "on one line");
  expect_refused({p, p + u, p + v, p + u + v}, 0, "in one plane");
  EXPECT_EQ(Shape::convex(Points{p, p}, 0.1)->type(), CoreType::kPoint);
  const Shape capsule = *Shape::convex(line, 0.1);
  EXPECT_EQ(capsule.type(), CoreType::kSegment);
  EXPECT_NEAR(capsule.extents().col(0).norm(), 1.5 * u.norm(), 1e-15);
  const Shape plate = *Shape::convex(Points{p, p + u, p + v, p + u + v, p + 0.5 * u}, 0.1);
  EXPECT_EQ(plate.type(), CoreType::kConvex);
  EXPECT_TRUE(plate.hull().flat);
  EXPECT_EQ(plate.hull().vertices.size(), 4u);
  EXPECT_THROW((void)capsule.hull(), ContractViolation);
}

TEST(Convex, SharesItsHullBetweenCopies) {
  Rng rng(73);
  const Shape shape = *Shape::convex(on_sphere(rng, 50), 0.1);
  const Shape moved = shape.in(random_pose(rng, 1)).padded(0.2);
  EXPECT_EQ(&moved.hull(), &shape.hull());
  EXPECT_NEAR(moved.radius(), 0.3, 1e-15);
}

TEST(Convex, VolumeIsThatOfItsBox) {
  Rng rng(74);
  for (int i = 0; i < 100; ++i) {
    const Shape box = random_shape(rng, CoreType::kBox, Draw::kGeneric, 1);
    EXPECT_NEAR(as_convex(box).volume(), box.volume(), 1e-12 * box.volume());
    EXPECT_NEAR(as_convex(box).bounding_radius(), box.bounding_radius(), 1e-9);
    const Shape wall = random_shape(rng, CoreType::kRectangle, Draw::kGeneric, 1);
    EXPECT_NEAR(as_convex(wall).volume(), wall.volume(), 1e-12 * wall.volume());
    EXPECT_TRUE(as_convex(wall).hull().flat);
  }
}

/// Boxes and rectangles as convex cores, against the closed forms.
TEST(Convex, AgreesWithTheClosedFormsOfBoxes) {
  Rng rng(75);
  double worst_apart = 0, worst_deep = 0;
  for (const Draw draw : kDraws) {
    for (const CoreType type : kCoreTypes) {
      for (int i = 0; i < 60; ++i) {
        const double spread = i % 2 ? 0.3 : 0.8;
        const CoreType flat = i % 5 == 0 ? CoreType::kRectangle : CoreType::kBox;
        const Shape box = random_shape(rng, flat, draw, spread);
        const Shape other = random_shape(rng, type, draw, spread);
        if (box.hull_vertices().size() < 4 || type == CoreType::kConvex) continue;
        const Shape convex = as_convex(box);
        const double expected = distance(other, box);
        const double error = std::abs(distance(other, convex) - expected);
        const bool apart = expected + box.radius() + other.radius() > 0;
        (apart ? worst_apart : worst_deep) = std::max(apart ? worst_apart : worst_deep, error);
        ASSERT_LT(error, apart ? 1e-9 : 1e-7) << to_string(draw) << " " << i << "\n"
                                              << describe(other) << "\n"
                                              << describe(box) << "\nexpected " << expected;
        if (other.type() != CoreType::kBox) continue;
        EXPECT_NEAR(distance(as_convex(other), convex), expected, apart ? 1e-9 : 1e-7)
            << to_string(draw) << " " << i << "\n"
            << describe(other) << "\n"
            << describe(box) << "\nexpected " << expected;
      }
    }
  }
  std::printf("worst error apart %.3g m, in penetration %.3g m\n", worst_apart, worst_deep);
}

}  // namespace
}  // namespace tandem::geometry
