#include "tandem/io/moveit_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "tandem/core/rng.h"
#include "test_data.h"
#include "workcell_files.h"

namespace tandem::io {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using geometry::CoreType;
using geometry::Shape;
using world::ObstacleSpec;

const char* const kOldFormat = R"(old kitchen
* table top
1
box
1.2 0.8 0.05
0.5 0 0.4
0 0 0.6 0.8
0.5 0.2 0 1
* cans
2
cylinder
0.03 0.14
0.5 0.1 0.5
0 0 0 1
0 0 0 0
sphere
0.04
0.4 -0.1 0.47
0 0 0 1
0 0 0 0
.
)";

const char* const kNewFormat = R"((noname)
* crate
1 2 3
0 0 0.707106781186548 0.707106781186548
2
box
0.2 0.4 0.6
0.1 0 0
0 0 0 1
0 0 0 0
mesh
4 4
0 0 0
1 0 0
0 1 0
0 0 1
0 2 1
0 1 3
0 3 2
1 2 3
0 0 0.5
0 0 0 1
0 0 0 0
1
handle
0 0 0.3
0 0 0 1
* marker
0 0 0
0 0 0 1
0
0
.
anything may follow
)";

MoveitScene parse(const std::string& text) {
  auto scene = parse_moveit_scene(text, "s.scene");
  if (!scene) throw std::runtime_error(scene.error().message);
  return *scene;
}

std::string refusal(const std::string& text) {
  const auto scene = parse_moveit_scene(text, "s.scene");
  return scene ? "" : scene.error().message;
}

Isometry3d random_pose(Rng& rng) {
  Isometry3d X = Isometry3d::Identity();
  const auto one = [&rng] { return rng.uniform(-1, 1); };
  X.linear() = Eigen::Quaterniond(one(), one(), one(), one()).normalized().toRotationMatrix();
  X.translation() = Vector3d(one(), one(), one());
  return X;
}

TEST(MoveitScene, OldFormatHasShapesInTheWorld) {
  const MoveitScene scene = parse(kOldFormat);
  EXPECT_EQ(scene.name, "old kitchen");
  ASSERT_EQ(scene.obstacles.size(), 2u);
  EXPECT_EQ(scene.obstacles[0].name, "table top");
  EXPECT_EQ(scene.obstacles[0].where, "s.scene:2:3");
  const Shape& top = scene.obstacles[0].shapes_W.at(0);
  EXPECT_NEAR((top.origin() - Vector3d(0.5, 0, 0.4)).norm(), 0, 1e-15);
  EXPECT_NEAR((top.extents().col(0) - 0.6 * Vector3d(0.28, 0.96, 0)).norm(), 0, 1e-15);
  ASSERT_EQ(scene.obstacles[1].shapes_W.size(), 2u);
  EXPECT_EQ(scene.obstacles[1].shapes_W[0].type(), CoreType::kCylinder);
  EXPECT_EQ(scene.obstacles[1].shapes_W[1].radius(), 0.04);
}

TEST(MoveitScene, NewFormatHasShapesInTheirObjects) {
  const MoveitScene scene = parse(kNewFormat);
  ASSERT_EQ(scene.obstacles.size(), 1u);  // The marker has no shape.
  const ObstacleSpec& crate = scene.obstacles[0];
  ASSERT_EQ(crate.shapes_W.size(), 1u);
  // The object is turned by a quarter about z: its x is the world's y.
  EXPECT_NEAR((crate.shapes_W[0].origin() - Vector3d(1, 2.1, 3)).norm(), 0, 1e-12);
  ASSERT_EQ(crate.surfaces_W.size(), 1u);
  const geometry::PlacedSurface& mesh = crate.surfaces_W[0];
  EXPECT_EQ(mesh.surface->vertices().size(), 4u);
  EXPECT_EQ(mesh.surface->triangles()[1], (std::array<int, 3>{0, 1, 3}));
  EXPECT_NEAR((mesh.X_FS * Vector3d(1, 0, 0) - Vector3d(1, 3, 3.5)).norm(), 0, 1e-12);
}

TEST(MoveitScene, LinesOfAnyKindAndNumbersOfAnyForm) {
  std::string text = kOldFormat;
  for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 2) {
    text.replace(at, 1, "\r\n");
  }
  EXPECT_EQ(parse(text).obstacles.size(), 2u);
  EXPECT_EQ(parse(text).name, "old kitchen");
  const MoveitScene scene = parse("n\n\n* a\n\n1\nsphere 1e-2\n-1E1 .5 0\n0 0 -0 1\n0 0 0 0\n\n.");
  EXPECT_EQ(scene.obstacles[0].shapes_W[0].origin(), Vector3d(-10, 0.5, 0));
  EXPECT_TRUE(parse("empty\n.\n").obstacles.empty());
}

TEST(MoveitScene, AConeBecomesAPyramidAroundIt) {
  const MoveitScene scene = parse("n\n\n* c\n1\ncone 0.2 0.6\n0 0 1\n0 0 0 1\n0 0 0 0\n.\n");
  const Shape& pyramid = scene.obstacles[0].shapes_W.at(0);
  EXPECT_EQ(pyramid.type(), CoreType::kConvex);
  // In every direction the cone, from its tip at z = 1.3 to its base at z = 0.7, reaches no
  // further, and a cone that is 1 % wider does.
  Rng rng(4);
  for (int i = 0; i < 2000; ++i) {
    const Vector3d d = random_pose(rng).translation().normalized();
    const auto reach = [&](double radius) {
      return std::max(1.3 * d.z(), 0.7 * d.z() + radius * std::hypot(d.x(), d.y()));
    };
    EXPECT_GE(pyramid.support(d).dot(d), reach(0.2) - 1e-12);
    EXPECT_LE(pyramid.support(d).dot(d), reach(0.202) + 1e-12);
  }
}

struct Bad {
  const char* from;
  const char* to;
  const char* says;
};

void PrintTo(const Bad& bad, std::ostream* out) { *out << bad.from << " -> " << bad.to; }

class BadScene : public ::testing::TestWithParam<Bad> {};

TEST_P(BadScene, IsRefusedWithPlaceAndReason) {
  std::string text = kNewFormat;
  const std::size_t at = text.find(GetParam().from);
  ASSERT_NE(at, std::string::npos);
  text.replace(at, std::string(GetParam().from).size(), GetParam().to);
  EXPECT_TRUE(refusal(text).starts_with(GetParam().says)) << refusal(text);
}

INSTANTIATE_TEST_SUITE_P(
    Changes, BadScene,
    ::testing::Values(
        Bad{"* crate", "crate", "s.scene:2:1: 'crate' stands where an object"},
        Bad{"* crate", "*", "s.scene:2:2: the object has no name"},
        Bad{"* marker", "* crate", "s.scene:28:3: there are two objects called 'crate'"},
        Bad{"1 2 3\n", "1 2 x\n", "s.scene:3:5: a position is 'x', expected a finite number"},
        Bad{"1 2 3\n", "1 nan 3\n", "s.scene:3:3: a position is 'nan'"},
        Bad{"1 2 3\n", "1 2 inf\n", "s.scene:3:5: a position is 'inf'"},
        Bad{"1 2 3\n", "1 2 1e999\n", "s.scene:3:5: a position is '1e999'"},
        Bad{"1 2 3\n", "1 2 3m\n", "s.scene:3:5: a position is '3m'"},
        Bad{"0 0 0.707106781186548 ", "0 0 0 ", "s.scene:4:7: the quaternion that ends here"},
        Bad{"0.2 0.4 0.6", "0.2 0 0.6", "s.scene:6:1: box: "},
        Bad{"0.2 0.4 0.6", "0.2 -0.4 0.6", "s.scene:6:1: box: "},
        Bad{"box", "plane", "s.scene:6:1: the shape 'plane' is not supported"},
        Bad{"box", "octree", "s.scene:6:1: the shape 'octree' is not supported"},
        Bad{"\n2\nbox", "\n-2\nbox", "s.scene:5:1: the number of shapes is '-2'"},
        Bad{"\n2\nbox", "\n4000000000\nbox", "s.scene:5:1: the number of shapes is '4000000000'"},
        Bad{"\n2\nbox", "\n9000000\nbox",
            "s.scene:5:1: the number of shapes is 9000000, more than"},
        Bad{"4 4\n", "4294967295 4\n", "s.scene:12:1: the number of vertices is '4294967295'"},
        Bad{"4 4\n", "9999999 4\n", "s.scene:12:1: the number of vertices is 9999999, more than"},
        Bad{"4 4\n", "4 99999999999999999999\n", "s.scene:12:3: the number of triangles is '9999"},
        Bad{"4 4\n", "4 0\n", "s.scene:19:1: the quaternion that ends here has length 3.16"},
        Bad{"1 2 3\n0 0 0.5", "1 2 4\n0 0 0.5", "s.scene:20:5: the triangle's corner 4 does not"},
        Bad{"1 2 3\n0 0 0.5", "1 2 -1\n0 0 0.5", "s.scene:20:5: an index into the vertices is '-1"},
        Bad{"handle\n", "", "s.scene:27:1: a quaternion (x, y, z, w) is '*'"},
        Bad{"\n.\n", "\n", "s.scene:33:1: 'anything' stands where an object"}));

TEST(MoveitScene, CutShortAnywhereIsRefused) {
  for (const std::string text : {kOldFormat, kNewFormat}) {
    const std::size_t end = text.find("\n.\n");
    for (std::size_t length = 0; length <= end; ++length) {
      EXPECT_NE(refusal(text.substr(0, length)), "") << length;
    }
    EXPECT_EQ(refusal(text.substr(0, end + 2)), "");
  }
}

TEST(MoveitScene, OneChangedByteIsReadOrRefusedButNeverFatal) {
  Rng rng(5);
  int refused = 0;
  for (int i = 0; i < 2000; ++i) {
    std::string text = i % 2 ? kOldFormat : kNewFormat;
    text[rng.index(text.size())] = static_cast<char>(rng.index(256));
    refused += !parse_moveit_scene(text, "s.scene");
  }
  EXPECT_GT(refused, 500);
}

TEST(MoveitScene, FilesThatCannotBeRead) {
  const test::TemporaryFolder folder;
  const auto missing = load_moveit_scene(folder / "none.scene");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::kNotFound);
  EXPECT_EQ(load_moveit_scene(folder / "").error().code, ErrorCode::kIo);
  const auto empty = load_moveit_scene(folder.write("e.scene", ""));
  ASSERT_FALSE(empty);
  EXPECT_NE(empty.error().message.find("e.scene:1:1: the file ends"), std::string::npos);
}

/// Whether p lies in the shape, straight from the definition of its core.
bool contains(const Shape& shape, const Vector3d& p, double slack) {
  const Vector3d d = p - shape.origin();
  Vector3d rest = d;
  if (shape.type() == CoreType::kTriangle) return false;
  for (int i = 0; i < shape.size_count(); ++i) {
    const Vector3d u = shape.extents().col(i);
    if (u.isZero(0)) continue;
    rest -= std::clamp(d.dot(u) / u.squaredNorm(), -1.0, 1.0) * u;
  }
  if (shape.type() == CoreType::kCylinder) {
    const Vector3d axis = shape.extents().col(0).normalized();
    const Vector3d across = d - d.dot(axis) * axis;
    const double most = std::min(across.norm(), shape.core_radius());
    if (across.norm() > 0) rest -= most * across.normalized();
  }
  return rest.norm() <= shape.radius() + slack;
}

bool any_contains(const std::vector<Shape>& shapes, const Vector3d& p, double slack) {
  return std::ranges::any_of(shapes, [&](const Shape& s) { return contains(s, p, slack); });
}

// What is written holds the same points, for shapes that MoveIt has and for those composed.
TEST(MoveitSceneText, HoldsTheSamePointsWhenReadBack) {
  Rng rng(8);
  for (int round = 0; round < 60; ++round) {
    const Isometry3d X = random_pose(rng);
    const Vector3d p = random_pose(rng).translation(), q = random_pose(rng).translation();
    const auto size = [&rng] { return rng.uniform(0.05, 0.8); };
    const std::vector<Shape> shapes{*Shape::sphere(p, size()),
                                    *Shape::capsule(p, q, size()),
                                    *Shape::capsule(p, p, size()),
                                    *Shape::box(X, {size(), size(), size()}),
                                    *Shape::box(X, {size(), size(), size()}, 0.2),
                                    *Shape::rounded_rectangle(X, {size(), size()}, 0.15),
                                    *Shape::cylinder(X, size(), size())};
    for (const Shape& shape : shapes) {
      const auto written = moveit_scene_text("n", {{"o", {shape}}});
      ASSERT_TRUE(written) << written.error().message;
      EXPECT_TRUE(written->notes.empty());
      const MoveitScene scene = parse(written->text);
      ASSERT_EQ(scene.obstacles.size(), 1u);
      int inside = 0;
      for (int i = 0; i < 400; ++i) {
        Vector3d point = shape.origin();
        for (int k = 0; k < 3; ++k) point += rng.uniform(-1.2, 1.2) * shape.extents().col(k);
        point += (shape.radius() + shape.core_radius()) * random_pose(rng).translation();
        const bool before = contains(shape, point, 1e-12);
        inside += before;
        // Rounding may move the surface by a few ulp.
        EXPECT_TRUE(!before || any_contains(scene.obstacles[0].shapes_W, point, 1e-9));
        EXPECT_TRUE(contains(shape, point, 1e-9) ||
                    !any_contains(scene.obstacles[0].shapes_W, point, 1e-12))
            << geometry::to_string(shape.type()) << " " << shape.radius();
      }
      EXPECT_GT(inside, 5);
    }
  }
}

TEST(MoveitSceneText, ReadsBackTheSameNumbers) {
  Rng rng(9);
  Isometry3d X = Isometry3d::Identity();
  std::vector<ObstacleSpec> obstacles;
  for (int i = 0; i < 50; ++i) {
    X.translation() = random_pose(rng).translation() * std::pow(10.0, rng.uniform(-6, 6));
    const double size = rng.uniform(0.01, 1);
    obstacles.push_back({std::string("o").append(std::to_string(i)),
                         {*Shape::box(X, {size, 1, 2}), *Shape::sphere(X.translation(), size)}});
  }
  const auto written = moveit_scene_text("many things", obstacles);
  ASSERT_TRUE(written);
  const MoveitScene scene = parse(written->text);
  EXPECT_EQ(scene.name, "many things");
  ASSERT_EQ(scene.obstacles.size(), obstacles.size());
  for (std::size_t i = 0; i < obstacles.size(); ++i) {
    EXPECT_EQ(scene.obstacles[i].name, obstacles[i].name);
    const Shape& before = obstacles[i].shapes_W[0];
    const Shape& after = scene.obstacles[i].shapes_W[0];
    EXPECT_EQ(after.origin(), before.origin());
    EXPECT_EQ(after.extents(), before.extents());
  }
  EXPECT_EQ(moveit_scene_text("many things", scene.obstacles)->text, written->text);
}

/// By the divergence theorem, so faces that look in count against it.
double volume(const geometry::PlacedSurface& mesh) {
  double volume = 0;
  const auto at = [&](int i) { return mesh.surface->vertices()[static_cast<std::size_t>(i)]; };
  for (const auto& [a, b, c] : mesh.surface->triangles()) {
    volume += at(a).dot(at(b).cross(at(c))) / 6;
  }
  return volume;
}

TEST(MoveitSceneText, TrianglesAreRoundedPrisms) {
  const auto triangle = Shape::rounded_triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0.1);
  const MoveitScene scene = parse(moveit_scene_text("n", {{"t", {*triangle}}})->text);
  EXPECT_EQ(scene.obstacles[0].shapes_W.size(), 6u);  // Three balls, three cylinders.
  ASSERT_EQ(scene.obstacles[0].surfaces_W.size(), 1u);
  const geometry::PlacedSurface& prism = scene.obstacles[0].surfaces_W[0];
  EXPECT_NEAR(volume(prism), 0.1, 1e-12);  // Half a square of thickness 0.2.
}

TEST(MoveitSceneText, PolytopesAreMeshesAndRoundedOnesHaveRoundEdges) {
  const std::vector<Vector3d> corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const MoveitScene sharp = parse(moveit_scene_text("n", {{"t", {*Shape::convex(corners)}}})->text);
  EXPECT_TRUE(sharp.obstacles[0].shapes_W.empty());
  ASSERT_EQ(sharp.obstacles[0].surfaces_W.size(), 1u);
  EXPECT_NEAR(volume(sharp.obstacles[0].surfaces_W[0]), 1 / 6.0, 1e-12);
  const MoveitScene rounded =
      parse(moveit_scene_text("n", {{"t", {*Shape::convex(corners, 0.1)}}})->text);
  EXPECT_EQ(rounded.obstacles[0].shapes_W.size(), 4u + 6u);  // Corners and edges.
  // The prisms over the faces count in full, once within the core and once outside.
  const double faces = 3 * 0.5 + std::sqrt(3.0) / 2;
  EXPECT_NEAR(volume(rounded.obstacles[0].surfaces_W.at(0)), 1 / 6.0 + 0.2 * faces, 1e-12);
}

TEST(MoveitSceneText, SurfacesAreMeshesAndCloudsAreBalls) {
  const MoveitScene original = parse(kNewFormat);
  const auto written = moveit_scene_text("n", original.obstacles);
  ASSERT_TRUE(written);
  const MoveitScene scene = parse(written->text);
  const auto& before = original.obstacles[0].surfaces_W[0];
  const auto& after = scene.obstacles[0].surfaces_W.at(0);
  EXPECT_EQ(after.surface->vertices(), before.surface->vertices());
  EXPECT_EQ(after.surface->triangles(), before.surface->triangles());
  EXPECT_TRUE(after.X_FS.isApprox(before.X_FS, 1e-12));
  ObstacleSpec cloud{"cloud", {}};
  cloud.surfaces_W = {{*geometry::Surface::cloud({{0, 0, 0}, {1, 2, 3}}, 0.05), before.X_FS}};
  const MoveitScene balls = parse(moveit_scene_text("n", {cloud})->text);
  ASSERT_EQ(balls.obstacles[0].shapes_W.size(), 2u);
  EXPECT_EQ(balls.obstacles[0].shapes_W[1].radius(), 0.05);
}

TEST(MoveitSceneText, SaysWhatItChanged) {
  const Isometry3d X = Isometry3d::Identity();
  const auto written = moveit_scene_text("n", {{"can", {*Shape::cylinder(X, 0.1, 0.3, 0.02)}}});
  ASSERT_TRUE(written);
  EXPECT_EQ(written->notes, std::vector<std::string>{
                                "can: a rounded cylinder is exported as the cylinder around it"});
  const Shape can = parse(written->text).obstacles[0].shapes_W[0];
  EXPECT_NEAR(can.core_radius(), 0.12, 1e-15);
  EXPECT_NEAR(2 * can.extents().col(0).norm(), 0.34, 1e-15);
  for (const char* name : {"", "two\nlines", " space", "space "}) {
    EXPECT_FALSE(moveit_scene_text("n", {{name, {can}}})) << name;
  }
  EXPECT_FALSE(moveit_scene_text("", {}));
}

}  // namespace
}  // namespace tandem::io
