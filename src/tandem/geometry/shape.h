#pragma once
/// Convex shapes: a core (point, segment, triangle, rectangle, box, cylinder, convex polytope)
/// swept by a sphere.

#include <Eigen/Geometry>
#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "tandem/core/contract.h"
#include "tandem/core/result.h"
#include "tandem/geometry/convex_hull.h"

namespace tandem::geometry {

/// Kind of a shape's core. With a positive radius: sphere, capsule, rounded triangle, rounded
/// rectangle, rounded box, rounded cylinder, rounded polytope.
enum class CoreType { kPoint, kSegment, kTriangle, kRectangle, kBox, kCylinder, kConvex };

/// "point", "segment", ...
const char* to_string(CoreType type);

/// All points within `radius` of a convex core, fixed in a frame F.
///
/// Point, segment, rectangle and box cores are {c + s0 u0 + s1 u1 + s2 u2, |si| <= 1} with
/// `size_count()` (0 to 3) mutually orthogonal half-extent vectors u. A triangle is
/// {c + s0 u0 + s1 u1, si >= 0, s0 + s1 <= 1}: c is its first vertex, u its edges from there.
/// A cylinder is {c + s0 u0 + y, |s0| <= 1, y normal to u0, |y| <= core_radius}.
/// A convex core is {c + u p, p in hull()}: u is the rotation of the frame H of its hull, which all
/// copies share.
/// Instances carry their frame in the name: `shape_L` on a link, `shape_W` in the world.
class Shape {
 public:
  /// @param p_FC  centre from Fo, expressed in F [m].   @param radius [m], > 0.
  /// Every factory: kInvalidInput with the value if one is not finite or beyond 1e50 m, a radius is
  /// negative, a pose not rigid, or there is no volume (sizes < 1e-50 m). P = Q is a valid capsule.
  static Result<Shape> sphere(const Eigen::Vector3d& p_FC, double radius);
  static Result<Shape> capsule(const Eigen::Vector3d& p_FP, const Eigen::Vector3d& p_FQ,
                               double radius);
  static Result<Shape> rounded_triangle(const Eigen::Vector3d& p_FP, const Eigen::Vector3d& p_FQ,
                                        const Eigen::Vector3d& p_FR, double radius);
  /// @param X_FC   pose of the centre frame; the rectangle spans x and y of C.
  /// @param size   full edge lengths of the core along x and y of C [m], > 0.
  static Result<Shape> rounded_rectangle(const Eigen::Isometry3d& X_FC, const Eigen::Vector2d& size,
                                         double radius);
  /// @param size   full edge lengths of the core [m], > 0.   @param radius [m], >= 0 rounds it
  ///               outward.
  static Result<Shape> box(const Eigen::Isometry3d& X_FC, const Eigen::Vector3d& size,
                           double radius = 0);
  /// Axis along z of C, flat ends.
  /// @param core_radius [m] > 0.  @param length [m] > 0.  @param radius [m], >= 0 rounds it
  /// outward.
  static Result<Shape> cylinder(const Eigen::Isometry3d& X_FC, double core_radius, double length,
                                double radius = 0);

  /// The convex hull of any points, at least one. Where all of them lie on one line, or at one
  /// place, a capsule or a sphere.
  /// @param radius [m], >= 0; > 0 if the points are all in one plane.
  static Result<Shape> convex(std::span<const Eigen::Vector3d> points_F, double radius = 0);

  CoreType type() const { return type_; }
  const Eigen::Vector3d& origin() const { return c_; }
  /// Columns are the vectors u above; those past `size_count()` are zero.
  const Eigen::Matrix3d& extents() const { return u_; }
  /// 1 / |u|^2 of every extent [1/m^2], 0 where it is zero: what makes projections on u cheap.
  const Eigen::Vector3d& inverse_squares() const { return inverse_squares_; }
  int size_count() const {
    constexpr int kCounts[] = {0, 1, 2, 2, 3, 1, 3};
    return kCounts[static_cast<int>(type_)];
  }
  double radius() const { return radius_; }
  double core_radius() const { return core_radius_; }
  /// Vertices and faces of a convex core in its frame H; of other cores there is none.
  const ConvexHull& hull() const {
    expects(hull_ != nullptr, "Shape::hull: only a convex core has one");
    return *hull_;
  }

  /// Same shape seen from W: `shape_W = shape_L.in(X_WL)`.
  Shape in(const Eigen::Isometry3d& X_WF) const;
  /// Same shape, swept by `padding` more [m]; the resulting radius must not be negative.
  Shape padded(double padding) const;

  /// The point of the core furthest along `direction`, which need not be a unit vector.
  Eigen::Vector3d support(const Eigen::Vector3d& direction) const;
  /// Core vertices (1, 2, 3, 4, 8 or those of the hull); a cylinder has the 8 corners of the box
  /// around its core, so that "every vertex inside" is safe for every type.
  std::vector<Eigen::Vector3d> hull_vertices() const;
  /// Smallest sphere about `bounding_center()` that contains the whole shape [m]; of a convex core
  /// the centre is nearly the best.
  Eigen::Vector3d bounding_center() const;
  double bounding_radius() const;
  double volume() const;  ///< [m^3]

 private:
  friend class Surface;  // Its triangles need no radius.
  Shape(CoreType type, const Eigen::Vector3d& c, const Eigen::Matrix3d& u, double core_radius,
        double radius);

  CoreType type_;
  Eigen::Vector3d c_;
  Eigen::Matrix3d u_;
  Eigen::Vector3d inverse_squares_;
  double core_radius_;  // Of a cylinder, else 0.
  double radius_;
  std::shared_ptr<const ConvexHull> hull_;  // Of a convex core.
};

}  // namespace tandem::geometry
