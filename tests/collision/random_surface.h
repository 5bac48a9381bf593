#pragma once
/// Random triangle meshes and point clouds, for tests of collision checks.

#include <cmath>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "tandem/core/rng.h"
#include "tandem/geometry/surface.h"

namespace tandem::test {

using SurfacePtr = std::shared_ptr<const geometry::Surface>;

inline SurfacePtr make_mesh(std::vector<Eigen::Vector3d> vertices,
                            std::vector<std::array<int, 3>> triangles, double radius = 0) {
  auto mesh = geometry::Surface::mesh(std::move(vertices), std::move(triangles), radius);
  if (!mesh) throw std::runtime_error(mesh.error().message);
  return *mesh;
}

/// A closed mesh of 2 * segments * (rings - 1) triangles, a bumpy ball about the origin.
inline SurfacePtr random_blob(Rng& rng, int rings, int segments, double size, double radius = 0) {
  std::vector<Eigen::Vector3d> vertices{Eigen::Vector3d(0, 0, size)};
  for (int i = 1; i < rings; ++i) {
    for (int k = 0; k < segments; ++k) {
      const double polar = std::numbers::pi * i / rings;
      const double azimuth = 2 * std::numbers::pi * k / segments;
      vertices.push_back(rng.uniform(0.7, 1.0) * size *
                         Eigen::Vector3d(std::sin(polar) * std::cos(azimuth),
                                         std::sin(polar) * std::sin(azimuth), std::cos(polar)));
    }
  }
  vertices.emplace_back(0, 0, -size);
  const int south = static_cast<int>(vertices.size()) - 1;
  std::vector<std::array<int, 3>> triangles;
  for (int k = 0; k < segments; ++k) {
    const int next = (k + 1) % segments;
    triangles.push_back({0, 1 + k, 1 + next});
    for (int i = 1; i + 1 < rings; ++i) {
      const int row = 1 + (i - 1) * segments, below = row + segments;
      triangles.push_back({row + k, below + k, below + next});
      triangles.push_back({row + k, below + next, row + next});
    }
    const int last = 1 + (rings - 2) * segments;
    triangles.push_back({last + k, south, last + next});
  }
  return make_mesh(std::move(vertices), std::move(triangles), radius);
}

/// An open mesh: a wavy sheet of 2 n^2 triangles, `size` wide, about the origin of its xy plane.
inline SurfacePtr random_sheet(Rng& rng, int n, double size, double height, double radius = 0) {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<int, 3>> triangles;
  for (int i = 0; i <= n; ++i) {
    for (int k = 0; k <= n; ++k) {
      const double x = size * (1.0 * i / n - 0.5), y = size * (1.0 * k / n - 0.5);
      const double wave = std::sin(7 * x / size) * std::cos(9 * y / size);
      vertices.emplace_back(x, y, height * (wave + rng.uniform(-1.0, 1.0) / n));
      if (i == n || k == n) continue;
      const int v = i * (n + 1) + k;
      triangles.push_back({v, v + n + 1, v + n + 2});
      triangles.push_back({v, v + n + 2, v + 1});
    }
  }
  return make_mesh(std::move(vertices), std::move(triangles), radius);
}

/// A box of 12 triangles, closed, about the origin.
inline SurfacePtr box_mesh(const Eigen::Vector3d& size, double radius = 0) {
  std::vector<Eigen::Vector3d> vertices;
  for (int i = 0; i < 8; ++i) {
    vertices.push_back(
        0.5 * size.cwiseProduct(Eigen::Vector3d(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1)));
  }
  return make_mesh(std::move(vertices),
                   {{0, 2, 3},
                    {0, 3, 1},
                    {4, 5, 7},
                    {4, 7, 6},
                    {0, 1, 5},
                    {0, 5, 4},
                    {2, 6, 7},
                    {2, 7, 3},
                    {0, 4, 6},
                    {0, 6, 2},
                    {1, 3, 7},
                    {1, 7, 5}},
                   radius);
}

/// Points on a bumpy ball about the origin.
inline SurfacePtr random_cloud(Rng& rng, int count, double size, double radius) {
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d p(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1));
    points.push_back(rng.uniform(0.8, 1.0) * size * p.normalized());
  }
  auto cloud = geometry::Surface::cloud(std::move(points), radius);
  if (!cloud) throw std::runtime_error(cloud.error().message);
  return *cloud;
}

/// Any of the above, of up to about `most` pieces.
inline SurfacePtr random_surface(Rng& rng, double size, int most) {
  const double radius = rng.index(2) == 0 ? 0.0 : rng.uniform(0, 0.02);
  const double few = std::sqrt(rng.uniform(6.0, most));
  switch (rng.index(4)) {
    case 0:
      return box_mesh(size * Eigen::Vector3d(rng.uniform(0.5, 1.5), rng.uniform(0.5, 1.5),
                                             rng.uniform(0.5, 1.5)),
                      radius);
    case 1:
      return random_blob(rng, 2 + static_cast<int>(few / 2), 3 + static_cast<int>(few / 2), size,
                         radius);
    case 2:
      return random_sheet(rng, 1 + static_cast<int>(few / 1.5), 2 * size, 0.2 * size, radius);
    default:
      return random_cloud(rng, static_cast<int>(few * few), size, 0.01 + radius);
  }
}

}  // namespace tandem::test
