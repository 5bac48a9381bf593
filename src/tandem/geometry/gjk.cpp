#include "tandem/geometry/gjk.h"

#include <cmath>
#include <limits>

#include "tandem/geometry/polytope.h"

namespace tandem::geometry::detail {

using Eigen::Vector3d;

namespace {

/// A point of A - B with the point of B that it came from.
struct Vertex {
  Vector3d w = Vector3d::Zero(), p_b = Vector3d::Zero();
};

/// Up to four vertices and the weights of their point nearest to the origin.
struct Simplex {
  Vertex vertices[4];
  double weights[4] = {1, 0, 0, 0};
  int count = 0;

  Vector3d point() const {
    Vector3d p = Vector3d::Zero();
    for (int i = 0; i < count; ++i) p += weights[i] * vertices[i].w;
    return p;
  }
};

/// Collects, over the faces of a simplex, the one whose nearest point is nearest to the origin.
class NearestFace {
 public:
  explicit NearestFace(const Simplex& simplex) : from_(simplex) {}

  void vertex(int i) { keep({i}, {1.0}); }

  void edge(int i, int j) {
    const Vector3d &p = w(i), d = w(j) - p;
    const double dd = d.squaredNorm(), s = dd > 0 ? -p.dot(d) / dd : 0.0;
    if (s > 0 && s < 1) keep({i, j}, {1 - s, s});
  }

  void triangle(int i, int j, int k) {
    const Vector3d n = accurate_cross(w(j) - w(i), w(k) - w(i));
    const double nn = n.squaredNorm();
    if (!(nn > 0)) return;
    // Areas of the triangles that the origin's shadow makes with the edges.
    const double wi = n.dot(w(j).cross(w(k))), wj = n.dot(w(k).cross(w(i)));
    const double wk = n.dot(w(i).cross(w(j))), sum = wi + wj + wk;
    if (wi > 0 && wj > 0 && wk > 0) keep({i, j, k}, {wi / sum, wj / sum, wk / sum});
  }

  /// Whether the origin is strictly inside; its weights are kept if so.
  bool tetrahedron() {
    const Vector3d &a = w(0), &b = w(1), &c = w(2), &d = w(3);
    const double volume = (b - a).dot((c - a).cross(d - a));
    const double wa = b.dot(c.cross(d)) / volume, wb = -a.dot(c.cross(d)) / volume;
    const double wc = a.dot(b.cross(d)) / volume, wd = -a.dot(b.cross(c)) / volume;
    if (!(wa > 0 && wb > 0 && wc > 0 && wd > 0)) return false;
    const double sum = wa + wb + wc + wd;
    keep({0, 1, 2, 3}, {wa / sum, wb / sum, wc / sum, wd / sum});
    return true;
  }

  const Simplex& best() const { return best_; }
  double squared() const { return squared_; }

 private:
  const Vector3d& w(int i) const { return from_.vertices[i].w; }

  template <std::size_t N>
  void keep(const int (&indices)[N], const double (&weights)[N]) {
    Simplex face;
    face.count = static_cast<int>(N);
    for (std::size_t i = 0; i < N; ++i) {
      face.vertices[i] = from_.vertices[indices[i]];
      face.weights[i] = weights[i];
    }
    const double squared = face.point().squaredNorm();
    if (squared >= squared_) return;
    squared_ = squared;
    best_ = face;
  }

  const Simplex& from_;
  Simplex best_;
  double squared_ = std::numeric_limits<double>::max();
};

/// The face of `simplex` nearest to the origin; it contains the newest, last vertex.
NearestFace nearest_face(const Simplex& simplex) {
  NearestFace nearest(simplex);
  const int last = simplex.count - 1;
  nearest.vertex(last);
  for (int i = 0; i < last; ++i) nearest.edge(i, last);
  for (int i = 0; i < last; ++i) {
    for (int j = i + 1; j < last; ++j) nearest.triangle(i, j, last);
  }
  if (simplex.count == 4) nearest.tetrahedron();
  return nearest;
}

Vertex support(const Shape& a, const Shape& b, const Vector3d& direction) {
  const Vector3d p_a = a.support(direction), p_b = b.support(-direction);
  return {p_a - p_b, p_b};
}

}  // namespace

Nearest nearest_by_support(const Shape& a, const Shape& b) {
  constexpr int kSteps = 256;          // Reached by no case known; each step shortens the gap.
  constexpr double kRounding = 1e-15;  // [-] of the gap: no better bound is computable.
  constexpr double kTouching = 1e-20;  // [m^2] Beyond this there is no direction left to follow.
  Simplex simplex;
  simplex.count = 1;
  simplex.vertices[0] = support(a, b, b.bounding_center() - a.bounding_center());
  Vector3d v = simplex.vertices[0].w;
  for (int step = 0; step < kSteps; ++step) {
    const double squared = v.squaredNorm();
    if (squared < kTouching || simplex.count == 4) break;
    const Vertex next = support(a, b, -v);
    if (squared - v.dot(next.w) <= kRounding * squared) break;
    simplex.vertices[simplex.count++] = next;
    const NearestFace nearest = nearest_face(simplex);
    --simplex.count;
    if (nearest.squared() >= squared) break;
    simplex = nearest.best();
    v = simplex.point();
  }
  Nearest nearest{Vector3d::Zero(), v, v.squaredNorm()};
  for (int i = 0; i < simplex.count; ++i) {
    nearest.p_WCb += simplex.weights[i] * simplex.vertices[i].p_b;
  }
  return nearest;
}

}  // namespace tandem::geometry::detail
