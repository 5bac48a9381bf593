#include "tandem/geometry/separation.h"

#include <cmath>

#include "tandem/geometry/convex_pair.h"
#include "tandem/geometry/cylinder.h"
#include "tandem/geometry/polytope.h"

namespace tandem::geometry::detail {

using Eigen::Vector3d;

namespace {

struct Interval {
  double low, high;
};

/// Extent of the core along `nhat`, from its origin.
Interval project(const Shape& shape, const Vector3d& nhat) {
  const auto& u = shape.extents();
  const auto along = [&](int i) { return u.col(i).dot(nhat); };
  double reach = 0;
  switch (shape.type()) {
    case CoreType::kPoint:
      break;
    case CoreType::kSegment:
      reach = std::abs(along(0));
      break;
    case CoreType::kTriangle: {
      const double q = along(0), r = along(1);
      return {std::min(0.0, std::min(q, r)), std::max(0.0, std::max(q, r))};
    }
    case CoreType::kRectangle:
      reach = std::abs(along(0)) + std::abs(along(1));
      break;
    case CoreType::kBox:
      reach = std::abs(along(0)) + std::abs(along(1)) + std::abs(along(2));
      break;
    case CoreType::kCylinder: {
      const double sine = std::sqrt(shape.inverse_squares()[0]) * u.col(0).cross(nhat).norm();
      reach = std::abs(along(0)) + shape.core_radius() * sine;
      break;
    }
    case CoreType::kConvex: {
      const ConvexHull& hull = shape.hull();
      const Vector3d n_H = u.transpose() * nhat;
      const auto height = [&](int i) {
        return n_H.dot(hull.vertices[static_cast<std::size_t>(i)]);
      };
      return {height(hull.support(-n_H)), height(hull.support(n_H))};
    }
  }
  return {-reach, reach};
}

/// Up to three vectors.
struct Directions {
  Vector3d list[3];
  int count = 0;

  void add(const Vector3d& v) { list[count++] = v; }
  const Vector3d* begin() const { return list; }
  const Vector3d* end() const { return list + count; }
};

/// One vector along every family of parallel edges; of a cylinder, along its side. A convex core
/// has no families.
Directions edges(const Shape& shape) {
  Directions edges;
  if (shape.type() == CoreType::kConvex) return edges;
  for (int i = 0; i < shape.size_count(); ++i) edges.add(shape.extents().col(i));
  if (shape.type() == CoreType::kTriangle) edges.add(edges.list[1] - edges.list[0]);
  return edges;
}

Directions face_normals(const Shape& shape) {
  Directions normals;
  switch (shape.type()) {
    case CoreType::kPoint:
    case CoreType::kSegment:
    case CoreType::kConvex:
      break;
    case CoreType::kTriangle:
    case CoreType::kRectangle:
      normals.add(accurate_cross(shape.extents().col(0), shape.extents().col(1)));
      break;
    case CoreType::kBox:
    case CoreType::kCylinder:
      normals = edges(shape);
      break;
  }
  return normals;
}

/// A vector normal to the longest of the edges: the last resort where all of them are parallel.
Vector3d normal_to_all(const Directions& a, const Directions& b) {
  Vector3d longest = Vector3d::Zero();
  for (const Directions* edges : {&a, &b}) {
    for (const Vector3d& u : *edges) {
      if (u.squaredNorm() > longest.squaredNorm()) longest = u;
    }
  }
  return longest.squaredNorm() > 0 ? longest.unitOrthogonal() : Vector3d::UnitZ();
}

}  // namespace

void DirectionSearch::consider(const Vector3d& n) {
  constexpr double kSmall = 1e-200, kLarge = 1e200;  // [-] Squares beyond may be out of range.
  double square = n.squaredNorm();
  Vector3d nhat = n;
  if (!(square > kSmall && square < kLarge)) {
    const double largest = n.cwiseAbs().maxCoeff();
    if (!(largest > 0)) return;
    nhat = n / largest;
    square = nhat.squaredNorm();
  }
  nhat /= std::sqrt(square);
  const Interval a = project(a_, nhat), b = project(b_, nhat);
  const double between = p_ba_.dot(nhat);
  keep(nhat, between + a.low - b.high);
  keep(-nhat, b.low - a.high - between);
}

double separation(const Shape& a, const Shape& b, const Vector3d& nhat) {
  return (a.origin() - b.origin()).dot(nhat) + project(a, nhat).low - project(b, nhat).high;
}

Separation best_separation(const Shape& a, const Shape& b, const Nearest& nearest) {
  DirectionSearch search(a, b);
  // The facets of A - B: those of A, those of B, and those that two edges span.
  for (const Vector3d& n : face_normals(a)) search.consider(n);
  for (const Vector3d& n : face_normals(b)) search.consider(n);
  const Directions edges_a = edges(a), edges_b = edges(b);
  for (const Vector3d& u : edges_a) {
    for (const Vector3d& v : edges_b) search.consider(accurate_cross(u, v));
  }
  // Where no facet exists (all edges parallel) every normal to them is as good; so it is where all
  // of one core is on a cylinder's axis.
  const bool convex = a.type() == CoreType::kConvex || b.type() == CoreType::kConvex;
  const bool curved = a.type() == CoreType::kCylinder || b.type() == CoreType::kCylinder;
  if (curved || convex || !search.found_any()) search.consider(normal_to_all(edges_a, edges_b));
  // Still apart at a corner or edge: what is left of the gap, freed of its noise along an edge.
  const Vector3d& e = nearest.p_BA_W;
  if (nearest.squared > 0) {
    search.consider(e);
    for (const Directions* edges : {&edges_a, &edges_b}) {
      for (const Vector3d& u : *edges) {
        if (u.squaredNorm() > 0) search.consider(e - u * (u.dot(e) / u.squaredNorm()));
      }
    }
  }
  if (convex) {
    search_convex(a, b, search);
  } else if (curved) {
    search_curved(a, b, search);
  }
  return search.best();
}

}  // namespace tandem::geometry::detail
