#include "tandem/io/shapes_yaml.h"

#include <cmath>
#include <numbers>

namespace tandem::io {

namespace {

using geometry::Shape;

const std::vector<std::string>& shape_keys() {
  static const std::vector<std::string> keys{"sphere",   "capsule",          "box",
                                             "cylinder", "rounded_triangle", "rounded_rectangle"};
  return keys;
}

std::vector<std::string> with_pose(std::vector<std::string> keys) {
  keys.insert(keys.end(), pose_keys().begin(), pose_keys().end());
  return keys;
}

Eigen::Vector3d point(const YamlNode& map, const char* key) { return map.at(key).numbers(3); }

double rounding(const YamlNode& map) {
  const YamlNode* node = map.find("rounding");
  return node ? node->not_negative() : 0.0;
}

Shape read_sphere(const YamlNode& map) {
  map.only({"center", "radius"});
  return map.check(Shape::sphere(point(map, "center"), map.at("radius").positive()));
}

Shape read_capsule(const YamlNode& map) {
  map.only({"from", "to", "radius"});
  return map.check(
      Shape::capsule(point(map, "from"), point(map, "to"), map.at("radius").positive()));
}

Shape read_triangle(const YamlNode& map) {
  map.only({"a", "b", "c", "radius"});
  return map.check(Shape::rounded_triangle(point(map, "a"), point(map, "b"), point(map, "c"),
                                           map.at("radius").positive()));
}

/// Edge lengths, all above 0.
Eigen::VectorXd read_size(const YamlNode& map, Eigen::Index count) {
  const YamlNode& size = map.at("size");
  const Eigen::VectorXd lengths = size.numbers(count);
  for (const YamlNode& length : size.items()) length.positive();
  return lengths;
}

Shape read_rectangle(const YamlNode& map) {
  map.only(with_pose({"size", "radius"}));
  return map.check(
      Shape::rounded_rectangle(read_pose_in(map), read_size(map, 2), map.at("radius").positive()));
}

Shape read_box(const YamlNode& map) {
  map.only(with_pose({"size", "rounding"}));
  return map.check(Shape::box(read_pose_in(map), read_size(map, 3), rounding(map)));
}

Shape read_cylinder(const YamlNode& map) {
  map.only(with_pose({"radius", "length", "rounding"}));
  return map.check(Shape::cylinder(read_pose_in(map), map.at("radius").positive(),
                                   map.at("length").positive(), rounding(map)));
}

Shape read_shape(const std::string& kind, const YamlNode& map) {
  if (kind == "sphere") return read_sphere(map);
  if (kind == "capsule") return read_capsule(map);
  if (kind == "rounded_triangle") return read_triangle(map);
  if (kind == "rounded_rectangle") return read_rectangle(map);
  return kind == "box" ? read_box(map) : read_cylinder(map);
}

Eigen::Matrix3d read_rpy(const YamlNode& node) {
  const Eigen::Vector3d rpy = node.numbers(3) * (std::numbers::pi / 180.0);
  return (Eigen::AngleAxisd(rpy.z(), Eigen::Vector3d::UnitZ()) *
          Eigen::AngleAxisd(rpy.y(), Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(rpy.x(), Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

Eigen::Matrix3d read_quaternion(const YamlNode& node) {
  // Hand-written digits are not exactly of unit length; swapped or missing ones are far from it.
  constexpr double kUnitTolerance = 1e-3;
  const Eigen::Vector4d wxyz = node.numbers(4);
  if (std::abs(wxyz.norm() - 1.0) > kUnitTolerance) {
    node.refuse(node.label() + " has length " + std::to_string(wxyz.norm()) +
                ", it must be 1 (components w, x, y, z)");
  }
  return Eigen::Quaterniond(wxyz[0], wxyz[1], wxyz[2], wxyz[3]).normalized().toRotationMatrix();
}

}  // namespace

const std::vector<std::string>& pose_keys() {
  static const std::vector<std::string> keys{"xyz", "rpy_deg", "quat_wxyz"};
  return keys;
}

Eigen::Isometry3d read_pose_in(const YamlNode& map) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  if (const YamlNode* xyz = map.find("xyz")) X.translation() = Eigen::Vector3d(xyz->numbers(3));
  const YamlNode* rpy = map.find("rpy_deg");
  const YamlNode* quaternion = map.find("quat_wxyz");
  if (rpy && quaternion) {
    map.refuse_key("quat_wxyz", "both 'rpy_deg' and 'quat_wxyz' are given; keep one");
  }
  if (rpy) X.linear() = read_rpy(*rpy);
  if (quaternion) X.linear() = read_quaternion(*quaternion);
  return X;
}

Eigen::Isometry3d read_pose(const YamlNode& map) {
  map.only(pose_keys());
  return read_pose_in(map);
}

const std::vector<std::string>& geometry_keys() {
  static const std::vector<std::string> keys = [] {
    std::vector<std::string> all = shape_keys();
    all.insert(all.end(), {"shapes", "pose"});
    return all;
  }();
  return keys;
}

void Pieces::move(const Eigen::Isometry3d& X) {
  for (Shape& shape : shapes) shape = shape.in(X);
  for (geometry::PlacedSurface& placed : surfaces) placed.X_FS = X * placed.X_FS;
}

std::vector<Shape> read_shapes(const YamlNode& list) {
  std::vector<Shape> shapes;
  for (const YamlNode& item : list.items()) {
    item.only(shape_keys());
    const std::string& kind = item.one_of(shape_keys());
    shapes.push_back(read_shape(kind, item.at(kind)));
  }
  return shapes;
}

Pieces read_geometry(const YamlNode& map) {
  std::vector<std::string> choices = shape_keys();
  choices.push_back("shapes");
  const std::string& kind = map.one_of(choices);
  Pieces pieces;
  pieces.shapes = kind == "shapes" ? read_shapes(map.at(kind))
                                   : std::vector<Shape>{read_shape(kind, map.at(kind))};
  if (pieces.shapes.empty()) map.at(kind).refuse("shapes must not be empty; give at least one");
  if (const YamlNode* pose = map.find("pose")) pieces.move(read_pose(*pose));
  return pieces;
}

}  // namespace tandem::io
