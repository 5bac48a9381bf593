#include "tandem/geometry/shape.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

#include "tandem/core/contract.h"
#include "tandem/geometry/magnitude.h"

namespace tandem::geometry {

using Eigen::Isometry3d, Eigen::Matrix3d, Eigen::Vector2d, Eigen::Vector3d;

namespace {

constexpr double kPi = std::numbers::pi;
using detail::kLargest, detail::kSmallest;

/// Collects the first complaint about the arguments of one factory.
class Arguments {
 public:
  explicit Arguments(const char* shape) : shape_(shape) {}

  Arguments& finite(const char* name, const Eigen::Ref<const Eigen::VectorXd>& value) {
    require(value.allFinite(), name, value.transpose(), "must be finite");
    return require((value.array().abs() <= kLargest).all(), name, value.transpose(),
                   "must be at most 1e50 m");
  }
  Arguments& positive(const char* name, const Eigen::Ref<const Eigen::VectorXd>& value) {
    require(value.allFinite() && (value.array() > 0).all(), name, value.transpose(),
            "must be finite and > 0, or the shape has no volume");
    return require((value.array() >= kSmallest && value.array() <= kLargest).all(), name,
                   value.transpose(), "must lie between 1e-50 m and 1e50 m");
  }
  Arguments& positive(const char* name, double value) {
    return positive(name, Eigen::Matrix<double, 1, 1>(value));
  }
  Arguments& not_negative(const char* name, double value) {
    require(std::isfinite(value) && value >= 0, name, value, "must be finite and >= 0");
    return require(value <= kLargest, name, value, "must be at most 1e50 m");
  }
  Arguments& rigid(const Isometry3d& X_FC) {
    constexpr double kLoose = 1e-6;  // [-] What rounded-off input may miss orthonormality by.
    finite("position of the centre", X_FC.translation());
    const Matrix3d R_FC = X_FC.linear();
    const bool proper = R_FC.allFinite() &&
                        (R_FC.transpose() * R_FC - Matrix3d::Identity()).norm() < kLoose &&
                        R_FC.determinant() > 0;
    const Eigen::IOFormat one_line(Eigen::StreamPrecision, Eigen::DontAlignCols, " ", "; ");
    return require(proper, "rotation", R_FC.format(one_line), "must be a rotation matrix");
  }

  const std::string& complaint() const { return complaint_; }

 private:
  template <class Value>
  Arguments& require(bool holds, const char* name, const Value& value, const char* rule) {
    if (holds || !complaint_.empty()) return *this;
    std::ostringstream out;
    out << shape_ << ": " << name << " is " << value << ", " << rule;
    complaint_ = out.str();
    return *this;
  }

  const char* shape_;
  std::string complaint_;
};

Matrix3d columns(const Vector3d& u0, const Vector3d& u1 = Vector3d::Zero(),
                 const Vector3d& u2 = Vector3d::Zero()) {
  return (Matrix3d() << u0, u1, u2).finished();
}

}  // namespace

const char* to_string(CoreType type) {
  switch (type) {
    case CoreType::kPoint:
      return "point";
    case CoreType::kSegment:
      return "segment";
    case CoreType::kTriangle:
      return "triangle";
    case CoreType::kRectangle:
      return "rectangle";
    case CoreType::kBox:
      return "box";
    case CoreType::kCylinder:
      return "cylinder";
    case CoreType::kConvex:
      return "convex";
  }
  throw ContractViolation("not a core type: " + std::to_string(static_cast<int>(type)));
}

Shape::Shape(CoreType type, const Vector3d& c, const Matrix3d& u, double core_radius, double radius)
    : type_(type), c_(c), u_(u), core_radius_(core_radius), radius_(radius) {
  constexpr double kTiny = 1e-290;  // [m^2] Below this an extent is a point: its inverse overflows.
  const Vector3d squares = u_.colwise().squaredNorm();
  for (int i = 0; i < 3; ++i) inverse_squares_[i] = squares[i] > kTiny ? 1 / squares[i] : 0.0;
}

Result<Shape> Shape::sphere(const Vector3d& p_FC, double radius) {
  Arguments arguments("sphere");
  arguments.finite("centre", p_FC).positive("radius", radius);
  if (!arguments.complaint().empty()) return fail(ErrorCode::kInvalidInput, arguments.complaint());
  return Shape(CoreType::kPoint, p_FC, Matrix3d::Zero(), 0, radius);
}

Result<Shape> Shape::capsule(const Vector3d& p_FP, const Vector3d& p_FQ, double radius) {
  Arguments arguments("capsule");
  arguments.finite("end P", p_FP).finite("end Q", p_FQ).positive("radius", radius);
  if (!arguments.complaint().empty()) return fail(ErrorCode::kInvalidInput, arguments.complaint());
  return Shape(CoreType::kSegment, 0.5 * p_FP + 0.5 * p_FQ, columns(0.5 * p_FQ - 0.5 * p_FP), 0,
               radius);
}

Result<Shape> Shape::rounded_triangle(const Vector3d& p_FP, const Vector3d& p_FQ,
                                      const Vector3d& p_FR, double radius) {
  Arguments arguments("rounded triangle");
  arguments.finite("vertex P", p_FP).finite("vertex Q", p_FQ).finite("vertex R", p_FR);
  arguments.positive("radius", radius);
  if (!arguments.complaint().empty()) return fail(ErrorCode::kInvalidInput, arguments.complaint());
  return Shape(CoreType::kTriangle, p_FP, columns(p_FQ - p_FP, p_FR - p_FP), 0, radius);
}

Result<Shape> Shape::rounded_rectangle(const Isometry3d& X_FC, const Vector2d& size,
                                       double radius) {
  Arguments arguments("rounded rectangle");
  arguments.rigid(X_FC).positive("size", size).positive("radius", radius);
  if (!arguments.complaint().empty()) return fail(ErrorCode::kInvalidInput, arguments.complaint());
  const Matrix3d R_FC = X_FC.linear();
  return Shape(CoreType::kRectangle, X_FC.translation(),
               columns(0.5 * size.x() * R_FC.col(0), 0.5 * size.y() * R_FC.col(1)), 0, radius);
}

Result<Shape> Shape::box(const Isometry3d& X_FC, const Vector3d& size, double radius) {
  Arguments arguments("box");
  arguments.rigid(X_FC).positive("size", size).not_negative("radius", radius);
  if (!arguments.complaint().empty()) return fail(ErrorCode::kInvalidInput, arguments.complaint());
  return Shape(CoreType::kBox, X_FC.translation(), X_FC.linear() * (0.5 * size).asDiagonal(), 0,
               radius);
}

Result<Shape> Shape::cylinder(const Isometry3d& X_FC, double core_radius, double length,
                              double radius) {
  Arguments arguments("cylinder");
  arguments.rigid(X_FC).positive("core radius", core_radius).positive("length", length);
  arguments.not_negative("radius", radius);
  if (!arguments.complaint().empty()) return fail(ErrorCode::kInvalidInput, arguments.complaint());
  return Shape(CoreType::kCylinder, X_FC.translation(),
               columns(0.5 * length * X_FC.linear().col(2)), core_radius, radius);
}

Result<Shape> Shape::convex(std::span<const Vector3d> points_F, double radius) {
  Arguments arguments("convex shape");
  arguments.not_negative("radius", radius);
  if (!arguments.complaint().empty()) return fail(ErrorCode::kInvalidInput, arguments.complaint());
  Result<HullPoints> found = convex_hull(points_F);
  if (!found) {
    return fail(found.error().code, "convex shape: " + found.error().message);
  }
  if (radius == 0 && found->dimension < 3) {
    constexpr const char* kWhere[] = {"at one place", "on one line", "in one plane"};
    return fail(ErrorCode::kInvalidInput, std::string("convex shape: all points lie ") +
                                              kWhere[found->dimension] +
                                              ", so that it has no volume; give it a radius > 0");
  }
  if (found->dimension == 0) return sphere(found->end_a, radius);
  if (found->dimension == 1) return capsule(found->end_a, found->end_b, radius);
  Shape shape(CoreType::kConvex, found->center, Matrix3d::Identity(), 0, radius);
  shape.hull_ = std::make_shared<const ConvexHull>(std::move(found->hull));
  return shape;
}

Shape Shape::in(const Isometry3d& X_WF) const {
  Shape shape_W = *this;
  shape_W.c_ = X_WF * c_;
  const int n = size_count();
  for (int i = 0; i < n; ++i) shape_W.u_.col(i) = X_WF.linear() * u_.col(i);
  return shape_W;
}

Shape Shape::padded(double padding) const {
  expects(std::isfinite(padding) && radius_ + padding >= 0,
          "Shape::padded: the radius with padding must be finite and not negative");
  Shape shape = *this;
  shape.radius_ += padding;
  return shape;
}

Vector3d Shape::support(const Vector3d& direction) const {
  const auto side = [&](int i) { return u_.col(i).dot(direction) < 0 ? -1.0 : 1.0; };
  switch (type_) {
    case CoreType::kPoint:
      return c_;
    case CoreType::kSegment:
      return c_ + side(0) * u_.col(0);
    case CoreType::kTriangle: {
      const double q = u_.col(0).dot(direction), r = u_.col(1).dot(direction);
      if (q <= 0 && r <= 0) return c_;
      return c_ + u_.col(q >= r ? 0 : 1);
    }
    case CoreType::kRectangle:
      return c_ + side(0) * u_.col(0) + side(1) * u_.col(1);
    case CoreType::kBox:
      return c_ + side(0) * u_.col(0) + side(1) * u_.col(1) + side(2) * u_.col(2);
    case CoreType::kCylinder: {
      const Vector3d axis = u_.col(0);
      Vector3d across = direction - axis * (inverse_squares_[0] * axis.dot(direction));
      // Once more: where the direction is nearly along the axis the first residual is mostly noise.
      across -= axis * (inverse_squares_[0] * axis.dot(across));
      const double length = across.norm();
      const Vector3d end = c_ + side(0) * axis;
      // What is left of a direction along the axis is noise, and may point along it.
      constexpr double kNoise = 1e-15;
      return length > kNoise * direction.norm() ? Vector3d(end + core_radius_ / length * across)
                                                : end;
    }
    case CoreType::kConvex: {
      const int i = hull_->support(u_.transpose() * direction);
      return c_ + u_ * hull_->vertices[static_cast<std::size_t>(i)];
    }
  }
  return c_;
}

std::vector<Vector3d> Shape::hull_vertices() const {
  if (type_ == CoreType::kTriangle) return {c_, c_ + u_.col(0), c_ + u_.col(1)};
  if (type_ == CoreType::kConvex) {
    std::vector<Vector3d> vertices;
    for (const Vector3d& v : hull_->vertices) vertices.push_back(c_ + u_ * v);
    return vertices;
  }
  Matrix3d u = u_;
  int n = size_count();
  if (type_ == CoreType::kCylinder) {
    const Vector3d zhat = u_.col(0).normalized(), xhat = zhat.unitOrthogonal();
    u.col(1) = core_radius_ * xhat;
    u.col(2) = core_radius_ * zhat.cross(xhat);
    n = 3;
  }
  std::vector<Vector3d> vertices{c_};
  for (int i = 0; i < n; ++i) {
    const std::size_t count = vertices.size();
    for (std::size_t k = 0; k < count; ++k) vertices.push_back(vertices[k] + u.col(i));
    for (std::size_t k = 0; k < count; ++k) vertices[k] -= u.col(i);
  }
  return vertices;
}

Vector3d Shape::bounding_center() const {
  if (type_ == CoreType::kConvex) return c_ + u_ * hull_->bounding_center;
  if (type_ != CoreType::kTriangle) return c_;
  // Of an obtuse triangle the middle of the longest edge, else the circumcentre.
  const Vector3d q = u_.col(0), r = u_.col(1);
  const double qq = q.squaredNorm(), rr = r.squaredNorm(), qr = q.dot(r);
  if (qr <= 0) return c_ + 0.5 * (q + r);
  if (rr <= qr) return c_ + 0.5 * q;
  if (qq <= qr) return c_ + 0.5 * r;
  const double den = 2 * (qq * rr - qr * qr);
  return c_ + (rr * (qq - qr) / den) * q + (qq * (rr - qr) / den) * r;
}

double Shape::bounding_radius() const {
  if (type_ == CoreType::kConvex) return hull_->bounding_radius + radius_;
  if (type_ == CoreType::kTriangle) {
    const Vector3d p = bounding_center() - c_;
    const double square =
        std::max({p.squaredNorm(), (p - u_.col(0)).squaredNorm(), (p - u_.col(1)).squaredNorm()});
    return std::sqrt(square) + radius_;
  }
  return std::sqrt(u_.squaredNorm() + core_radius_ * core_radius_) + radius_;
}

double Shape::volume() const {
  // Steiner: core volume + surface r + (integral of mean curvature) r^2 + 4/3 pi r^3.
  const Vector3d size = 2 * u_.colwise().norm().transpose();
  const double r = radius_, core = core_radius_;
  const double ball = 4.0 / 3.0 * kPi * r * r * r;
  switch (type_) {
    case CoreType::kPoint:
      return ball;
    case CoreType::kSegment:
      return kPi * r * r * size[0] + ball;
    case CoreType::kTriangle: {
      const double perimeter = 0.5 * (size[0] + size[1]) + (u_.col(0) - u_.col(1)).norm();
      return u_.col(0).cross(u_.col(1)).norm() * r + 0.5 * kPi * perimeter * r * r + ball;
    }
    case CoreType::kRectangle:
      return 2 * size[0] * size[1] * r + kPi * (size[0] + size[1]) * r * r + ball;
    case CoreType::kBox: {
      const double surface = 2 * (size[0] * size[1] + size[1] * size[2] + size[2] * size[0]);
      return size.prod() + surface * r + kPi * size.sum() * r * r + ball;
    }
    case CoreType::kCylinder:
      return kPi * core * core * size[0] + 2 * kPi * core * (size[0] + core) * r +
             (kPi * size[0] + kPi * kPi * core) * r * r + ball;
    case CoreType::kConvex:
      return hull_->volume + hull_->surface * r + hull_->mean_width_term * r * r + ball;
  }
  return ball;
}

}  // namespace tandem::geometry
