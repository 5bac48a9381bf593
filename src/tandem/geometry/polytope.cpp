#include "tandem/geometry/polytope.h"

#include <cmath>

namespace tandem::geometry::detail {

using Eigen::Vector3d;

namespace {

/// a b - c d without cancellation. Ref: Kahan; Jeannerod et al., Math. Comp. 82 (2013).
double difference_of_products(double a, double b, double c, double d) {
  const double cd = c * d;
  return std::fma(a, b, -cd) + std::fma(-c, d, cd);
}

double inverse(double square) { return square > 1e-290 ? 1 / square : 0.0; }

Segment segment_between(const Vector3d& p, const Vector3d& q) {
  const Vector3d u = 0.5 * (q - p);
  return {p + u, u, inverse(u.squaredNorm())};
}

Nearest nearest_segments(const Segment& a, const Segment& b) {
  return nearest_segment_orthotope<1>(a, b.c, b.u, &b.inverse_square);
}

/// Nearest points of `p` (as A) and the inside of the triangle, which `p` lies over.
Nearest nearest_on_face(const Vector3d& p, const Triangle& b) {
  const double height = (p - b.vertices[0]).dot(b.n);
  const Vector3d e = (height * b.inverse_nn) * b.n;
  return {p - e, e, height * height * b.inverse_nn};
}

Nearest nearest_segment_triangle(const Segment& a, const Triangle& b) {
  Nearest best = nearest_segments(a, b.edges[0]);
  keep_nearer(best, nearest_segments(a, b.edges[1]));
  keep_nearer(best, nearest_segments(a, b.edges[2]));
  for (const Vector3d& p : {Vector3d(a.c - a.u), Vector3d(a.c + a.u)}) {
    if (b.is_over(p)) keep_nearer(best, nearest_on_face(p, b));
  }
  return best;
}

Nearest nearest_triangles(const Triangle& a, const Triangle& b) {
  Nearest best;
  for (const Segment& edge_a : a.edges) {
    for (const Segment& edge_b : b.edges) keep_nearer(best, nearest_segments(edge_a, edge_b));
  }
  for (const Vector3d& p : a.vertices) {
    if (b.is_over(p)) keep_nearer(best, nearest_on_face(p, b));
  }
  for (const Vector3d& p : b.vertices) {
    if (a.is_over(p)) keep_nearer(best, nearest_on_face(p, a).swapped());
  }
  return best;
}

/// Corner `i` of a rectangle (N = 2) or box (N = 3): bit k says which side along extent k.
template <int N>
Vector3d corner(const Shape& shape, int i) {
  Vector3d p = shape.origin();
  for (int k = 0; k < N; ++k) {
    p += ((i >> k) & 1 ? 1.0 : -1.0) * shape.extents().col(k);
  }
  return p;
}

/// Triangle against rectangle or box.
template <int N>
Nearest nearest_triangle_orthotope(const Triangle& a, const Shape& b) {
  Nearest best;
  for (const Segment& edge : a.edges) {
    keep_nearer(best, nearest_segment_orthotope<N>(edge, b));
    if (is_touch(best)) return best;
  }
  for (int i = 0; i < (1 << N); ++i) {
    const Vector3d p = corner<N>(b, i);
    if (a.is_over(p)) keep_nearer(best, nearest_on_face(p, a).swapped());
  }
  return best;
}

/// Rectangle or box against rectangle or box: all edges of A against B, all corners of B against A.
template <int N, int M>
Nearest nearest_orthotopes(const Shape& a, const Shape& b) {
  Nearest best;
  for (const Segment& edge : Edges(a)) {
    keep_nearer(best, nearest_segment_orthotope<M>(edge, b));
    if (is_touch(best)) return best;
  }
  for (int i = 0; i < (1 << M); ++i) {
    keep_nearer(best, nearest_point_orthotope<N>(corner<M>(b, i), a).swapped());
  }
  return best;
}

}  // namespace

Vector3d accurate_cross(const Vector3d& u, const Vector3d& v) {
  constexpr double kNearlyParallel = 1e-2;  // [-] sin^2 below which the naive product is refined.
  const Vector3d n = u.cross(v);
  if (n.squaredNorm() > kNearlyParallel * u.squaredNorm() * v.squaredNorm()) return n;
  return {difference_of_products(u.y(), v.z(), u.z(), v.y()),
          difference_of_products(u.z(), v.x(), u.x(), v.z()),
          difference_of_products(u.x(), v.y(), u.y(), v.x())};
}

Triangle::Triangle(const Shape& shape) {
  const auto& u = shape.extents();
  n = accurate_cross(u.col(0), u.col(1));
  inverse_nn = inverse(n.squaredNorm());
  vertices[0] = shape.origin();
  vertices[1] = shape.origin() + u.col(0);
  vertices[2] = shape.origin() + u.col(1);
  edges[0] = {vertices[0] + 0.5 * u.col(0), 0.5 * u.col(0), 4 * shape.inverse_squares()[0]};
  edges[1] = segment_between(vertices[1], vertices[2]);
  edges[2] = {vertices[0] + 0.5 * u.col(1), -0.5 * u.col(1), 4 * shape.inverse_squares()[1]};
  for (int k = 0; k < 3; ++k) inward[k] = n.cross(edges[k].u);
}

Edges::Edges(const Shape& shape) {
  const auto& u = shape.extents();
  if (shape.type() == CoreType::kTriangle) {
    const Triangle triangle(shape);
    for (const Segment& edge : triangle.edges) list[count++] = edge;
    return;
  }
  const int n = shape.size_count(), corners = 1 << n;
  if (n == 0) list[count++] = {shape.origin(), Vector3d::Zero(), 0};
  for (int k = 0; k < n; ++k) {
    for (int i = 0; i < corners; ++i) {
      if ((i >> k) & 1) continue;  // Bit j of i: the side along extent j; bit k is the edge's own.
      Segment& edge = list[count++];
      edge = {shape.origin(), u.col(k), shape.inverse_squares()[k]};
      for (int j = 0; j < n; ++j) {
        if (j != k) edge.c += ((i >> j) & 1 ? 1.0 : -1.0) * u.col(j);
      }
    }
  }
}

bool Triangle::is_over(const Vector3d& p) const {
  if (inverse_nn == 0) return false;
  for (int k = 0; k < 3; ++k) {
    if (!((p - vertices[k]).dot(inward[k]) >= 0)) return false;
  }
  // In a sliver the three lines are one but for rounding, and all of it seems inside.
  const Segment& longest = *std::max_element(edges, edges + 3, [](const auto& e, const auto& f) {
    return e.u.squaredNorm() < f.u.squaredNorm();
  });
  return std::abs((p - longest.c).dot(longest.u)) <= longest.u.squaredNorm();
}

Nearest nearest_point_triangle(const Vector3d& p, const Triangle& b) {
  if (b.is_over(p)) return nearest_on_face(p, b);
  Nearest best;
  for (const Segment& edge : b.edges) {
    const double s = std::clamp(edge.inverse_square * edge.u.dot(p - edge.c), -1.0, 1.0);
    const Vector3d q = edge.c + s * edge.u, e = p - q;
    keep_nearer(best, {q, e, e.squaredNorm()});
  }
  return best;
}

Nearest nearest_features(const Shape& a, const Shape& b) {
  const auto pair = [](CoreType first, CoreType second) {
    return 6 * static_cast<int>(first) + static_cast<int>(second);
  };
  using enum CoreType;
  switch (pair(a.type(), b.type())) {
    case pair(kSegment, kTriangle):
      return nearest_segment_triangle({a.origin(), a.extents().col(0)}, Triangle(b));
    case pair(kTriangle, kTriangle):
      return nearest_triangles(Triangle(a), Triangle(b));
    case pair(kTriangle, kRectangle):
      return nearest_triangle_orthotope<2>(Triangle(a), b);
    case pair(kTriangle, kBox):
      return nearest_triangle_orthotope<3>(Triangle(a), b);
    case pair(kRectangle, kRectangle):
      return nearest_orthotopes<2, 2>(a, b);
    case pair(kRectangle, kBox):
      return nearest_orthotopes<2, 3>(a, b);
    case pair(kBox, kBox):
      return nearest_orthotopes<3, 3>(a, b);
    default:
      return nearest_features(b, a).swapped();
  }
}

}  // namespace tandem::geometry::detail
