#include "tandem/geometry/surface.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "random_shapes.h"
#include "tandem/core/contract.h"
#include "tandem/geometry/distance.h"

namespace tandem::geometry {
namespace {

using Eigen::Isometry3d, Eigen::Vector3d;

struct Mesh {
  std::vector<Vector3d> vertices;
  std::vector<std::array<int, 3>> triangles;

  void add(const Mesh& other) {
    const int first = static_cast<int>(vertices.size());
    vertices.insert(vertices.end(), other.vertices.begin(), other.vertices.end());
    for (const auto& [i, j, k] : other.triangles) {
      triangles.push_back({first + i, first + j, first + k});
    }
  }
  Mesh turned_inside_out() const {
    Mesh mesh = *this;
    for (auto& t : mesh.triangles) std::swap(t[0], t[1]);
    return mesh;
  }
};

Mesh box_mesh(const Isometry3d& X, const Vector3d& size) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    const Vector3d corner(i & 1 ? 0.5 : -0.5, i & 2 ? 0.5 : -0.5, i & 4 ? 0.5 : -0.5);
    mesh.vertices.push_back(X * corner.cwiseProduct(size));
  }
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

/// A torus around z: not convex, and seen by a ray up to four times.
Mesh torus(double ring, double tube, int count) {
  Mesh mesh;
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j < count; ++j) {
      const double a = 2 * std::numbers::pi * i / count, b = 2 * std::numbers::pi * j / count;
      const double r = ring + tube * std::cos(b);
      mesh.vertices.emplace_back(r * std::cos(a), r * std::sin(a), tube * std::sin(b));
      const auto at = [&](int k, int l) { return (k % count) * count + l % count; };
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

std::shared_ptr<const Surface> surface_of(const Mesh& mesh, double radius = 0) {
  auto surface = Surface::mesh(mesh.vertices, mesh.triangles, radius);
  EXPECT_TRUE(surface) << surface.error().message;
  return *surface;
}

/// The generalised winding number, by the triangles' solid angles.
/// Ref: van Oosterom, Strackee, The solid angle of a plane triangle (1983).
double winding_number(const Mesh& mesh, const Vector3d& p) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    const auto at = [&](std::size_t k) {
      return Vector3d(mesh.vertices[static_cast<std::size_t>(t[k])] - p);
    };
    const Vector3d a = at(0), b = at(1), c = at(2);
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    sum += 2 * std::atan2(a.dot(b.cross(c)),
                          la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return sum / (4 * std::numbers::pi);
}

TEST(Surface, RefusesWithTheOffendingValue) {
  const std::vector<Vector3d> v{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const auto expect_refused = [](const auto& surface, const std::string& part) {
    ASSERT_FALSE(surface) << part;
    EXPECT_EQ(surface.error().code, ErrorCode::kInvalidInput);
    EXPECT_NE(surface.error().message.find(part), std::string::npos) << surface.error().message;
  };
  expect_refused(Surface::mesh(v, {{0, 1, 3}}), "triangle 0 has the vertex 3");
  expect_refused(Surface::mesh(v, {{0, 1, 2}, {0, -1, 2}}), "triangle 1 has the vertex -1");
  expect_refused(Surface::mesh(v, {{0, 1, 2}}, -1), "radius is -1");
  expect_refused(Surface::mesh(v, {{0, 1, 1}}), "area");
  expect_refused(Surface::mesh(v, {}), "area");
  expect_refused(Surface::mesh({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}), "area");
  expect_refused(Surface::mesh({{0, 0, 0}, {1, 0, NAN}, {2, 0, 0}}, {{0, 1, 2}}), "vertex 1");
  expect_refused(Surface::cloud({}, 1), "no points");
  expect_refused(Surface::cloud(v, 0), "radius is 0");
  expect_refused(Surface::cloud(v, NAN), "radius");
  expect_refused(Surface::cloud({{0, INFINITY, 0}}, 1), "vertex 0");
}

TEST(Surface, IsMadeOfItsPieces) {
  const Mesh box = box_mesh(Isometry3d::Identity(), {1, 2, 3});
  const auto thin = surface_of(box);
  ASSERT_EQ(thin->piece_count(), 12);
  const Shape piece = thin->piece(0);
  EXPECT_EQ(piece.type(), CoreType::kTriangle);
  EXPECT_EQ(piece.radius(), 0);
  for (const Vector3d& v : piece.hull_vertices()) EXPECT_DOUBLE_EQ(v.z(), -1.5);
  EXPECT_DOUBLE_EQ(distance(piece, *Shape::sphere({0, 0, -3}, 0.25)), 1.25);
  EXPECT_DOUBLE_EQ(surface_of(box, 0.1)->piece(3, 0.25).radius(), 0.35);
  EXPECT_THROW(thin->piece(0, -0.1), ContractViolation);
  EXPECT_THROW(thin->piece(12), ContractViolation);
  const auto cloud = *Surface::cloud({{1, 2, 3}, {4, 5, 6}}, 0.5);
  EXPECT_FALSE(cloud->is_mesh());
  EXPECT_FALSE(cloud->is_closed());
  EXPECT_FALSE(cloud->contains({1, 2, 3}));
  EXPECT_EQ(cloud->piece_count(), 2);
  EXPECT_EQ(cloud->piece(1, 0.25).radius(), 0.75);
  EXPECT_EQ(cloud->piece(1).origin(), Vector3d(4, 5, 6));
}

TEST(Surface, IsClosedOnlyWithATriangleOnEitherSideOfEveryEdge) {
  const Mesh box = box_mesh(Isometry3d::Identity(), {1, 1, 1});
  EXPECT_TRUE(surface_of(box)->is_closed());
  EXPECT_TRUE(surface_of(box.turned_inside_out())->is_closed());
  Mesh open = box;
  open.triangles.pop_back();
  EXPECT_FALSE(surface_of(open)->is_closed());
  EXPECT_FALSE(surface_of(open)->contains(Vector3d::Zero()));
  Mesh twisted = box;
  std::swap(twisted.triangles[4][0], twisted.triangles[4][1]);
  EXPECT_FALSE(surface_of(twisted)->is_closed());
  Mesh doubled = box;
  doubled.triangles.push_back(box.triangles[0]);
  EXPECT_FALSE(surface_of(doubled)->is_closed());
  Mesh soup;  // As in a STL: every triangle with vertices of its own.
  for (const auto& t : box.triangles) {
    Mesh one{{}, {{0, 1, 2}}};
    for (const int i : t) one.vertices.push_back(box.vertices[static_cast<std::size_t>(i)]);
    soup.add(one);
  }
  soup.triangles.push_back({0, 0, 1});  // Without area: left out.
  EXPECT_TRUE(surface_of(soup)->is_closed());
  EXPECT_EQ(surface_of(soup)->piece_count(), 12);
  EXPECT_TRUE(surface_of(soup)->contains(Vector3d::Zero()));
}

TEST(Surface, ContainsWhatTheWindingNumberSays) {
  Rng rng(61);
  Mesh mesh = torus(1, 0.4, 24);
  mesh.add(box_mesh(random_pose(rng, 0.1), {0.7, 0.8, 0.9}));
  const Isometry3d X = random_pose(rng, 0.02);
  mesh.add(box_mesh(X, {0.2, 0.2, 0.2}).turned_inside_out());  // A cavity.
  const auto surface = surface_of(mesh);
  ASSERT_TRUE(surface->is_closed());
  int inside = 0;
  for (int i = 0; i < 6000; ++i) {
    const Vector3d p = random_point(rng, i % 2 == 0 ? 1.5 : 0.3);
    const bool expected = std::abs(std::round(winding_number(mesh, p))) != 0;
    inside += expected;
    ASSERT_EQ(surface->contains(p), expected) << p.transpose();
  }
  EXPECT_GT(inside, 600);
  EXPECT_FALSE(surface->contains(X * Vector3d::Zero()));
}

TEST(Surface, ContainsIsNotFooledWhereRaysGraze) {
  Rng rng(62);
  // All coordinates on a grid: rays of any usual direction would run in faces and along edges.
  Mesh mesh;
  for (int i = 0; i < 40; ++i) {
    Isometry3d X = Isometry3d::Identity();
    X.translation() = 3 * Vector3d(i % 4, (i / 4) % 4, i / 16);
    mesh.add(box_mesh(X, {2, 2, 2}));
  }
  const auto surface = surface_of(mesh);
  for (int i = 0; i < 20000; ++i) {
    const auto pick = [&] { return 0.5 * static_cast<double>(rng.index(26)) - 1.75; };
    const Vector3d p(pick(), pick(), pick());
    bool expected = false;
    for (int k = 0; k < 40; ++k) {
      const Vector3d c = 3 * Vector3d(k % 4, (k / 4) % 4, k / 16);
      expected |= (p - c).cwiseAbs().maxCoeff() < 1;
    }
    ASSERT_EQ(surface->contains(p), expected) << p.transpose();
  }
  // Straight below vertices, edges and slivers along the ray itself, found through the library's
  // answer for ever finer steps: it changes once.
  const auto ring = surface_of(torus(1, 0.4, 64));
  for (const Vector3d& v : ring->vertices()) {
    const Vector3d middle(v.x() / v.head<2>().norm(), v.y() / v.head<2>().norm(), 0);
    EXPECT_TRUE(ring->contains(middle + (1 - 1e-6) * (v - middle)));
    EXPECT_FALSE(ring->contains(middle + (1 + 1e-12) * (v - middle)));
  }
}

}  // namespace
}  // namespace tandem::geometry
