#include "tandem/geometry/shape.h"

#include <gtest/gtest.h>

namespace tandem::geometry {
namespace {

using Eigen::Isometry3d, Eigen::Vector2d, Eigen::Vector3d;

TEST(Shape, RejectsWithTheValue) {
  const auto shape = Shape::sphere(Vector3d::Zero(), -0.125);
  ASSERT_FALSE(shape);
  EXPECT_EQ(shape.error().code, ErrorCode::kInvalidInput);
  EXPECT_NE(shape.error().message.find("-0.125"), std::string::npos) << shape.error().message;
}

}  // namespace
}  // namespace tandem::geometry
