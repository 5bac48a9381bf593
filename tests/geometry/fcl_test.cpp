// Distances against FCL, where FCL is trustworthy: convex shapes that are well apart.

#include <fcl/fcl.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "random_shapes.h"
#include "tandem/geometry/distance.h"

namespace tandem::geometry {
namespace {

using Eigen::Isometry3d, Eigen::Matrix3d, Eigen::Vector3d;

/// A flat or solid convex core as a mesh of its vertices' hull.
std::shared_ptr<fcl::CollisionGeometryd> convex(const std::vector<Vector3d>& vertices,
                                                const std::vector<std::vector<int>>& faces) {
  auto flat = std::make_shared<std::vector<int>>();
  for (const auto& face : faces) {
    flat->push_back(static_cast<int>(face.size()));
    flat->insert(flat->end(), face.begin(), face.end());
  }
  return std::make_shared<fcl::Convexd>(std::make_shared<const std::vector<Vector3d>>(vertices),
                                        static_cast<int>(faces.size()), flat);
}

/// The core in FCL's terms, and its pose; capsules and spheres with their radius.
fcl::CollisionObjectd to_fcl(const Shape& shape) {
  Isometry3d X = Isometry3d::Identity();
  X.translation() = shape.origin();
  const auto& u = shape.extents();
  const Vector3d z = u.col(0).normalized(), x = z.unitOrthogonal();
  const Matrix3d along_z = (Matrix3d() << x, z.cross(x), z).finished();
  switch (shape.type()) {
    case CoreType::kPoint:
      return {std::make_shared<fcl::Sphered>(shape.radius()), X};
    case CoreType::kSegment:
      X.linear() = along_z;
      return {std::make_shared<fcl::Capsuled>(shape.radius(), 2 * u.col(0).norm()), X};
    case CoreType::kTriangle: {
      const auto v = shape.hull_vertices();
      return {convex(v, {{0, 1, 2}, {2, 1, 0}}), Isometry3d::Identity()};
    }
    case CoreType::kRectangle: {
      const Vector3d c = shape.origin(), p = u.col(0), q = u.col(1);
      return {convex({c - p - q, c + p - q, c + p + q, c - p + q}, {{0, 1, 2, 3}, {3, 2, 1, 0}}),
              Isometry3d::Identity()};
    }
    case CoreType::kBox:
      X.linear() = u.colwise().normalized();
      if (X.linear().determinant() < 0) X.linear().col(2) *= -1;
      return {std::make_shared<fcl::Boxd>(2 * u.colwise().norm().transpose()), X};
    case CoreType::kCylinder:
      X.linear() = along_z;
      return {std::make_shared<fcl::Cylinderd>(shape.core_radius(), 2 * u.col(0).norm()), X};
    case CoreType::kConvex: {
      std::vector<std::vector<int>> faces;
      for (const auto& t : shape.hull().triangles) faces.emplace_back(t.begin(), t.end());
      return {convex(shape.hull_vertices(), faces), Isometry3d::Identity()};
    }
  }
  throw std::logic_error("no such type");
}

/// How much of the shape's radius FCL's shape leaves out.
double radius_left_out(const Shape& shape) {
  const bool round = shape.type() == CoreType::kPoint || shape.type() == CoreType::kSegment;
  return round ? 0 : shape.radius();
}

class AgainstFcl : public testing::TestWithParam<std::tuple<CoreType, CoreType>> {};

TEST_P(AgainstFcl, AgreesWhereShapesAreApart) {
  const auto [type_a, type_b] = GetParam();
  Rng rng(7 + 10 * static_cast<unsigned>(type_a) + static_cast<unsigned>(type_b));
  int compared = 0, close = 0;
  for (int i = 0; i < 300; ++i) {
    const Shape a = random_shape(rng, type_a, Draw::kGeneric, 1);
    const Shape b = random_shape(rng, type_b, Draw::kGeneric, 1);
    const double distance = clearance(a, b).distance;
    if (distance < 0.02) continue;
    auto object_a = to_fcl(a), object_b = to_fcl(b);
    fcl::DistanceRequestd request;
    request.gjk_solver_type = fcl::GST_LIBCCD;
    request.distance_tolerance = 1e-7;
    fcl::DistanceResultd result;
    fcl::distance(&object_a, &object_b, request, result);
    SCOPED_TRACE(testing::Message()
                 << "case " << i << "\n  A: " << describe(a) << "\n  B: " << describe(b));
    const double theirs = result.min_distance - radius_left_out(a) - radius_left_out(b);
    // Its iteration comes from above, and with flat shapes sometimes stops early.
    EXPECT_LT(distance, theirs + 1e-6);
    EXPECT_GT(distance, theirs - 5e-4);
    close += std::abs(distance - theirs) < 1e-5;
    ++compared;
  }
  EXPECT_GT(compared, 100);
  EXPECT_GE(close, compared - 3);
}

INSTANTIATE_TEST_SUITE_P(Clearance, AgainstFcl,
                         testing::Combine(testing::ValuesIn(kCoreTypes),
                                          testing::ValuesIn(kCoreTypes)),
                         [](const auto& instance) {
                           return std::string(to_string(std::get<0>(instance.param))) + "_" +
                                  to_string(std::get<1>(instance.param));
                         });

}  // namespace
}  // namespace tandem::geometry
