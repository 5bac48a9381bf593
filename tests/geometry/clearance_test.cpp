#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "oracle.h"
#include "random_shapes.h"
#include "tandem/geometry/distance.h"

namespace tandem::geometry {
namespace {

using Eigen::Vector3d;

/// Gap of the cores along `nhat`, by support points.
double core_gap(const Shape& a, const Shape& b, const Vector3d& nhat) {
  return nhat.dot(a.support(-nhat) - b.support(nhat));
}

/// [m] How exact the documentation says depths and distances are.
double tolerance(const Shape& a, const Shape& b, double gap) {
  const bool convex = a.type() == CoreType::kConvex || b.type() == CoreType::kConvex;
  const bool curved = a.type() == CoreType::kCylinder || b.type() == CoreType::kCylinder;
  if (convex) return gap > 1e-8 ? (curved ? 1e-7 : 1e-9) : 1e-7;
  if (!curved) return 1e-13;
  if (a.type() != b.type()) return 1e-12;
  return gap > 1e-8 ? 1e-9 : 1e-7;
}

/// What can be proven about one answer: the witness points lie on the surfaces (so no distance is
/// greater), the cores are that far apart along the normal (so none is less, and a depth is
/// enough), and an oracle agrees. Only that a depth is least is left to `expect_least_depth`.
void expect_certified(const Shape& a, const Shape& b, const Clearance& c, Draw draw) {
  // Among nearly parallel features a squared distance right to rounding leaves this in direction.
  const bool rim_on_edge = (a.type() == CoreType::kConvex && b.type() == CoreType::kCylinder) ||
                           (b.type() == CoreType::kConvex && a.type() == CoreType::kCylinder);
  const double angle = draw == Draw::kGeneric && !rim_on_edge ? 1e-12 : 1e-7;
  const double radii = a.radius() + b.radius(), gap = c.distance + radii;
  const double tol = tolerance(a, b, gap);
  EXPECT_NEAR(c.nhat_BA_W.norm(), 1, 1e-14);
  EXPECT_LT((c.p_WCa - c.p_WCb - c.distance * c.nhat_BA_W).norm(), 1e-14);
  EXPECT_LT(distance_to_core(a, c.p_WCa + a.radius() * c.nhat_BA_W), tol);
  EXPECT_LT(distance_to_core(b, c.p_WCb - b.radius() * c.nhat_BA_W), tol);
  EXPECT_NEAR(core_gap(a, b, c.nhat_BA_W), gap, gap > 1e-8 ? angle : tol);
  const Bounds bounds = core_distance(a, b);
  EXPECT_LT(gap - bounds.high, tol);
  if (gap > 1e-8) {
    EXPECT_LT(bounds.low - gap, tol);
  }
  if (bounds.low > 0) {
    EXPECT_LT(bounds.high - bounds.low, 1e-9) << "the oracle is not sure";
  }
}

/// Sampled directions, the best of them refined, give no shorter translation apart.
void expect_least_depth(const Shape& a, const Shape& b, const Clearance& c, Rng& rng) {
  const double gap = c.distance + a.radius() + b.radius();
  double best = -1e9;
  Vector3d nhat = Vector3d::UnitZ();
  const auto look = [&](const Vector3d& n) {
    const double g = core_gap(a, b, n);
    if (g <= best) return;
    best = g;
    nhat = n;
  };
  for (int i = 0; i < 300; ++i) look(random_direction(rng));
  for (double step = 0.3; step > 1e-9; step *= 0.8) {
    for (int i = 0; i < 4; ++i) look((nhat + step * random_direction(rng)).normalized());
  }
  EXPECT_LT(best - gap, tolerance(a, b, gap));
}

class EveryPair : public testing::TestWithParam<std::tuple<CoreType, CoreType, Draw>> {};

TEST_P(EveryPair, IsCertified) {
  const auto [type_a, type_b, draw] = GetParam();
  Rng rng(100 * static_cast<unsigned>(type_a) + 10 * static_cast<unsigned>(type_b) +
          static_cast<unsigned>(draw));
  int overlapping = 0;
  constexpr int kCases = 600;
  for (int i = 0; i < kCases && !HasFailure(); ++i) {
    const double spread = i % 3 == 0 ? 1.0 : i % 3 == 1 ? 0.3 : 0.5;
    const Shape a = random_shape(rng, type_a, draw, spread);
    const Shape b = random_shape(rng, type_b, draw, spread);
    SCOPED_TRACE(testing::Message()
                 << "case " << i << "\n  A: " << describe(a) << "\n  B: " << describe(b));
    const Clearance c = clearance(a, b);
    expect_certified(a, b, c, draw);
    const bool overlap = c.distance + a.radius() + b.radius() < 1e-8;
    overlapping += overlap;
    if (overlap) expect_least_depth(a, b, c, rng);

    const Clearance back = clearance(b, a);
    EXPECT_NEAR(back.distance, c.distance, 2 * tolerance(a, b, overlap ? 0 : 1));
    expect_certified(b, a, back, draw);
  }
  RecordProperty("overlapping", overlapping);
}

INSTANTIATE_TEST_SUITE_P(Clearance, EveryPair,
                         testing::Combine(testing::ValuesIn(kCoreTypes),
                                          testing::ValuesIn(kCoreTypes), testing::ValuesIn(kDraws)),
                         [](const auto& instance) {
                           return std::string(to_string(std::get<0>(instance.param))) + "_" +
                                  to_string(std::get<1>(instance.param)) + "_" +
                                  to_string(std::get<2>(instance.param));
                         });

TEST(Clearance, OfTriangleWithoutAreaIsThatOfItsSegment) {
  Rng rng(31);
  for (int i = 0; i < 8000; ++i) {
    const Vector3d p = random_point(rng, 0.3), u = random_point(rng, 0.3);
    const double stretch = 0.5 * static_cast<double>(rng.index(9)) - 2;
    const double from = std::min(0.0, stretch), to = std::max(1.0, stretch);
    const Shape flat = *Shape::rounded_triangle(p, p + u, p + stretch * u, 0.1);
    const Shape line = *Shape::capsule(p + from * u, p + to * u, 0.1);
    const Shape other = i % 4 == 0 ? *Shape::sphere(p + rng.uniform(-3, 3) * u, 0.1)
                                   : random_shape(rng, kCoreTypes[rng.index(kCoreTypes.size())],
                                                  Draw::kGeneric, 0.5);
    EXPECT_NEAR(clearance(other, flat).distance, clearance(other, line).distance,
                other.type() == CoreType::kConvex ? 1e-9 : 1e-13)
        << describe(other) << "\n"
        << describe(flat);
  }
}

TEST(Clearance, OfAPointNearACylindersAxisFollowsTheRadius) {
  Rng rng(32);
  for (int i = 0; i < 2000; ++i) {
    const Shape can = *Shape::cylinder(random_pose(rng, 1), 0.1, rng.uniform(0.3, 2));
    const Vector3d zhat = can.extents().col(0).normalized();
    const double off = std::pow(10, rng.uniform(-15, -1));
    const Vector3d p = can.origin() + rng.uniform(-0.04, 0.04) * zhat + off * zhat.unitOrthogonal();
    EXPECT_NEAR(distance_to_point(can, p), off - 0.1, 1e-14);
  }
}

}  // namespace
}  // namespace tandem::geometry
