#pragma once
/// Synthetic meshes whose best volumes are known, and whether volumes hold them, by sampling.

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <numbers>
#include <span>

#include "tandem/core/rng.h"
#include "tandem/geometry/mesh_file.h"
#include "tandem/geometry/shape.h"

namespace tandem::test {

using Eigen::Vector3d;
using geometry::TriangleMesh;

/// A sphere of latitudes and longitudes, every corner moved by `place`. Closed, turned outward.
inline TriangleMesh globe(const std::function<Vector3d(const Vector3d&)>& place, int rings = 24) {
  TriangleMesh mesh;
  const int sides = 2 * rings;
  mesh.vertices.push_back(place(Vector3d::UnitZ()));
  for (int i = 1; i < rings; ++i) {
    for (int k = 0; k < sides; ++k) {
      const double a = std::numbers::pi * i / rings, b = 2 * std::numbers::pi * k / sides;
      mesh.vertices.push_back(
          place({std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a)}));
    }
  }
  mesh.vertices.push_back(place(-Vector3d::UnitZ()));
  const int last = static_cast<int>(mesh.vertices.size()) - 1;
  const auto at = [&](int i, int k) { return 1 + (i - 1) * sides + k % sides; };
  for (int k = 0; k < sides; ++k) {
    mesh.triangles.push_back({0, at(1, k), at(1, k + 1)});
    mesh.triangles.push_back({last, at(rings - 1, k + 1), at(rings - 1, k)});
    for (int i = 1; i + 1 < rings; ++i) {
      mesh.triangles.push_back({at(i, k), at(i + 1, k), at(i + 1, k + 1)});
      mesh.triangles.push_back({at(i, k), at(i + 1, k + 1), at(i, k + 1)});
    }
  }
  return mesh;
}

inline TriangleMesh ball(double radius) {
  return globe([=](const Vector3d& n) -> Vector3d { return radius * n; });
}

/// About z, `length` between the centres of its caps.
inline TriangleMesh capsule_mesh(double length, double radius) {
  return globe([=](const Vector3d& n) -> Vector3d {
    return radius * n + Vector3d(0, 0, (n.z() > 1e-9 ? 0.5 : -0.5) * length);
  });
}

inline TriangleMesh box_mesh(const Vector3d& low, const Vector3d& high) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.emplace_back((i & 1 ? high : low).x(), (i & 2 ? high : low).y(),
                               (i & 4 ? high : low).z());
  }
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

inline void append(TriangleMesh& mesh, const TriangleMesh& other,
                   const Eigen::Isometry3d& X = Eigen::Isometry3d::Identity()) {
  const int first = static_cast<int>(mesh.vertices.size());
  for (const Vector3d& p : other.vertices) mesh.vertices.push_back(X * p);
  for (const auto& [a, b, c] : other.triangles) {
    mesh.triangles.push_back({first + a, first + b, first + c});
  }
}

/// Two capsules of radius 5 cm that meet in a right angle.
inline TriangleMesh elbow() {
  TriangleMesh mesh = capsule_mesh(0.3, 0.05);
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.linear() = Eigen::AngleAxisd(std::numbers::pi / 2, Vector3d::UnitY()).toRotationMatrix();
  X.translation() = Vector3d(0.15, 0, 0.15);
  append(mesh, capsule_mesh(0.3, 0.05), X);
  return mesh;
}

inline TriangleMesh moved(TriangleMesh mesh, const Eigen::Isometry3d& X) {
  for (Vector3d& p : mesh.vertices) p = X * p;
  return mesh;
}

inline Eigen::Isometry3d random_pose(Rng& rng) {
  const auto vector = [&] {
    return Vector3d(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1));
  };
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.linear() = Eigen::AngleAxisd(rng.uniform(0, 3), vector().normalized()).toRotationMatrix();
  X.translation() = 0.3 * vector();
  return X;
}

/// Distance of a point to a shape's surface or less, negative inside, from the definition of its
/// core: independent of geometry/distance.h. No triangles, no cylinders.
inline double out_of(const geometry::Shape& shape, const Vector3d& p) {
  Vector3d e = p - shape.origin();
  for (int i = 0; i < shape.size_count(); ++i) {
    const Vector3d u = shape.extents().col(i);
    e -= std::clamp(u.dot(p - shape.origin()) / u.squaredNorm(), -1.0, 1.0) * u;
  }
  return e.norm() - shape.radius();
}

/// How far the mesh sticks out of the union at most, by `count` random points of its triangles [m].
inline double sticks_out(const TriangleMesh& mesh, std::span<const geometry::Shape> volumes,
                         Rng& rng, int count = 100000) {
  double worst = -1;
  for (int i = 0; i < count; ++i) {
    const auto& t = mesh.triangles[rng.index(mesh.triangles.size())];
    double s = rng.uniform(), r = rng.uniform();
    if (s + r > 1) s = 1 - s, r = 1 - r;
    const auto at = [&](std::size_t k) { return mesh.vertices[static_cast<std::size_t>(t[k])]; };
    const Vector3d p = at(0) + s * (at(1) - at(0)) + r * (at(2) - at(0));
    double least = 1e9;
    for (const geometry::Shape& volume : volumes) least = std::min(least, out_of(volume, p));
    worst = std::max(worst, least);
  }
  return worst;
}

}  // namespace tandem::test
