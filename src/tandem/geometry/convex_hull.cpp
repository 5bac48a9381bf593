#include "tandem/geometry/convex_hull.h"

#include <libqhull_r/qhull_ra.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <numbers>
#include <set>
#include <string>
#include <utility>

#include "tandem/geometry/magnitude.h"
#include "tandem/geometry/polytope.h"

namespace tandem::geometry {

using Eigen::Matrix3d, Eigen::Vector3d;

namespace {

constexpr double kFlat = 1e-12;  // [-] of the extent.

using Triangles = std::vector<std::array<int, 3>>;

const Vector3d& at(std::span<const Vector3d> points, int i) {
  return points[static_cast<std::size_t>(i)];
}

/// Frame of a point set: rows are unit axes along which it is widest, next widest, ...
struct Extent {
  Matrix3d R = Matrix3d::Identity();
  Vector3d widths = Vector3d::Zero();  ///< Greatest deviation along the axes, from some point.
  int dimension = 0;
  Vector3d end_a, end_b;
};

template <class Measure>
Vector3d furthest(std::span<const Vector3d> points, const Measure& measure) {
  return *std::ranges::max_element(points, {}, measure);
}

Extent extent_of(std::span<const Vector3d> points) {
  Extent extent;
  Vector3d p = points[0];
  // From corner to corner: twice is enough for a pair far apart.
  Vector3d q = furthest(points, [&](const Vector3d& v) { return (v - p).squaredNorm(); });
  std::swap(p, q);
  q = furthest(points, [&](const Vector3d& v) { return (v - p).squaredNorm(); });
  extent.end_a = p;
  extent.end_b = q;
  const double size = (q - p).norm();
  // What numbers far from the origin cannot resolve is no extent either.
  const double noise = std::max(kFlat * size, 4e-16 * std::max(p.norm(), q.norm()));
  if (!(size > noise)) return extent;
  const Vector3d x = (q - p) / size;
  const auto aside = [&](const Vector3d& v) { return Vector3d((v - p) - x * x.dot(v - p)); };
  const Vector3d side =
      aside(furthest(points, [&](const Vector3d& v) { return aside(v).squaredNorm(); }));
  extent.dimension = 1;
  Vector3d y = x.unitOrthogonal();
  if (side.norm() > noise) {
    extent.dimension = 2;
    y = (side - x * x.dot(side)).normalized();
  }
  const Vector3d z = x.cross(y);
  const Vector3d high = furthest(points, [&](const Vector3d& v) { return std::abs(z.dot(v - p)); });
  const double height = std::abs(z.dot(high - p));
  if (extent.dimension == 2 && height > noise) extent.dimension = 3;
  extent.R << x.transpose(), y.transpose(), z.transpose();
  extent.widths = Vector3d(size, side.norm(), height);
  return extent;
}

/// Triangles of the hull in indices of `points`, by qhull; the error text if it gives up.
Result<Triangles> quickhull(std::vector<Vector3d>& points) {
  char* text = nullptr;
  std::size_t length = 0;
  std::FILE* errors = open_memstream(&text, &length);
  qhT state;
  qh_zero(&state, errors);
  char command[] = "qhull Qt";
  const int code = qh_new_qhull(&state, 3, static_cast<int>(points.size()), points[0].data(), False,
                                command, nullptr, errors);
  Triangles triangles;
  if (code == 0) {
    qhT* qh = &state;
    facetT* facet;
    FORALLfacets {
      std::array<int, 3> triangle{};
      std::size_t k = 0;
      vertexT *vertex, **vertexp;
      FOREACHvertex_(facet->vertices) {
        if (k < 3) triangle[k++] = qh_pointid(qh, vertex->point);
      }
      if (facet->toporient != qh_ORIENTclock) std::swap(triangle[1], triangle[2]);
      triangles.push_back(triangle);
    }
  }
  qh_freeqhull(&state, qh_ALL);
  int rest = 0, total = 0;
  qh_memfreeshort(&state, &rest, &total);
  std::fclose(errors);
  const std::string message(text, length);
  std::free(text);
  if (code != 0) {
    return fail(ErrorCode::kInvalidInput, "qhull finds no convex hull: " + message);
  }
  return triangles;
}

/// The corners, counter-clockwise, of points in the plane of x and y: indices.
/// Ref: Andrew, Another efficient algorithm for convex hulls in two dimensions (1979).
std::vector<int> polygon(std::span<const Vector3d> points) {
  std::vector<int> order(points.size()), corners;
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
  std::ranges::sort(order, {},
                    [&](int i) { return std::pair(at(points, i).x(), at(points, i).y()); });
  const auto add = [&](int i, std::size_t least) {
    const auto turns_left = [&] {
      const Vector3d &a = at(points, corners[corners.size() - 2]), &b = at(points, corners.back());
      const Vector3d u = b - a, v = at(points, i) - a;
      return u.x() * v.y() - u.y() * v.x() > kFlat * u.norm() * v.norm();
    };
    while (corners.size() > least && !turns_left()) corners.pop_back();
    corners.push_back(i);
  };
  for (const int i : order) add(i, 1);
  const std::size_t half = corners.size();
  for (auto i = order.rbegin() + 1; i != order.rend(); ++i) add(*i, half);
  corners.pop_back();
  return corners;
}

Triangles both_sides(const std::vector<int>& corners) {
  Triangles triangles;
  for (std::size_t i = 2; i < corners.size(); ++i) {
    triangles.push_back({corners[0], corners[i - 1], corners[i]});
    triangles.push_back({corners[0], corners[i], corners[i - 1]});
  }
  return triangles;
}

/// Keeps the points that triangles have, and numbers them anew.
void keep_vertices(std::span<const Vector3d> points, Triangles triangles, ConvexHull& hull) {
  std::map<int, int> number;
  for (auto& triangle : triangles) {
    for (int& i : triangle) {
      const auto [entry, is_new] = number.try_emplace(i, static_cast<int>(hull.vertices.size()));
      if (is_new) hull.vertices.push_back(at(points, i));
      i = entry->second;
    }
  }
  hull.triangles = std::move(triangles);
}

Vector3d area_vector(const ConvexHull& hull, const std::array<int, 3>& t) {
  const Vector3d& p = at(hull.vertices, t[0]);
  return 0.5 * detail::accurate_cross(at(hull.vertices, t[1]) - p, at(hull.vertices, t[2]) - p);
}

void add_neighbours(ConvexHull& hull) {
  std::vector<std::pair<int, int>> sides;
  for (const auto& t : hull.triangles) {
    for (std::size_t k = 0; k < 3; ++k) sides.emplace_back(t[k], t[(k + 1) % 3]);
  }
  if (hull.flat) {
    for (std::size_t i = 0, n = sides.size(); i < n; ++i) {
      sides.emplace_back(sides[i].second, sides[i].first);
    }
  }
  std::ranges::sort(sides);
  sides.erase(std::ranges::unique(sides).begin(), sides.end());
  hull.first_neighbour.assign(hull.vertices.size() + 1, 0);
  for (const auto& [from, to] : sides) {
    ++hull.first_neighbour[static_cast<std::size_t>(from) + 1];
    hull.neighbours.push_back(to);
  }
  for (std::size_t i = 0; i < hull.vertices.size(); ++i) {
    hull.first_neighbour[i + 1] += hull.first_neighbour[i];
  }
}

/// Edges with the angle between the faces they join, and one normal of each face.
void add_faces(ConvexHull& hull) {
  constexpr double kSameFace = 1e-10;  // [rad]
  std::map<std::pair<int, int>, Vector3d> by_side;
  std::set<std::pair<int, int>> diagonals;  // Of a flat hull: it has them on either side.
  for (const auto& t : hull.triangles) {
    const Vector3d area = area_vector(hull, t);
    hull.surface += area.norm();
    hull.volume += at(hull.vertices, t[0]).dot(area) / 3;
    const Vector3d n = area.norm() > 0 ? Vector3d(area.normalized()) : Vector3d::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      const std::pair side{t[k], t[(k + 1) % 3]};
      if (!by_side.try_emplace(side, n).second) diagonals.insert(side);
    }
    const auto same = [&](const Vector3d& m) { return (m - n).norm() < kSameFace; };
    if (area.norm() > 0 && std::ranges::none_of(hull.normals, same)) hull.normals.push_back(n);
  }
  for (const auto& [side, n] : by_side) {
    const auto [i, j] = side;
    const auto other = by_side.find({j, i});
    if ((i > j && other != by_side.end()) || diagonals.contains(side)) continue;
    const Vector3d m = other == by_side.end() ? Vector3d::Zero() : other->second;
    const double angle = std::atan2(n.cross(m).norm(), n.dot(m));
    const bool unclear = n.isZero() || m.isZero();
    if (angle < kSameFace && !unclear) continue;
    hull.edges.push_back({i, j});
    const double length = (at(hull.vertices, i) - at(hull.vertices, j)).norm();
    if (!unclear) hull.mean_width_term += 0.5 * length * angle;
  }
}

/// Half axes of an octahedron about the origin inside the hull, along the rows of R.
void add_inner(const Matrix3d& R, ConvexHull& hull) {
  for (int k = 0; k < 3; ++k) {
    const Vector3d axis = R.row(k);
    double reach = std::numeric_limits<double>::infinity();
    for (const auto& t : hull.triangles) {
      const Vector3d area = area_vector(hull, t);
      const double along = std::abs(area.dot(axis));
      if (along > 0) reach = std::min(reach, at(hull.vertices, t[0]).dot(area) / along);
    }
    hull.inner.col(k) = std::max(0.0, reach) * (1 - 1e-12) * axis;
  }
}

/// Ref: Badoiu, Clarkson, Smaller core-sets for balls (2003).
void add_bounding_sphere(ConvexHull& hull) {
  constexpr int kRounds = 1000;
  Vector3d c = Vector3d::Zero();
  double best = std::numeric_limits<double>::infinity();
  for (int i = 1; i <= kRounds; ++i) {
    const auto square = [&](const Vector3d& v) { return (v - c).squaredNorm(); };
    const Vector3d p = furthest(hull.vertices, square);
    if (square(p) < best) {
      best = square(p);
      hull.bounding_center = c;
    }
    c += (p - c) / (i + 1);
  }
  hull.bounding_radius = std::sqrt(best);
}

Vector3d mean_of(std::span<const Vector3d> points) {
  Vector3d sum = Vector3d::Zero();
  for (const Vector3d& p : points) sum += p / static_cast<double>(points.size());
  return sum;
}

}  // namespace

int ConvexHull::support(const Vector3d& direction) const {
  constexpr std::size_t kScan = 24;  // Vertices; with more, climbing is faster.
  const auto height = [&](int i) { return at(vertices, i).dot(direction); };
  int best = 0;
  double most = height(0);
  const auto look = [&](int i) {
    const double h = height(i);
    if (!(h > most)) return false;
    most = h;
    best = i;
    return true;
  };
  if (vertices.size() <= kScan || flat) {
    for (std::size_t i = 1; i < vertices.size(); ++i) look(static_cast<int>(i));
    return best;
  }
  for (bool higher = true; higher;) {
    higher = false;
    const auto from = static_cast<std::size_t>(best);
    for (int k = first_neighbour[from]; k < first_neighbour[from + 1]; ++k) {
      higher |= look(neighbours[static_cast<std::size_t>(k)]);
    }
  }
  return best;
}

Result<HullPoints> convex_hull(std::span<const Vector3d> points) {
  if (points.empty()) return fail(ErrorCode::kInvalidInput, "a convex hull needs a point");
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].allFinite() && points[i].cwiseAbs().maxCoeff() <= detail::kLargest) continue;
    return fail(ErrorCode::kInvalidInput,
                "point " + std::to_string(i) + " is not finite, or beyond 1e50 m");
  }
  const Extent extent = extent_of(points);
  HullPoints result{extent.dimension, extent.end_a, extent.end_b, mean_of(points), {}};
  if (extent.dimension < 2) return result;
  // As wide in every direction: an affine map keeps the hull's faces, and rounding matters less.
  std::vector<Vector3d> scaled;
  for (const Vector3d& p : points) {
    scaled.push_back((extent.R * (p - extent.end_a)).cwiseQuotient(extent.widths));
    if (extent.dimension == 2) scaled.back().z() = 0;
  }
  Triangles triangles;
  if (extent.dimension == 2) {
    triangles = both_sides(polygon(scaled));
  } else if (auto found = quickhull(scaled)) {
    triangles = std::move(*found);
  } else {
    return std::unexpected(found.error());
  }
  ConvexHull& hull = result.hull;
  hull.flat = extent.dimension == 2;
  keep_vertices(points, std::move(triangles), hull);
  result.center = mean_of(hull.vertices);
  for (Vector3d& v : hull.vertices) v -= result.center;
  add_neighbours(hull);
  add_faces(hull);
  if (hull.flat) hull.volume = 0;
  if (!hull.flat) add_inner(extent.R, hull);
  add_bounding_sphere(hull);
  return result;
}

}  // namespace tandem::geometry
