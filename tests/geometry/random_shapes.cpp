#include "random_shapes.h"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <sstream>

namespace tandem::geometry {

using Eigen::Isometry3d, Eigen::Matrix3d, Eigen::Vector2d, Eigen::Vector3d;

const char* to_string(Draw draw) {
  switch (draw) {
    case Draw::kGeneric:
      return "generic";
    case Draw::kSlender:
      return "slender";
    case Draw::kGrid:
      return "grid";
    case Draw::kTilted:
      return "tilted";
    case Draw::kWobbled:
      return "wobbled";
  }
  return "?";
}

Vector3d random_point(Rng& rng, double reach) {
  const double x = rng.uniform(-reach, reach), y = rng.uniform(-reach, reach);
  return {x, y, rng.uniform(-reach, reach)};
}

Vector3d random_direction(Rng& rng) {
  for (;;) {
    const Vector3d p = random_point(rng, 1);
    if (p.norm() > 0.01 && p.norm() < 1) return p.normalized();
  }
}

Matrix3d random_rotation(Rng& rng) {
  const Vector3d axis = random_direction(rng);
  return Eigen::AngleAxisd(rng.uniform(-3.2, 3.2), axis).toRotationMatrix();
}

Isometry3d random_pose(Rng& rng, double reach) {
  Isometry3d X = Isometry3d::Identity();
  X.linear() = random_rotation(rng);
  X.translation() = random_point(rng, reach);
  return X;
}

namespace {

/// Sizes, poses and points in one manner.
class Drawer {
 public:
  Drawer(Rng& rng, Draw draw, double spread) : rng_(rng), draw_(draw), spread_(spread) {
    // One tilt for all shapes: the same in every draw.
    tilt_ = Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    if (draw == Draw::kWobbled) tilt_ = wobble() * tilt_;
  }

  double size() {
    if (draw_ == Draw::kGeneric) return rng_.uniform(0.05, 1);
    if (draw_ == Draw::kSlender) return std::pow(10, rng_.uniform(-5, 0));
    return 0.25 * static_cast<double>(1 + rng_.index(3));
  }
  Vector3d point(double reach) {
    if (draw_ == Draw::kGeneric || draw_ == Draw::kSlender) return random_point(rng_, reach);
    const auto coordinate = [&] {
      return reach * (0.25 * static_cast<double>(rng_.index(9)) - 1.0);
    };
    const double x = coordinate(), y = coordinate(), z = coordinate();
    const Vector3d p(x, y, z);
    return draw_ == Draw::kGrid ? p : Vector3d(tilt_ * p);
  }
  Vector3d centre() { return point(spread_); }
  Isometry3d pose() {
    Isometry3d X = Isometry3d::Identity();
    X.translation() = centre();
    if (draw_ == Draw::kGeneric || draw_ == Draw::kSlender) {
      X.linear() = random_rotation(rng_);
      return X;
    }
    Matrix3d R = Matrix3d::Identity();
    for (std::size_t i = rng_.index(3); i > 0; --i) {
      R = (Matrix3d() << 0, 0, 1, 1, 0, 0, 0, 1, 0).finished() * R;
    }
    X.linear() = draw_ == Draw::kGrid ? R : Matrix3d(tilt_ * R);
    return X;
  }
  /// A step from one vertex to another; now and then none, or along `other`.
  Vector3d step(const Vector3d& other = Vector3d::Zero()) {
    const bool odd = draw_ == Draw::kSlender && rng_.index(4) == 0;
    if (odd) return static_cast<double>(rng_.index(3)) * other;
    if (draw_ == Draw::kGeneric) return random_point(rng_, 0.6);
    if (draw_ == Draw::kSlender) return size() * random_direction(rng_);
    return point(0.5);
  }
  double radius(bool may_be_zero) {
    if (may_be_zero && rng_.index(3) == 0) return 0;
    return draw_ == Draw::kGrid ? 0.125 : rng_.uniform(0.01, 0.2);
  }

 private:
  Matrix3d wobble() {
    const Vector3d axis = random_direction(rng_);
    return Eigen::AngleAxisd(rng_.uniform(-1e-9, 1e-9), axis).toRotationMatrix();
  }

  Rng& rng_;
  Draw draw_;
  double spread_;
  Matrix3d tilt_;
};

/// The hull of points anywhere in a box, or of some of the middles and corners of its faces.
Shape random_convex(Rng& rng, const Isometry3d& X, const Vector3d& size, Drawer& drawer) {
  const bool lattice = rng.index(2) == 0;
  for (;;) {
    std::vector<Vector3d> points(4 + rng.index(lattice ? 8 : 30));
    for (Vector3d& p : points) {
      p = random_point(rng, 0.5);
      if (lattice) p = 0.5 * (2 * p).array().round();
      p = X * p.cwiseProduct(size);
    }
    Result<Shape> shape = Shape::convex(points, drawer.radius(true));
    if (!shape) shape = Shape::convex(points, drawer.radius(false));
    if (shape->type() == CoreType::kConvex) return *shape;
  }
}

double distance_to_triangle(const Vector3d& q, const Vector3d& s, const Vector3d& r) {
  const Vector3d corners[] = {Vector3d::Zero(), q, s};
  double best = r.norm();
  for (int k = 0; k < 3; ++k) {
    const Vector3d from = corners[k], edge = corners[(k + 1) % 3] - from;
    const double length = edge.norm();
    const Vector3d along = length > 0 ? Vector3d(edge / length) : Vector3d::Zero();
    const double t = std::clamp((r - from).dot(along), 0.0, length);
    best = std::min(best, (r - from - t * along).norm());
  }
  const Eigen::Matrix<double, 3, 2> edges = (Eigen::Matrix<double, 3, 2>() << q, s).finished();
  const Vector2d st = edges.colPivHouseholderQr().solve(r);
  if (st.minCoeff() >= 0 && st.sum() <= 1) best = std::min(best, (r - edges * st).norm());
  return best;
}

double distance_to_hull(const ConvexHull& hull, const Vector3d& p_H) {
  double best = std::numeric_limits<double>::infinity(), beyond = -best;
  for (const auto& t : hull.triangles) {
    const auto at = [&](std::size_t k) { return hull.vertices[static_cast<std::size_t>(t[k])]; };
    const Vector3d q = at(1) - at(0), s = at(2) - at(0), r = p_H - at(0), n = q.cross(s);
    best = std::min(best, distance_to_triangle(q, s, r));
    beyond = std::max(beyond, n.dot(r));
  }
  return beyond <= 0 ? 0 : best;
}

}  // namespace

Shape random_shape(Rng& rng, CoreType type, Draw draw, double spread) {
  Drawer drawer(rng, draw, spread);
  const double x = drawer.size(), y = drawer.size(), z = drawer.size();
  const Isometry3d X = drawer.pose();
  const Vector3d p = X.translation();
  switch (type) {
    case CoreType::kPoint:
      return *Shape::sphere(p, drawer.radius(false));
    case CoreType::kSegment: {
      const Vector3d u = drawer.step();
      return *Shape::capsule(p - u, p + u, drawer.radius(false));
    }
    case CoreType::kTriangle: {
      const Vector3d q = drawer.step(), r = drawer.step(q);
      return *Shape::rounded_triangle(p, p + q, p + r, drawer.radius(false));
    }
    case CoreType::kRectangle:
      return *Shape::rounded_rectangle(X, Vector2d(x, y), drawer.radius(false));
    case CoreType::kBox:
      return *Shape::box(X, Vector3d(x, y, z), drawer.radius(true));
    case CoreType::kCylinder:
      return *Shape::cylinder(X, 0.5 * x, y, drawer.radius(true));
    case CoreType::kConvex:
      return random_convex(rng, X, Vector3d(x, y, z), drawer);
  }
  throw std::logic_error("no such type");
}

double distance_to_core(const Shape& shape, const Vector3d& p) {
  const auto& u = shape.extents();
  const Vector3d r = p - shape.origin();
  if (shape.type() == CoreType::kTriangle) {
    return distance_to_triangle(u.col(0), u.col(1), r);
  }
  if (shape.type() == CoreType::kConvex) return distance_to_hull(shape.hull(), u.transpose() * r);
  Vector3d outside = r;
  for (int i = 0; i < shape.size_count(); ++i) {
    const double length = u.col(i).norm();
    const Vector3d along = length > 0 ? Vector3d(u.col(i) / length) : Vector3d::Zero();
    outside -= std::clamp(r.dot(along), -length, length) * along;
  }
  if (shape.type() != CoreType::kCylinder) return outside.norm();
  const Vector3d along = u.col(0).normalized(), across = r - r.dot(along) * along;
  const double axial = std::max(0.0, std::abs(r.dot(along)) - u.col(0).norm());
  return std::hypot(axial, std::max(0.0, across.norm() - shape.core_radius()));
}

std::string describe(const Shape& shape) {
  std::ostringstream out;
  out << std::setprecision(17) << to_string(shape.type()) << " c " << shape.origin().transpose();
  for (int i = 0; i < shape.size_count(); ++i) out << " u " << shape.extents().col(i).transpose();
  out << " R " << shape.core_radius() << " r " << shape.radius();
  if (shape.type() == CoreType::kConvex) {
    for (const Vector3d& v : shape.hull().vertices) out << "\n    " << v.transpose();
  }
  return out.str();
}

}  // namespace tandem::geometry
