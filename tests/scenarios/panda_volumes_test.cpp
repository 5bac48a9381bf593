// The swept sphere volumes of the Panda contain its meshes and its URDF geometry, tightly.

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "panda_model.h"
#include "solid.h"
#include "tandem/core/rng.h"

namespace tandem {
namespace {

using Eigen::Vector3d;
using geometry::Shape;

/// A link, its published mesh, and how much larger than the mesh its volumes may be.
struct Case {
  const char* link;
  const char* mesh;
  bool turned;  ///< By half a turn about z, as the right finger's.
  double excess;
};
const Case kCases[] = {
    {"panda_link0", "link0", false, 1.6},        {"panda_link1", "link1", false, 1.25},
    {"panda_link2", "link2", false, 1.25},       {"panda_link3", "link3", false, 1.4},
    {"panda_link4", "link4", false, 1.4},        {"panda_link5", "link5", false, 1.3},
    {"panda_link6", "link6", false, 1.4},        {"panda_link7", "link7", false, 1.75},
    {"panda_hand", "hand", false, 1.6},          {"panda_leftfinger", "finger", false, 1.45},
    {"panda_rightfinger", "finger", true, 1.45},
};
const char* const kMeshes = "robots/packages/moveit_resources_panda_description/meshes/collision/";

std::vector<test::Tetrahedron> solid_of(const Case& c) {
  auto mesh = test::read_binary_stl(test::data_path(std::string(kMeshes) + c.mesh + ".stl"));
  if (c.turned) {
    const Eigen::AngleAxisd turn(std::numbers::pi, Vector3d::UnitZ());
    for (test::Triangle& t : mesh) {
      for (Vector3d& p : t) p = turn * p;
    }
  }
  return test::tetrahedra(mesh);
}

std::vector<Shape> collision_shapes(const robot::Link& link) {
  std::vector<Shape> shapes;
  for (const robot::Geometry& g : link.collision) {
    if (const auto* box = std::get_if<robot::BoxGeometry>(&g.shape)) {
      shapes.push_back(*Shape::box(g.X_LG, box->size));
    } else if (const auto* sphere = std::get_if<robot::SphereGeometry>(&g.shape)) {
      shapes.push_back(*Shape::sphere(g.X_LG.translation(), sphere->radius));
    } else if (const auto* cylinder = std::get_if<robot::CylinderGeometry>(&g.shape)) {
      shapes.push_back(*Shape::cylinder(g.X_LG, cylinder->radius, cylinder->length));
    } else {
      ADD_FAILURE() << link.name << " has a mesh";
    }
  }
  return shapes;
}

void expect_contained(const std::vector<test::Tetrahedron>& solid, const std::vector<Shape>& shapes,
                      const char* link) {
  ASSERT_FALSE(solid.empty()) << link;
  ASSERT_FALSE(shapes.empty()) << link;
  for (const test::Tetrahedron& t : solid) {
    const auto point = test::uncovered(t, shapes);
    ASSERT_FALSE(point) << link << ": not covered near " << point->transpose();
  }
}

TEST(PandaVolumes, ContainThePublishedMeshes) {
  TANDEM_SKIP_WITHOUT_DATA(kMeshes);
  const test::Panda panda;
  for (const Case& c : kCases) expect_contained(solid_of(c), panda.volumes.at(c.link), c.link);
}

TEST(PandaVolumes, UrdfGeometryContainsThePublishedMeshes) {
  TANDEM_SKIP_WITHOUT_DATA(kMeshes);
  const test::Panda panda;
  for (const Case& c : kCases) {
    expect_contained(solid_of(c), collision_shapes(panda.link(c.link)), c.link);
  }
}

TEST(PandaVolumes, ContainmentTestNoticesWhatSticksOut) {
  TANDEM_SKIP_WITHOUT_DATA(kMeshes);
  const test::Panda panda;
  for (const Case& c : kCases) {
    std::vector<Shape> smaller = panda.volumes.at(c.link);
    for (Shape& shape : smaller) {
      shape = shape.type() == geometry::CoreType::kBox
                  ? *Shape::box(Eigen::Isometry3d(Eigen::Translation3d(shape.origin())),
                                2 * shape.extents().diagonal() - Vector3d::Constant(2e-3))
                  : shape.padded(-1e-3);
    }
    bool found = false;
    for (const test::Tetrahedron& t : solid_of(c)) found = found || test::uncovered(t, smaller);
    EXPECT_TRUE(found) << c.link;
  }
}

/// Corners of a polytope around a primitive: what holds them all holds the primitive.
std::vector<Vector3d> corners_around(const Shape& primitive) {
  if (primitive.type() != geometry::CoreType::kCylinder) return primitive.hull_vertices();
  constexpr int kSides = 360;
  const Vector3d axis = primitive.extents().col(0);
  const Vector3d x = axis.unitOrthogonal(), y = axis.normalized().cross(x);
  const double radius = primitive.core_radius() / std::cos(std::numbers::pi / kSides);
  std::vector<Vector3d> corners;
  for (int i = 0; i < kSides; ++i) {
    const double angle = 2 * std::numbers::pi * i / kSides;
    const Vector3d rim = radius * (std::cos(angle) * x + std::sin(angle) * y);
    corners.push_back(primitive.origin() + axis + rim);
    corners.push_back(primitive.origin() - axis + rim);
  }
  return corners;
}

bool contains(const Shape& shape, const Shape& primitive) {
  for (const Vector3d& p : corners_around(primitive)) {
    if (geometry::distance_to_point(shape, p) + primitive.radius() > 0) return false;
  }
  return true;
}

TEST(PandaVolumes, ContainTheUrdfGeometry) {
  const test::Panda panda;
  for (const Case& c : kCases) {
    const std::vector<Shape>& volumes = panda.volumes.at(c.link);
    const std::vector<Shape> primitives = collision_shapes(panda.link(c.link));
    EXPECT_FALSE(primitives.empty()) << c.link;
    for (std::size_t i = 0; i < primitives.size(); ++i) {
      const bool held = std::any_of(volumes.begin(), volumes.end(), [&](const Shape& volume) {
        return contains(volume, primitives[i]);
      });
      EXPECT_TRUE(held) << c.link << ": collision element " << i << " sticks out";
    }
  }
}

TEST(PandaVolumes, EveryLinkWithGeometryHasVolumes) {
  const test::Panda panda;
  for (const robot::Link& link : panda.model.links()) {
    EXPECT_EQ(link.collision.empty(), !panda.volumes.contains(link.name)) << link.name;
    EXPECT_EQ(link.collision.size(), link.visual.size()) << link.name;
  }
}

/// Volume of a union of shapes by uniform samples [m^3].
double union_volume(const std::vector<Shape>& shapes, Rng& rng) {
  Vector3d low = Vector3d::Constant(1), high = -low;
  for (const Shape& shape : shapes) {
    for (const Vector3d& p : shape.hull_vertices()) {
      low = low.cwiseMin(p - Vector3d::Constant(shape.radius()));
      high = high.cwiseMax(p + Vector3d::Constant(shape.radius()));
    }
  }
  constexpr int kSamples = 100000;
  int inside = 0;
  for (int i = 0; i < kSamples; ++i) {
    const Vector3d p(rng.uniform(low.x(), high.x()), rng.uniform(low.y(), high.y()),
                     rng.uniform(low.z(), high.z()));
    inside += std::any_of(shapes.begin(), shapes.end(), [&](const Shape& shape) {
      return geometry::distance_to_point(shape, p) <= 0;
    });
  }
  return (high - low).prod() * inside / kSamples;
}

TEST(PandaVolumes, AddLittleToTheMeshes) {
  TANDEM_SKIP_WITHOUT_DATA(kMeshes);
  const test::Panda panda;
  Rng rng(7);
  for (const Case& c : kCases) {
    const double ratio = union_volume(panda.volumes.at(c.link), rng) / test::volume(solid_of(c));
    std::printf("%-18s %.2f times the mesh's volume\n", c.link, ratio);
    EXPECT_GT(ratio, 1.0) << c.link;
    EXPECT_LT(ratio, c.excess) << c.link;
  }
}

}  // namespace
}  // namespace tandem
