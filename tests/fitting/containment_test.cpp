// The proof of containment accepts what is contained, and nothing else.

#include "tandem/fitting/containment.h"

#include <gtest/gtest.h>

#include "meshes.h"

namespace tandem::fitting {
namespace {

using Eigen::Vector3d;
using geometry::Shape;
using geometry::TriangleMesh;

TriangleMesh one_triangle(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  return {{a, b, c}, {{0, 1, 2}}};
}

TEST(Containment, OneVolumeHoldsWhatItsCornersSay) {
  const TriangleMesh mesh = test::box_mesh(Vector3d::Constant(-0.1), Vector3d::Constant(0.1));
  const double corner = 0.1 * std::sqrt(3.0);
  EXPECT_FALSE(prove_containment(mesh, std::vector{*Shape::sphere({0, 0, 0}, corner + 1e-6)}));
  const auto gap = prove_containment(mesh, std::vector{*Shape::sphere({0, 0, 0}, corner - 1e-6)});
  ASSERT_TRUE(gap);
  EXPECT_NEAR(gap->distance, 1e-6, 1e-12);
  EXPECT_NEAR(gap->p_LG.norm(), corner, 1e-12);
  EXPECT_FALSE(prove_containment(mesh, std::vector{*Shape::box(Eigen::Isometry3d::Identity(),
                                                               Vector3d::Constant(0.2), 1e-6)}));
}

TEST(Containment, TwoVolumesShareATriangle) {
  // Discs of radius r about (-1, 0) and (1, 0) cover the thin triangle only if they meet on it.
  const TriangleMesh mesh = one_triangle({-0.1, 0, 0}, {0.1, 0, 0}, {0, 0.05, 0});
  const auto pair = [](double radius) {
    return std::vector{*Shape::sphere({-0.1, 0, 0}, radius), *Shape::sphere({0.1, 0, 0}, radius)};
  };
  const double meet = std::hypot(0.1, 0.05);  // Both reach the tip: all that is left is covered.
  EXPECT_FALSE(prove_containment(mesh, pair(meet + 2e-4)));
  const auto gap = prove_containment(mesh, pair(meet - 1e-4));
  ASSERT_TRUE(gap);
  EXPECT_LT((gap->p_LG - Vector3d(0, 0.05, 0)).norm(), 1e-3);
  EXPECT_GT(gap->distance, 0);
}

TEST(Containment, NoticesAHoleInsideATriangle) {
  // Every corner and every edge is covered; only the middle is not.
  const TriangleMesh mesh = one_triangle({-0.3, -0.2, 0}, {0.3, -0.2, 0}, {0, 0.4, 0});
  std::vector<Shape> rim;
  for (std::size_t k = 0; k < 3; ++k) {
    rim.push_back(*Shape::capsule(mesh.vertices[k], mesh.vertices[(k + 1) % 3], 0.14));
  }
  const auto gap = prove_containment(mesh, rim);
  ASSERT_TRUE(gap);
  EXPECT_EQ(gap->triangle, 0);
  rim.push_back(*Shape::sphere({0, 0, 0}, 0.12));
  EXPECT_FALSE(prove_containment(mesh, rim));
}

TEST(Containment, AgreesWithSamplesOnRandomVolumes) {
  Rng rng(3);
  int accepted = 0, refused = 0;
  for (int i = 0; i < 300; ++i) {
    const auto vector = [&](double size) {
      return Vector3d(size * rng.uniform(-1, 1), size * rng.uniform(-1, 1),
                      size * rng.uniform(-1, 1));
    };
    const TriangleMesh mesh = one_triangle(vector(0.1), vector(0.1), vector(0.1));
    std::vector<Shape> volumes;
    for (int k = 0; k < 4; ++k) {
      const double radius = rng.uniform(0.03, 0.12);
      volumes.push_back(
          k % 2 ? *Shape::capsule(vector(0.1), vector(0.1), radius)
                : *Shape::rounded_rectangle(test::random_pose(rng), {0.1, 0.2}, radius));
    }
    const double out = test::sticks_out(mesh, volumes, rng, 2000);
    const auto gap = prove_containment(mesh, volumes);
    if (out > 0) {
      ASSERT_TRUE(gap) << i << ": " << out;
    }
    // Samples miss the worst point by little; what is covered with that to spare must be accepted.
    if (out < -0.005) {
      ASSERT_FALSE(gap) << i << ": " << out;
    }
    ++(gap ? refused : accepted);
  }
  EXPECT_GT(accepted, 50);
  EXPECT_GT(refused, 50);
}

TEST(Containment, AnythingShrunkenIsNoticed) {
  const TriangleMesh mesh = test::capsule_mesh(0.3, 0.05);
  const Shape exact = *Shape::capsule({0, 0, -0.15}, {0, 0, 0.15}, 0.05);
  EXPECT_FALSE(prove_containment(mesh, std::vector{exact.padded(1e-6)}));
  EXPECT_TRUE(prove_containment(mesh, std::vector{exact.padded(-1e-6)}));
}

TEST(Containment, DegenerateTrianglesArePoints) {
  const std::vector<Shape> volumes{*Shape::sphere({0, 0, 0}, 0.1)};
  const Vector3d in(0.05, 0, 0), out(0.2, 0, 0);
  EXPECT_FALSE(prove_containment(one_triangle(in, in, in), volumes));
  EXPECT_TRUE(prove_containment(one_triangle(out, out, out), volumes));
  EXPECT_TRUE(prove_containment(one_triangle(in, in, out), volumes));
}

}  // namespace
}  // namespace tandem::fitting
