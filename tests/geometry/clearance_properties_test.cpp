// What every clearance must satisfy, whatever computed it.

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "random_shapes.h"
#include "tandem/core/contract.h"
#include "tandem/geometry/distance.h"

namespace tandem::geometry {
namespace {

using Eigen::Isometry3d, Eigen::Vector3d;

Isometry3d translation(const Vector3d& p) {
  Isometry3d X = Isometry3d::Identity();
  X.translation() = p;
  return X;
}

/// Two cylinders' depth is what is least exact, and that of convex cores.
double tolerance(const Shape& a, const Shape& b) {
  const bool cylinders = a.type() == CoreType::kCylinder && b.type() == CoreType::kCylinder;
  const bool convex = a.type() == CoreType::kConvex || b.type() == CoreType::kConvex;
  return cylinders || convex ? 1e-7 : 1e-12;
}

/// Calls `check(a, b, c, rng)` on random pairs of every two types.
template <class Check>
void for_random_pairs(std::uint64_t seed, int count, const Check& check) {
  Rng rng(seed);
  for (const Draw draw : kDraws) {
    for (const CoreType type_a : kCoreTypes) {
      for (const CoreType type_b : kCoreTypes) {
        for (int i = 0; i < count && !testing::Test::HasFailure(); ++i) {
          const double spread = i % 2 == 0 ? 0.3 : 0.8;
          const Shape a = random_shape(rng, type_a, draw, spread);
          const Shape b = random_shape(rng, type_b, draw, spread);
          SCOPED_TRACE(testing::Message() << to_string(draw) << " case " << i
                                          << "\n  A: " << describe(a) << "\n  B: " << describe(b));
          check(a, b, clearance(a, b), rng);
        }
      }
    }
  }
}

TEST(Clearance, RisesAtFullRateAlongTheNormalFromAnyDepth) {
  for_random_pairs(1, 12, [](const Shape& a, const Shape& b, const Clearance& c, Rng&) {
    for (const double h : {1e-6, 1e-3, 0.4}) {
      const Shape moved = a.in(translation(h * c.nhat_BA_W));
      EXPECT_NEAR(clearance(moved, b).distance, c.distance + h, tolerance(a, b)) << "h " << h;
    }
    const Shape freed = a.in(translation(-c.distance * c.nhat_BA_W));
    EXPECT_NEAR(clearance(freed, b).distance, 0, tolerance(a, b));
  });
}

TEST(Clearance, OfCoresThatAllButTouchIsTheirSmallGap) {
  for_random_pairs(9, 15, [](const Shape& a, const Shape& b, const Clearance& c, Rng& rng) {
    const double radii = a.radius() + b.radius(), gap = c.distance + radii;
    if (gap < 1e-6) return;
    const double small = std::pow(10, rng.uniform(-13, -6));
    const Shape moved = a.in(translation((small - gap) * c.nhat_BA_W));
    EXPECT_NEAR(clearance(moved, b).distance + radii, small, tolerance(a, b)) << "gap " << small;
  });
}

TEST(Clearance, NoShorterTranslationSeparates) {
  for_random_pairs(2, 6, [](const Shape& a, const Shape& b, const Clearance& c, Rng& rng) {
    if (c.distance >= 0) return;
    for (int i = 0; i < 20; ++i) {
      const Vector3d p = 0.999 * -c.distance * random_direction(rng);
      EXPECT_LT(clearance(a.in(translation(p)), b).distance, 1e-7 - 0.001 * -c.distance);
    }
  });
}

TEST(Clearance, NormalAndWitnessGiveTheGradientOfAnyRigidMotion) {
  Rng rng(3);
  constexpr double h = 1e-6;
  double worst = 0;
  for (int i = 0; i < 8000; ++i) {
    const Shape a = random_shape(rng, kCoreTypes[rng.index(kCoreTypes.size())], Draw::kGeneric, 1);
    const Shape b = random_shape(rng, kCoreTypes[rng.index(kCoreTypes.size())], Draw::kGeneric, 1);
    const Clearance c = clearance(a, b);
    const double gap = c.distance + a.radius() + b.radius();
    if (gap < 0.05) continue;  // Nearer, the curvature of the distance exceeds what h allows.
    const Vector3d w = random_direction(rng), v = random_direction(rng);
    Isometry3d X = Isometry3d::Identity();
    X.linear() = Eigen::AngleAxisd(h, w).toRotationMatrix();
    X.translation() = h * v;
    const double slope = c.nhat_BA_W.dot(w.cross(c.p_WCa) + v);
    const double error = clearance(a.in(X), b).distance - c.distance - h * slope;
    // Parallel features lie beyond this: there the distance has a kink.
    EXPECT_LT(error, 1e-9) << describe(a) << "\n" << describe(b);
    worst = std::max(worst, std::abs(error));
  }
  std::printf("worst first-order error %.3g m at h = %.3g\n", worst, h);
}

TEST(Clearance, DoesNotDependOnTheFrame) {
  for_random_pairs(4, 10, [](const Shape& a, const Shape& b, const Clearance& c, Rng& rng) {
    const Isometry3d X = random_pose(rng, 3);
    const Clearance seen = clearance(a.in(X), b.in(X));
    EXPECT_NEAR(seen.distance, c.distance, 10 * tolerance(a, b));
  });
}

TEST(Clearance, OfSwappedShapesIsItsMirror) {
  for_random_pairs(5, 12, [](const Shape& a, const Shape& b, const Clearance& c, Rng&) {
    const Clearance back = clearance(b, a);
    EXPECT_NEAR(back.distance, c.distance, 2 * tolerance(a, b));
    EXPECT_LT((back.p_WCb - back.p_WCa + back.distance * back.nhat_BA_W).norm(), 1e-13);
  });
}

TEST(Clearance, ScalesWithTheScene) {
  Rng rng(6);
  const auto scaled = [](double s, const auto& make) { return make(s); };
  for (int i = 0; i < 2000; ++i) {
    const Isometry3d X = random_pose(rng, 0.3), Y = random_pose(rng, 0.3);
    const Vector3d size(rng.uniform(0.1, 1), rng.uniform(0.1, 1), rng.uniform(0.1, 1));
    const Vector3d p = random_point(rng, 0.6), q = random_point(rng, 0.6);
    const bool box = i % 2 == 0;
    const auto distance_at = [&](double s) {
      Isometry3d sX = X, sY = Y;
      sX.translation() *= s;
      sY.translation() *= s;
      const Shape a = box ? *Shape::box(sX, s * size) : *Shape::cylinder(sX, s * size[0], s);
      const Shape b = i % 3 == 0 ? *Shape::capsule(s * p, s * q, 0.01 * s)
                                 : *Shape::box(sY, s * size.reverse());
      return distance(a, b) / s;
    };
    const double expected = scaled(1, distance_at);
    EXPECT_NEAR(distance_at(1e-3), expected, 1e-11);
    EXPECT_NEAR(distance_at(1e3), expected, 1e-11);
  }
}

TEST(Distance, IsTheClearancesDistance) {
  for_random_pairs(7, 12, [](const Shape& a, const Shape& b, const Clearance& c, Rng&) {
    EXPECT_EQ(distance(a, b), c.distance);
  });
}

TEST(Distance, ToAPointAgreesWithTheCoreAndWithASmallSphere) {
  Rng rng(8);
  for (const CoreType type : kCoreTypes) {
    for (const Draw draw : kDraws) {
      for (int i = 0; i < 300; ++i) {
        const Shape shape = random_shape(rng, type, draw, 0.3);
        const Vector3d p = random_point(rng, 0.7);
        const double d = distance_to_point(shape, p), outside = distance_to_core(shape, p);
        if (outside > 1e-12) {
          EXPECT_NEAR(d, outside - shape.radius(), 1e-14) << describe(shape);
        }
        EXPECT_NEAR(d, clearance(shape, *Shape::sphere(p, 0.1)).distance + 0.1, 1e-14);
      }
    }
  }
  const Shape box = *Shape::box(Isometry3d::Identity(), Vector3d(2, 4, 6), 0.5);
  EXPECT_DOUBLE_EQ(distance_to_point(box, Vector3d(0.75, 0, 0)), -0.75);
  EXPECT_DOUBLE_EQ(distance_to_point(box, Vector3d(0, 0, 2.75)), -0.75);
  const Shape cylinder = *Shape::cylinder(Isometry3d::Identity(), 1, 6);
  EXPECT_DOUBLE_EQ(distance_to_point(cylinder, Vector3d(0, 0.75, 0)), -0.25);
  EXPECT_DOUBLE_EQ(distance_to_point(cylinder, Vector3d(0, 0, 2.875)), -0.125);
  EXPECT_DOUBLE_EQ(distance_to_point(cylinder, Vector3d::Zero()), -1);
  const double nan = std::nan("");
  EXPECT_THROW(distance_to_point(box, Vector3d(0, nan, 0)), ContractViolation);
}

/// Known answers, each from a drawing.
TEST(Clearance, MatchesHandComputedCases) {
  const Isometry3d I = Isometry3d::Identity();
  const Vector3d o = Vector3d::Zero(), x = Vector3d::UnitX(), y = Vector3d::UnitY(),
                 z = Vector3d::UnitZ();
  const auto tube = [](const Vector3d& p, const Vector3d& q) { return *Shape::capsule(p, q, 0.1); };
  const auto at = [](const Vector3d& p) { return translation(p); };
  const auto expect = [](const Shape& a, const Shape& b, double distance, const Vector3d& nhat) {
    const Clearance c = clearance(a, b);
    EXPECT_NEAR(c.distance, distance, 1e-15);
    EXPECT_NEAR(std::abs(c.nhat_BA_W.dot(nhat)), 1, 1e-15);
  };
  expect(tube(-x, x), tube(-y, y), -0.2, z);  // Crossing axes.
  expect(tube(-x, x), tube(-y + 0.5 * z, y + 0.5 * z), 0.3, z);
  expect(tube(o, x), tube(2 * x, 3 * x), 0.8, x);  // In line.
  const Shape wall = *Shape::rounded_rectangle(I, {4, 4}, 0.01);
  expect(tube(-0.25 * z, z), wall, -0.36, z);  // Through a thin wall.
  expect(tube(-x, x), wall, -0.11, z);         // Inside a thin wall.
  expect(wall, wall, -0.02, z);
  const Shape box = *Shape::box(I, Vector3d(2, 4, 6));
  expect(box, box, -2, x);
  expect(box, *Shape::box(at(1.5 * x), Vector3d(2, 4, 6)), -0.5, x);
  expect(box, *Shape::box(at(3 * x + 5 * y), Vector3d(2, 4, 6)), std::sqrt(2.0),
         (x + y) / std::sqrt(2.0));
  expect(*Shape::sphere(o, 0.5), *Shape::sphere(o, 0.25), -0.75,
         clearance(*Shape::sphere(o, 0.5), *Shape::sphere(o, 0.25)).nhat_BA_W);
  const Shape can = *Shape::cylinder(I, 1, 6);
  expect(can, *Shape::cylinder(at(3 * x), 1, 2), 1, x);  // Side by side.
  expect(can, *Shape::cylinder(at(1.5 * x), 1, 6), -0.5, x);
  expect(can, *Shape::cylinder(at(5 * z), 1, 6), -1, z);  // End in end.
  expect(can, *Shape::cylinder(at(7 * z + 0.5 * x), 1, 6), 1, z);
  expect(tube(-z, z), can, -1.1, Vector3d(clearance(tube(-z, z), can).nhat_BA_W));  // On the axis.
  expect(tube(2 * x - z, 2 * x + z), can, 0.9, x);
}

}  // namespace
}  // namespace tandem::geometry
