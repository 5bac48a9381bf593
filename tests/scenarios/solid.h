#pragma once
/// Solids bounded by meshes, and the proof that shapes contain them.

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include "tandem/geometry/distance.h"

namespace tandem::test {

using Triangle = std::array<Eigen::Vector3d, 3>;
using Tetrahedron = std::array<Eigen::Vector3d, 4>;

/// Triangles of a binary STL file; none if it is not one.
inline std::vector<Triangle> read_binary_stl(const std::filesystem::path& file) {
  constexpr std::size_t kHeader = 84, kRecord = 50;
  std::ifstream in(file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  if (bytes.size() < kHeader) return {};
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + kHeader - sizeof(count), sizeof(count));
  if (bytes.size() != kHeader + kRecord * count) return {};
  std::vector<Triangle> triangles(count);
  for (std::size_t i = 0; i < count; ++i) {
    std::array<float, 12> values;  // Normal, then three vertices.
    std::memcpy(values.data(), bytes.data() + kHeader + kRecord * i, sizeof(values));
    for (std::size_t k = 0; k < 3; ++k) {
      triangles[i][k] =
          Eigen::Vector3f(values[3 + 3 * k], values[4 + 3 * k], values[5 + 3 * k]).cast<double>();
    }
  }
  return triangles;
}

inline double volume(const Tetrahedron& t) {
  return (t[1] - t[0]).dot((t[2] - t[0]).cross(t[3] - t[0])) / 6;
}

/// The mesh's solid as tetrahedra from its centroid; empty unless the mesh is star-shaped about it,
/// as every convex mesh is.
inline std::vector<Tetrahedron> tetrahedra(const std::vector<Triangle>& mesh) {
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  for (const Triangle& t : mesh) centroid += (t[0] + t[1] + t[2]) / (3.0 * double(mesh.size()));
  std::vector<Tetrahedron> solid;
  for (const Triangle& t : mesh) {
    solid.push_back({centroid, t[0], t[1], t[2]});
    if (volume(solid.back()) < -1e-12) return {};
  }
  return solid;
}

inline double volume(const std::vector<Tetrahedron>& solid) {
  double sum = 0;
  for (const Tetrahedron& t : solid) sum += volume(t);
  return sum;
}

/// A point of `solid` that could not be shown to lie in the union of `shapes`, by bisection of the
/// longest edge down to `resolution` [m]; none if all of it does. A convex shape contains a
/// tetrahedron whose corners it contains.
inline std::optional<Eigen::Vector3d> uncovered(const Tetrahedron& t,
                                                const std::vector<geometry::Shape>& shapes,
                                                double resolution = 1e-4) {
  for (const geometry::Shape& shape : shapes) {
    bool inside = true;
    for (const Eigen::Vector3d& p : t) {
      inside = inside && geometry::distance_to_point(shape, p) <= 0;
    }
    if (inside) return std::nullopt;
  }
  std::size_t a = 0, b = 1;
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = i + 1; j < 4; ++j) {
      if ((t[i] - t[j]).squaredNorm() > (t[a] - t[b]).squaredNorm()) a = i, b = j;
    }
  }
  const Eigen::Vector3d middle = 0.5 * (t[a] + t[b]);
  if ((t[a] - t[b]).norm() < resolution) return middle;
  Tetrahedron first = t, second = t;
  first[a] = middle;
  second[b] = middle;
  const auto found = uncovered(first, shapes, resolution);
  return found ? found : uncovered(second, shapes, resolution);
}

}  // namespace tandem::test
