#include <cstdio>
#include <sstream>

#include "tandem/io/volumes_file.h"

namespace tandem::io {

namespace {

using Eigen::Vector3d;
using geometry::CoreType;
using geometry::Shape;

/// Fixed notation without needless zeros.
std::string number(double value) {
  char text[64];
  std::snprintf(text, sizeof(text), "%.9f", value);
  std::string trimmed = text;
  trimmed.erase(trimmed.find_last_not_of('0') + 1);
  if (trimmed.back() == '.') trimmed.pop_back();
  return trimmed == "-0" ? "0" : trimmed;
}

template <class Vector>
std::string list(const Vector& values) {
  std::string text = "[";
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    text += (i == 0 ? "" : ", ") + number(values[i]);
  }
  return text + "]";
}

std::string pose(const Vector3d& center, const Eigen::Matrix3d& axes) {
  std::string text = ", xyz: " + list(center);
  if (axes.isIdentity(1e-12)) return text;
  const Eigen::Quaterniond q(axes);
  return text + ", quat_wxyz: " + list(Eigen::Vector4d(q.w(), q.x(), q.y(), q.z()));
}

std::string rounding(const Shape& shape) {
  return shape.radius() > 0 ? ", rounding: " + number(shape.radius()) : "";
}

std::string cylinder(const Shape& shape) {
  const Vector3d u = shape.extents().col(0);
  Eigen::Matrix3d axes;
  axes.col(2) = u.normalized();
  axes.col(0) = axes.col(2).unitOrthogonal();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  if (axes.col(2).isApprox(Vector3d::UnitZ(), 1e-12)) axes.setIdentity();
  return "cylinder: {radius: " + number(shape.core_radius()) + ", length: " + number(2 * u.norm()) +
         rounding(shape) + pose(shape.origin(), axes) + "}";
}

std::string orthotope(const Shape& shape) {
  const bool is_box = shape.type() == CoreType::kBox;
  Eigen::Matrix3d axes;
  axes.col(0) = shape.extents().col(0).normalized();
  axes.col(1) = shape.extents().col(1).normalized();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  const Vector3d size = 2 * shape.extents().colwise().norm().transpose();
  if (!is_box) {
    return "rounded_rectangle: {size: " + list(size.head<2>()) +
           ", radius: " + number(shape.radius()) + pose(shape.origin(), axes) + "}";
  }
  return "box: {size: " + list(size) + rounding(shape) + pose(shape.origin(), axes) + "}";
}

std::string shape_text(const Shape& shape) {
  const Vector3d& c = shape.origin();
  const auto u = shape.extents();
  const std::string radius = ", radius: " + number(shape.radius()) + "}";
  switch (shape.type()) {
    case CoreType::kPoint:
      return "sphere: {center: " + list(c) + radius;
    case CoreType::kSegment:
      return "capsule: {from: " + list(c - u.col(0)) + ", to: " + list(c + u.col(0)) + radius;
    case CoreType::kTriangle:
      return "rounded_triangle: {a: " + list(c) + ", b: " + list(c + u.col(0)) +
             ", c: " + list(c + u.col(1)) + radius;
    case CoreType::kCylinder:
      return cylinder(shape);
    default:
      return orthotope(shape);
  }
}

}  // namespace

std::string volumes_text(const std::string& comment, const std::vector<VolumesEntry>& entries) {
  std::string text;
  std::istringstream lines(comment);
  for (std::string line; std::getline(lines, line);) text += "# " + line + "\n";
  text += entries.empty() ? "links: {}\n" : "links:\n";
  for (const VolumesEntry& entry : entries) {
    if (!entry.comment.empty()) text += "  # " + entry.comment + "\n";
    text += "  " + entry.link + ":\n";
    for (const Shape& shape : entry.shapes_L) text += "    - " + shape_text(shape) + "\n";
  }
  return text;
}

}  // namespace tandem::io
