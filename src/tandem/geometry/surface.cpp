#include "tandem/geometry/surface.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <tuple>
#include <utility>

#include "tandem/core/contract.h"
#include "tandem/geometry/magnitude.h"
#include "tandem/geometry/polytope.h"

namespace tandem::geometry {

using Eigen::Vector3d;

namespace {

using Triangles = std::vector<std::array<int, 3>>;

const Vector3d& at(const std::vector<Vector3d>& vertices, int i) {
  return vertices[static_cast<std::size_t>(i)];
}

/// @return what is wrong with the arguments, or nothing.
std::string complaint_of(const std::vector<Vector3d>& vertices, double radius) {
  if (!(radius >= 0 && radius <= detail::kLargest)) {
    return "radius is " + std::to_string(radius) + ", must be finite and >= 0, at most 1e50 m";
  }
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    if (!vertices[i].allFinite()) return "vertex " + std::to_string(i) + " is not finite";
    if (vertices[i].cwiseAbs().maxCoeff() > detail::kLargest) {
      return "vertex " + std::to_string(i) + " is beyond 1e50 m";
    }
  }
  return {};
}

bool has_area(const std::vector<Vector3d>& vertices, const std::array<int, 3>& triangle) {
  const auto& [i, j, k] = triangle;
  const Vector3d& p = at(vertices, i);
  return detail::accurate_cross(at(vertices, j) - p, at(vertices, k) - p).squaredNorm() > 0;
}

/// The triangles with one index for all vertices at one place, without those that two of their
/// vertices collapse: what decides whether a mesh is closed.
Triangles joined(const std::vector<Vector3d>& vertices, const Triangles& triangles) {
  std::vector<std::size_t> order(vertices.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto key = [&](std::size_t i) {
    return std::tuple(vertices[i].x(), vertices[i].y(), vertices[i].z());
  };
  std::ranges::sort(order, [&](std::size_t i, std::size_t j) { return key(i) < key(j); });
  std::vector<int> one(vertices.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    const bool same = k > 0 && vertices[order[k]] == vertices[order[k - 1]];
    one[order[k]] = same ? one[order[k - 1]] : static_cast<int>(order[k]);
  }
  Triangles result;
  for (std::array<int, 3> triangle : triangles) {
    for (int& i : triangle) i = one[static_cast<std::size_t>(i)];
    const auto [i, j, k] = triangle;
    if (i != j && j != k && k != i) result.push_back(triangle);
  }
  return result;
}

/// Whether every edge is run through once in either direction.
bool closes(const Triangles& triangles) {
  std::vector<std::pair<int, int>> edges, reversed;
  for (const auto& triangle : triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      edges.emplace_back(triangle[k], triangle[(k + 1) % 3]);
      reversed.emplace_back(triangle[(k + 1) % 3], triangle[k]);
    }
  }
  std::ranges::sort(edges);
  std::ranges::sort(reversed);
  return edges == reversed && std::ranges::adjacent_find(edges) == edges.end();
}

BoundingTree::Sphere sphere_around(const Vector3d& p, const Vector3d& q, const Vector3d& r) {
  constexpr double kRounding = 1e-12;  // [-] The line's distance to the centre is rounded too.
  const Vector3d center = (p + q + r) / 3;
  const double square = std::max(
      {(p - center).squaredNorm(), (q - center).squaredNorm(), (r - center).squaredNorm()});
  return {center, std::sqrt(square) + kRounding * (1 + center.norm())};
}

/// Axes whose third one is parallel to nothing that people model.
const Eigen::Matrix3d& oblique_axes() {
  static const Eigen::Matrix3d kAxes =
      Eigen::Quaterniond(0.3819660113, 0.5772156649, -0.2718281828, 0.6180339887)
          .normalized()
          .toRotationMatrix();
  return kAxes;
}

/// Sign of x_a y_b - y_a x_b without error (but for underflow).
int orientation(const Vector3d& a, const Vector3d& b) {
  const double left = a.x() * b.y(), right = a.y() * b.x();
  if (left != right) return left > right ? 1 : -1;
  const double rest = std::fma(a.x(), b.y(), -left) - std::fma(a.y(), b.x(), -right);
  return rest > 0 ? 1 : rest < 0 ? -1 : 0;
}

/// How often the line along z winds through a triangle (1, -1 or 0) whose corners are given from a
/// point on it. The rule for edges is the same from either side, so that no line slips through
/// between neighbours.
int winding(const std::array<Vector3d, 3>& corners) {
  int turns = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector3d &a = corners[k], &b = corners[(k + 1) % 3];
    const bool above_a = a.y() > 0, above_b = b.y() > 0;
    if (!above_a && above_b && orientation(a, b) > 0) ++turns;
    if (above_a && !above_b && orientation(a, b) < 0) --turns;
  }
  return turns;
}

/// Whether the line along z passes a triangle, which it winds through, on its positive side.
bool is_ahead(const std::array<Vector3d, 3>& c, int turns) {
  if (c[0].z() > 0 && c[1].z() > 0 && c[2].z() > 0) return true;
  if (c[0].z() <= 0 && c[1].z() <= 0 && c[2].z() <= 0) return false;
  return turns * c[0].dot(detail::accurate_cross(c[1] - c[0], c[2] - c[0])) > 0;
}

}  // namespace

Result<std::shared_ptr<const Surface>> Surface::mesh(std::vector<Vector3d> vertices_S,
                                                     std::vector<std::array<int, 3>> triangles,
                                                     double radius) {
  const auto refuse = [](const std::string& what) {
    return fail(ErrorCode::kInvalidInput, "mesh: " + what);
  };
  const std::string complaint = complaint_of(vertices_S, radius);
  if (!complaint.empty()) return refuse(complaint);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (const int i : triangles[t]) {
      if (i >= 0 && static_cast<std::size_t>(i) < vertices_S.size()) continue;
      return refuse("triangle " + std::to_string(t) + " has the vertex " + std::to_string(i) +
                    ", but there are " + std::to_string(vertices_S.size()));
    }
  }
  std::shared_ptr<Surface> surface(new Surface);
  surface->radius_ = radius;
  if (Triangles all = joined(vertices_S, triangles); closes(all)) surface->solid_ = std::move(all);
  std::erase_if(triangles, [&](const auto& triangle) { return !has_area(vertices_S, triangle); });
  if (triangles.empty()) return refuse("no triangle has an area");
  surface->vertices_ = std::move(vertices_S);
  surface->triangles_ = std::move(triangles);
  std::vector<BoundingTree::Sphere> spheres;
  for (const auto& [i, j, k] : surface->solid_) {
    const auto& v = surface->vertices_;
    spheres.push_back(sphere_around(at(v, i), at(v, j), at(v, k)));
  }
  constexpr int kLeafSize = 4;
  if (!spheres.empty()) surface->solid_tree_ = BoundingTree(spheres, kLeafSize);
  return surface;
}

Result<std::shared_ptr<const Surface>> Surface::cloud(std::vector<Vector3d> points_S,
                                                      double radius) {
  std::string complaint = complaint_of(points_S, radius);
  if (complaint.empty() && radius == 0) complaint = "radius is 0, must be > 0";
  if (complaint.empty() && points_S.empty()) complaint = "no points";
  if (!complaint.empty()) return fail(ErrorCode::kInvalidInput, "cloud: " + complaint);
  std::shared_ptr<Surface> surface(new Surface);
  surface->radius_ = radius;
  surface->vertices_ = std::move(points_S);
  return surface;
}

Shape Surface::piece(int index, double padding) const {
  expects(index >= 0 && index < piece_count(), "Surface::piece: no such piece");
  const double radius = radius_ + padding;
  expects(std::isfinite(radius) && radius >= 0,
          "Surface::piece: the radius with padding must be finite and not negative");
  if (!is_mesh())
    return Shape(CoreType::kPoint, at(vertices_, index), Eigen::Matrix3d::Zero(), 0, radius);
  const auto& [i, j, k] = triangles_[static_cast<std::size_t>(index)];
  const Vector3d& p = at(vertices_, i);
  Eigen::Matrix3d edges = Eigen::Matrix3d::Zero();
  edges.col(0) = at(vertices_, j) - p;
  edges.col(1) = at(vertices_, k) - p;
  return Shape(CoreType::kTriangle, p, edges, 0, radius);
}

bool Surface::contains(const Vector3d& p_S) const {
  expects(p_S.allFinite(), "Surface::contains: the point must be finite");
  const auto& nodes = solid_tree_.nodes();
  if (nodes.empty() || (p_S - nodes[0].sphere.center).norm() > nodes[0].sphere.radius) return false;
  const Eigen::Matrix3d& R = oblique_axes();
  const Vector3d along = R.row(2);
  // Corners are seen from the point: what rounding does to one it does for all its triangles.
  const auto seen = [&](int i) { return Vector3d(R * (at(vertices_, i) - p_S)); };
  const auto turns_through = [&](const std::array<int, 3>& triangle) {
    const std::array corners{seen(triangle[0]), seen(triangle[1]), seen(triangle[2])};
    const int through = winding(corners);
    return through != 0 && is_ahead(corners, through) ? through : 0;
  };
  constexpr int kDepth = 64;  // The tree halves what it holds.
  std::array<int, kDepth> open{0};
  int turns = 0;
  for (std::size_t count = 1; count > 0;) {
    const int n = open[--count];
    const BoundingTree::Node& node = nodes[static_cast<std::size_t>(n)];
    const Vector3d to = node.sphere.center - p_S;
    const double ahead = to.dot(along), radius = node.sphere.radius;
    if (ahead < -radius || (to - ahead * along).squaredNorm() > radius * radius) continue;
    if (!node.is_leaf()) {
      open[count++] = node.right;
      open[count++] = n + 1;
      continue;
    }
    for (int k = node.first; k < node.first + node.count; ++k) {
      const int item = solid_tree_.order()[static_cast<std::size_t>(k)];
      turns += turns_through(solid_[static_cast<std::size_t>(item)]);
    }
  }
  return turns != 0;
}

}  // namespace tandem::geometry
