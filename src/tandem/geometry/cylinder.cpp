#include "tandem/geometry/cylinder.h"

#include <cmath>

#include "tandem/geometry/cylinder_pair.h"
#include "tandem/geometry/polytope.h"
#include "tandem/geometry/root.h"

namespace tandem::geometry::detail {

using Eigen::Vector3d;

namespace {

/// Position about a cylinder's centre, split by its axis.
struct AxisSplit {
  double along;
  Vector3d across;
};

/// A cylinder's numbers in the form that its queries use.
struct Axis {
  explicit Axis(const Shape& shape)
      : half_length(shape.extents().col(0).norm()),
        zhat(shape.extents().col(0) / half_length),
        radius(shape.core_radius()) {}

  AxisSplit split(const Vector3d& r) const {
    const double along = zhat.dot(r);
    return {along, r - along * zhat};
  }
  double beyond_end(double along) const {
    return along - std::clamp(along, -half_length, half_length);
  }

  double half_length;
  Vector3d zhat;
  double radius;
};

Nearest nearest_to_axis(const Vector3d& r, const Vector3d& c, const Axis& axis) {
  const auto [along, across] = axis.split(r);
  const double distance = across.norm();
  Vector3d e = axis.beyond_end(along) * axis.zhat;
  if (distance > axis.radius) e += (1 - axis.radius / distance) * across;
  return {c + (r - e), e, e.squaredNorm()};
}

/// The parameter of the point of {r + t d, |t| <= 1} nearest to the cylinder about the origin.
///
/// Half the derivative of the squared distance never decreases. It is bracketed between the
/// points where the line crosses the planes of the ends and the infinite side; what is left is
/// smooth.
double nearest_parameter(const Vector3d& r, const Vector3d& d, const Axis& axis) {
  const auto [a0, r0] = axis.split(r);
  const auto [a1, r1] = axis.split(d);
  const double r1r1 = r1.squaredNorm(), r0r1 = r0.dot(r1);
  const auto derivative = [&](double t) -> Slope {
    const double beyond = axis.beyond_end(a0 + t * a1);
    Slope sum{a1 * beyond, beyond == 0 ? 0.0 : a1 * a1};
    const double distance = (r0 + t * r1).norm();
    if (distance > axis.radius) {
      const double outside = 1 - axis.radius / distance, rate = r0r1 + t * r1r1;
      sum.value += outside * rate;
      sum.derivative +=
          outside * r1r1 + axis.radius * rate * rate / (distance * distance * distance);
    }
    return sum;
  };
  double low = -1, high = 1;
  if (derivative(low).value >= 0) return low;
  if (derivative(high).value <= 0) return high;
  const double nearest = -r0r1 / r1r1;  // To the infinite axis: there a break has its middle.
  const double chord = std::sqrt(
      std::max(0.0, (axis.radius * axis.radius - (r0 + nearest * r1).squaredNorm()) / r1r1));
  for (const double t : {(-axis.half_length - a0) / a1, (axis.half_length - a0) / a1,
                         nearest - chord, nearest + chord}) {
    if (t > low && t < high) (derivative(t).value < 0 ? low : high) = t;
  }
  return increasing_root(low, high, derivative);
}

/// Upper bounds from the faces of a polytope that the cylinder's extreme points lie over.
template <class NearestToA>
void keep_face_contacts(const Shape& b, const Vector3d* normals, int count,
                        const NearestToA& nearest_to_a, Nearest& best) {
  for (int i = 0; i < count; ++i) {
    for (const Vector3d& n : {Vector3d(normals[i]), Vector3d(-normals[i])}) {
      keep_nearer(best, nearest_to_a(b.support(n)).swapped());
    }
  }
}

}  // namespace

Nearest nearest_point_cylinder(const Vector3d& p, const Shape& b) {
  return nearest_to_axis(p - b.origin(), b.origin(), Axis(b));
}

Nearest nearest_segment_cylinder(const Segment& a, const Shape& b) {
  const Axis axis(b);
  const Vector3d r = a.c - b.origin();
  return nearest_to_axis(r + nearest_parameter(r, a.u, axis) * a.u, b.origin(), axis);
}

Nearest nearest_with_cylinder(const Shape& a, const Shape& b) {
  if (a.type() == CoreType::kCylinder) return nearest_cylinders(a, b);
  Nearest best;
  const auto keep_edges = [&](const auto& edges) {
    for (const Segment& edge : edges) {
      if (!is_touch(best)) keep_nearer(best, nearest_segment_cylinder(edge, b));
    }
  };
  const auto& u = a.extents();
  switch (a.type()) {
    case CoreType::kTriangle: {
      const Triangle triangle(a);
      keep_edges(triangle.edges);
      keep_face_contacts(
          b, &triangle.n, 1, [&](const Vector3d& p) { return nearest_point_triangle(p, triangle); },
          best);
      break;
    }
    case CoreType::kRectangle: {
      const Vector3d n = u.col(0).cross(u.col(1));
      keep_edges(Edges(a));
      keep_face_contacts(
          b, &n, 1, [&](const Vector3d& p) { return nearest_point_orthotope<2>(p, a); }, best);
      break;
    }
    default: {
      const Vector3d normals[] = {u.col(0), u.col(1), u.col(2)};
      keep_edges(Edges(a));
      keep_face_contacts(
          b, normals, 3, [&](const Vector3d& p) { return nearest_point_orthotope<3>(p, a); }, best);
    }
  }
  return best;
}

namespace {

/// Where an edge touches the rim of a cylinder's end: directions normal to the edge along which
/// the ellipse, that the rim is when seen along the edge, is least in the way.
///
/// With m the normal to edge and axis, b the direction of the axis across the edge, and the
/// direction tau m + s b (s = 1 or -1 says which end), the extent's derivative in tau is
/// -o.m + s (o.b) tau + c tau / sqrt(R^2 tau^2 + beta^2) but for a positive factor, where o leads
/// from the ellipse to the edge, beta is the minor semi-axis and c = R^2 - beta^2. It has at most
/// one zero where it increases.
void consider_rims(const Segment& edge, const Shape& cylinder, DirectionSearch& search) {
  const Axis axis(cylinder);
  const double length = edge.u.norm();
  if (!(length > 0)) return;
  const Vector3d along = edge.u / length, cross = accurate_cross(axis.zhat, along);
  const double sine = cross.norm(), radius = axis.radius;
  const Vector3d m = sine > 0 ? Vector3d(cross / sine) : along.unitOrthogonal();
  Vector3d b = along.cross(m);
  if (b.dot(axis.zhat) < 0) b = -b;
  const double beta = radius * axis.zhat.dot(along), beta2 = beta * beta,
               c = radius * radius * sine * sine;
  for (const double s : {1.0, -1.0}) {
    const Vector3d o = edge.c - cylinder.origin() - s * axis.half_length * axis.zhat;
    const double om = std::abs(o.dot(m)), ob = s * o.dot(b), side = o.dot(m) < 0 ? -1.0 : 1.0;
    // Where the zero were if ob vanished; infinite where then there were none.
    const double room = c * c - radius * radius * om * om;
    const double level = room > 0 ? std::sqrt(beta2 / room) * om : HUGE_VAL;
    double low = 0, high = level;
    if (ob > 0) {
      high = std::min(level, om / ob);
    } else if (ob < 0) {
      if (!(level < HUGE_VAL)) continue;
      low = level;
      const double rho = std::cbrt(c * beta2 / -ob);  // Where the derivative is greatest.
      high = std::sqrt(std::max(0.0, rho * rho - beta2)) / radius;
    } else {
      low = level;
    }
    if (!(low <= high && high < HUGE_VAL)) continue;
    const auto derivative = [&](double tau) -> Slope {
      const double rho = std::sqrt(radius * radius * tau * tau + beta2);
      if (!(rho > 0)) return {-om, HUGE_VAL};
      return {-om + ob * tau + c * tau / rho, ob + c * beta2 / (rho * rho * rho)};
    };
    if (derivative(high).value < 0 && ob < 0) continue;
    search.consider(side * increasing_root(low, high, derivative) * m + s * b);
  }
}

/// Where an edge or a corner touches the side of a cylinder: away from the axis.
void consider_side(const Segment& edge, const Shape& cylinder, DirectionSearch& search) {
  const Axis axis(cylinder);
  const Vector3d r = axis.split(edge.c - cylinder.origin()).across;
  const Vector3d u = axis.split(edge.u).across;
  const double uu = u.squaredNorm();
  const double t = uu > 0 ? std::clamp(-r.dot(u) / uu, -1.0, 1.0) : 0.0;
  // Split once more: near the axis, noise along it would be a large part of the little there is.
  search.consider(axis.split(r + t * u).across);
}

}  // namespace

void search_curved(const Shape& a, const Shape& b, DirectionSearch& search) {
  const auto search_edges = [&](const Shape& other, const Shape& cylinder) {
    if (cylinder.type() != CoreType::kCylinder) return;
    for (const Segment& edge : Edges(other)) {
      consider_side(edge, cylinder, search);
      consider_rims(edge, cylinder, search);
    }
  };
  search_edges(a, b);
  search_edges(b, a);
  if (a.type() == b.type()) search_rim_pairs(a, b, search);
}

}  // namespace tandem::geometry::detail
