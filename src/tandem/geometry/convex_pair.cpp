#include "tandem/geometry/convex_pair.h"

#include <cmath>

#include "tandem/geometry/epa.h"
#include "tandem/geometry/gjk.h"
#include "tandem/geometry/polytope.h"

namespace tandem::geometry::detail {

using Eigen::Vector3d;

namespace {

/// Calls `use` with all edges of a core that a corner furthest along `n` has: of a convex one those
/// of that corner, of others one of each direction.
template <class Use>
void for_edges_at(const Shape& shape, const Vector3d& n, const Use& use) {
  if (shape.type() != CoreType::kConvex) {
    for (int i = 0; i < shape.size_count(); ++i) use(Vector3d(shape.extents().col(i)));
    if (shape.type() == CoreType::kTriangle) {
      use(Vector3d(shape.extents().col(1) - shape.extents().col(0)));
    }
    return;
  }
  const ConvexHull& hull = shape.hull();
  const auto corner = static_cast<std::size_t>(hull.support(shape.extents().transpose() * n));
  for (int k = hull.first_neighbour[corner]; k < hull.first_neighbour[corner + 1]; ++k) {
    const auto next = static_cast<std::size_t>(hull.neighbours[static_cast<std::size_t>(k)]);
    use(Vector3d(shape.extents() * (hull.vertices[next] - hull.vertices[corner])));
  }
}

/// Normals of a core's faces that are about along `n`; all of a core that is not convex.
template <class Use>
void for_normals_near(const Shape& shape, const Vector3d& n, double cosine, const Use& use) {
  const auto& u = shape.extents();
  switch (shape.type()) {
    case CoreType::kPoint:
    case CoreType::kSegment:
      return;
    case CoreType::kTriangle:
    case CoreType::kRectangle:
      return use(accurate_cross(u.col(0), u.col(1)));
    case CoreType::kBox:
    case CoreType::kCylinder:
      for (int i = 0; i < shape.size_count(); ++i) use(Vector3d(u.col(i)));
      return;
    case CoreType::kConvex: {
      const Vector3d n_H = u.transpose() * n;
      for (const Vector3d& m_H : shape.hull().normals) {
        if (m_H.dot(n_H) >= cosine) use(Vector3d(u * m_H));
      }
    }
  }
}

/// The facets of A - B next to where it is furthest along `n`: what an iteration ends near to, they
/// give to rounding.
void polish(const Shape& a, const Shape& b, const Vector3d& n, DirectionSearch& search) {
  constexpr double kNear = 0.9999;  // [-] Cosine.
  const auto consider = [&](const Vector3d& m) { search.consider(m); };
  for_normals_near(a, -n, kNear, consider);
  for_normals_near(b, n, kNear, consider);
  for_edges_at(a, -n, [&](const Vector3d& edge_a) {
    for_edges_at(b, n, [&](const Vector3d& edge_b) {
      const Vector3d m = accurate_cross(edge_a, edge_b);
      const double along = std::abs(m.dot(n));
      if (along >= kNear * m.norm()) search.consider(m);
    });
  });
}

bool has_volume(const Shape& shape) {
  const CoreType type = shape.type();
  return type == CoreType::kBox || type == CoreType::kCylinder ||
         (type == CoreType::kConvex && !shape.hull().flat);
}

/// All edges of a core that has no volume.
template <class Use>
void for_all_edges(const Shape& shape, const Use& use) {
  if (shape.type() != CoreType::kConvex) return for_edges_at(shape, Vector3d::UnitX(), use);
  const ConvexHull& hull = shape.hull();
  for (const auto& [i, j] : hull.edges) {
    use(Vector3d(shape.extents() * (hull.vertices[static_cast<std::size_t>(j)] -
                                    hull.vertices[static_cast<std::size_t>(i)])));
  }
}

/// Every facet of A - B, where neither has volume.
void search_flat(const Shape& a, const Shape& b, DirectionSearch& search) {
  const auto consider = [&](const Vector3d& m) { search.consider(m); };
  for (const Shape* shape : {&a, &b}) for_normals_near(*shape, Vector3d::UnitZ(), -2, consider);
  for_all_edges(a, [&](const Vector3d& edge_a) {
    for_all_edges(b,
                  [&](const Vector3d& edge_b) { search.consider(accurate_cross(edge_a, edge_b)); });
  });
}

}  // namespace

Nearest nearest_with_convex(const Shape& a, const Shape& b) { return nearest_by_support(a, b); }

void search_convex(const Shape& a, const Shape& b, DirectionSearch& search) {
  if (!has_volume(a) && !has_volume(b)) return search_flat(a, b, search);
  const Vector3d between = a.bounding_center() - b.bounding_center();
  search.consider(between.squaredNorm() > 0 ? between : Vector3d::UnitZ());
  const Separation found = expand_polytope(a, b, search.best());
  search.consider(found.nhat_BA_W);
  polish(a, b, found.nhat_BA_W, search);
}

}  // namespace tandem::geometry::detail
