// Volumes fitted to meshes whose best volumes are known.

#include "tandem/fitting/fit.h"

#include <gtest/gtest.h>

#include <limits>

#include "meshes.h"
#include "tandem/core/contract.h"
#include "tandem/fitting/containment.h"

namespace tandem::fitting {
namespace {

using Eigen::Vector3d;
using geometry::CoreType;
using geometry::Shape;
using geometry::TriangleMesh;

constexpr double kTiny = 1e-8;  // [m]: the margin is 1e-6.

MeshFit fitted(const TriangleMesh& mesh, int count, std::uint64_t seed = 1) {
  FitOptions options;
  options.count = count;
  options.seed = seed;
  options.starts = 6;
  const auto fit = fit_mesh(mesh, options);
  EXPECT_TRUE(fit) << fit.error().message;
  EXPECT_LE(fit->volumes_L.size(), static_cast<std::size_t>(count));
  EXPECT_FALSE(prove_containment(mesh, fit->volumes_L));
  Rng rng(seed);
  EXPECT_LE(test::sticks_out(mesh, fit->volumes_L, rng), kTiny);
  return *fit;
}

TEST(Fit, ABallBecomesASphere) {
  const MeshFit fit = fitted(test::ball(0.08), 2);
  ASSERT_EQ(fit.volumes_L.size(), 1u);
  EXPECT_EQ(fit.volumes_L[0].type(), CoreType::kPoint);
  EXPECT_NEAR(fit.volumes_L[0].radius(), 0.08, 5e-4);
  EXPECT_LT(fit.excess / fit.solid, 0.03);
  EXPECT_TRUE(fit.is_closed);
}

TEST(Fit, ACapsuleBecomesACapsule) {
  Rng rng(5);
  for (int i = 0; i < 3; ++i) {
    const MeshFit fit =
        fitted(test::moved(test::capsule_mesh(0.3, 0.05), test::random_pose(rng)), 2);
    ASSERT_EQ(fit.volumes_L.size(), 1u);
    EXPECT_EQ(fit.volumes_L[0].type(), CoreType::kSegment);
    EXPECT_NEAR(fit.volumes_L[0].radius(), 0.05, 1e-3);
    EXPECT_LT(fit.excess / fit.solid, 0.05);
    EXPECT_LT(fit.protrusion, 2e-3);
  }
}

TEST(Fit, ABoxBecomesABox) {
  const MeshFit fit = fitted(test::box_mesh({0, 0, 0}, {0.3, 0.2, 0.1}), 2);
  ASSERT_EQ(fit.volumes_L.size(), 1u);
  EXPECT_EQ(fit.volumes_L[0].type(), CoreType::kBox);
  EXPECT_LT(fit.excess / fit.solid, 0.05);
  EXPECT_NEAR(fit.solid, 0.006, 1e-4);
  EXPECT_NEAR(fit.area, 0.22, 1e-12);
}

TEST(Fit, APlateBecomesARectangle) {
  // Rounded all around: a rectangle of 20 x 14 cm swept by 2 cm.
  const TriangleMesh plate = test::globe([](const Vector3d& n) -> Vector3d {
    return 0.02 * n + Vector3d(std::copysign(0.1, n.x()), std::copysign(0.07, n.y()), 0);
  });
  const MeshFit fit = fitted(plate, 2);
  ASSERT_EQ(fit.volumes_L.size(), 1u);
  EXPECT_EQ(fit.volumes_L[0].type(), CoreType::kRectangle);
  EXPECT_LT(fit.excess / fit.solid, 0.08);
}

TEST(Fit, AnElbowBecomesTwoCapsules) {
  const MeshFit one = fitted(test::elbow(), 1), two = fitted(test::elbow(), 2);
  EXPECT_EQ(one.volumes_L.size(), 1u);
  ASSERT_EQ(two.volumes_L.size(), 2u);
  EXPECT_EQ(two.volumes_L[0].type(), CoreType::kSegment);
  EXPECT_EQ(two.volumes_L[1].type(), CoreType::kSegment);
  EXPECT_LT(two.excess / two.solid, 0.12);
  EXPECT_GT(one.excess, 3 * two.excess);
}

TEST(Fit, MeasuresAreThoseOfTheVolumes) {
  // A cube in a sphere: known to the last digit.
  const double half = 0.05, radius = half * std::sqrt(3.0);
  const MeshFit fit =
      fitted(test::box_mesh(Vector3d::Constant(-half), Vector3d::Constant(half)), 1);
  EXPECT_NEAR(fit.solid, 1e-3, 1e-5);
  if (fit.volumes_L[0].type() == CoreType::kPoint) {
    EXPECT_NEAR(fit.excess, 4.0 / 3 * std::numbers::pi * std::pow(radius, 3) - 1e-3, 5e-5);
    EXPECT_NEAR(fit.protrusion, radius - half, 1e-3);
  } else {
    EXPECT_LT(fit.excess, 1e-4);
  }
}

TEST(Fit, SameSeedSameVolumes) {
  const MeshFit a = fitted(test::elbow(), 2, 7), b = fitted(test::elbow(), 2, 7);
  ASSERT_EQ(a.volumes_L.size(), b.volumes_L.size());
  for (std::size_t i = 0; i < a.volumes_L.size(); ++i) {
    EXPECT_EQ(a.volumes_L[i].origin(), b.volumes_L[i].origin());
    EXPECT_EQ(a.volumes_L[i].extents(), b.volumes_L[i].extents());
    EXPECT_EQ(a.volumes_L[i].radius(), b.volumes_L[i].radius());
  }
  EXPECT_EQ(a.excess, b.excess);
}

TEST(Fit, PaddingIsAddedToTheFit) {
  FitOptions options;
  options.count = 1;
  const auto plain = fit_mesh(test::ball(0.05), options);
  options.padding = 0.01;
  const auto padded = fit_mesh(test::ball(0.05), options);
  ASSERT_TRUE(plain && padded);
  EXPECT_NEAR(padded->volumes_L[0].radius(), plain->volumes_L[0].radius() + 0.01, 1e-12);
  EXPECT_EQ(padded->excess, plain->excess);
}

TEST(Fit, WhenTimeRunsOutTheBestSoFarIsProven) {
  for (const double seconds : {0.0, 0.05, 0.3}) {
    FitOptions options;
    options.count = 8;
    const auto begin = Clock::now();
    const auto fit = fit_mesh(test::elbow(), options, StopCondition::after(seconds));
    ASSERT_TRUE(fit);
    EXPECT_TRUE(fit->cut_short);
    EXPECT_FALSE(prove_containment(test::elbow(), fit->volumes_L));
    EXPECT_LT(std::chrono::duration<double>(Clock::now() - begin).count(), seconds + 3);
  }
}

TEST(Fit, StopsOnRequest) {
  std::stop_source source;
  source.request_stop();
  const auto fit =
      fit_mesh(test::ball(0.1), {},
               StopCondition::after(std::numeric_limits<double>::infinity(), source.get_token()));
  ASSERT_FALSE(fit);
  EXPECT_EQ(fit.error().code, ErrorCode::kCancelled);
}

TEST(Fit, OpenAndDirtyMeshesAreContainedToo) {
  TriangleMesh open = test::capsule_mesh(0.2, 0.06);
  open.triangles.resize(open.triangles.size() * 9 / 10);
  EXPECT_FALSE(fitted(open, 2).is_closed);

  TriangleMesh turned = test::box_mesh({0, 0, 0}, {0.2, 0.1, 0.1});
  for (auto& [a, b, c] : turned.triangles) std::swap(a, b);
  EXPECT_NEAR(fitted(turned, 1).solid, 2e-3, 4e-5);

  TriangleMesh dirty = turned;  // Doubled corners, needles, points, a stray triangle.
  dirty.vertices.insert(dirty.vertices.end(), {{0, 0, 0}, {0, 0, 0}, {0.3, 0, 0}, {0.1, 0.2, 0}});
  dirty.triangles.insert(dirty.triangles.end(),
                         {{8, 9, 8}, {8, 9, 10}, {8, 10, 11}, {3, 3, 3}, {0, 8, 7}});
  EXPECT_FALSE(fitted(dirty, 2).is_closed);

  const TriangleMesh flat{{{0, 0, 0}, {0.2, 0, 0}, {0, 0.2, 0}}, {{0, 1, 2}}};
  EXPECT_LT(fitted(flat, 2).solid, 1e-9);
}

TEST(Fit, SmallAndLargeMeshes) {
  EXPECT_LT(fitted(test::ball(0.002), 1).volumes_L[0].radius(), 0.0025);
  EXPECT_LT(fitted(test::ball(5), 1).volumes_L[0].radius(), 5.1);
}

TEST(Fit, RefusesMeshesWithoutSense) {
  const TriangleMesh line{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}};
  const TriangleMesh millimetres = test::ball(80e3);
  TriangleMesh stray = test::ball(0.1), nan = stray;
  stray.triangles.push_back({0, 1, 1000000});
  nan.vertices[3].y() = std::nan("");
  const std::pair<const TriangleMesh*, const char*> cases[] = {
      {&line, "no area"}, {&millimetres, "0.001"}, {&stray, "does not exist"}, {&nan, "not finite"}};
  for (const auto& [mesh, says] : cases) {
    const auto fit = fit_mesh(*mesh, {});
    ASSERT_FALSE(fit) << says;
    EXPECT_EQ(fit.error().code, ErrorCode::kInvalidInput);
    EXPECT_NE(fit.error().message.find(says), std::string::npos) << fit.error().message;
  }
  EXPECT_FALSE(fit_mesh({}, {}));
  EXPECT_THROW((void)fit_mesh(test::ball(1), {.count = 0}), ContractViolation);
}

}  // namespace
}  // namespace tandem::fitting
