#include "tandem/io/shapes_yaml.h"

#include <cmath>
#include <numbers>

#include "tandem/core/bounds.h"
#include "tandem/geometry/mesh_file.h"

namespace tandem::io {

namespace {

using geometry::Shape;

const std::vector<std::string>& shape_keys() {
  static const std::vector<std::string> keys{
      "sphere", "capsule", "box", "cylinder", "convex", "rounded_triangle", "rounded_rectangle"};
  return keys;
}

const std::vector<std::string>& piece_keys() {
  static const std::vector<std::string> keys = [] {
    std::vector<std::string> all = shape_keys();
    all.insert(all.end(), {"mesh", "cloud"});
    return all;
  }();
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

/// One factor or three; a negative one mirrors.
Eigen::Vector3d read_scale(const YamlNode& map) {
  const YamlNode* node = map.find("scale");
  if (!node) return Eigen::Vector3d::Ones();
  const bool one = node->kind() == YamlNode::Kind::kScalar;
  const Eigen::Vector3d scale =
      one ? Eigen::Vector3d::Constant(node->number()) : Eigen::Vector3d(node->numbers(3));
  if ((scale.array() == 0).any()) node->refuse("scale: no factor may be 0");
  return scale;
}

double read_radius(const YamlNode& map) {
  const YamlNode* node = map.find("radius");
  return node ? node->not_negative() : 0.0;
}

std::vector<Eigen::Vector3d> read_points(const YamlNode& list) {
  std::vector<Eigen::Vector3d> points;
  for (const YamlNode& item : list.items()) points.emplace_back(item.numbers(3));
  return points;
}

Shape read_convex(const YamlNode& map, const NamedPaths& paths) {
  map.only(with_pose({"file", "points", "scale", "radius"}));
  std::vector<Eigen::Vector3d> points_C;
  const Eigen::Vector3d scale = read_scale(map);
  if (map.one_of({"file", "points"}) == "file") {
    const YamlNode& file = map.at("file");
    points_C = file.check(geometry::read_mesh(paths.file(file), scale)).vertices;
  } else {
    points_C = read_points(map.at("points"));
    for (Eigen::Vector3d& point : points_C) point = point.cwiseProduct(scale);
  }
  return map.check(Shape::convex(points_C, read_radius(map))).in(read_pose_in(map));
}

geometry::PlacedSurface read_mesh(const YamlNode& map, const NamedPaths& paths) {
  map.only(with_pose({"file", "scale", "radius"}));
  const YamlNode& file = map.at("file");
  geometry::TriangleMesh mesh = file.check(geometry::read_mesh(paths.file(file), read_scale(map)));
  return {map.check(geometry::Surface::mesh(std::move(mesh.vertices), std::move(mesh.triangles),
                                            read_radius(map))),
          read_pose_in(map)};
}

geometry::PlacedSurface read_cloud(const YamlNode& map, const NamedPaths& paths) {
  map.only(with_pose({"file", "radius"}));
  const YamlNode& file = map.at("file");
  const double radius = map.at("radius").positive();
  return {map.check(
              geometry::Surface::cloud(file.check(geometry::read_cloud(paths.file(file))), radius)),
          read_pose_in(map)};
}

Shape read_shape(const std::string& kind, const YamlNode& map, const NamedPaths& paths) {
  if (kind == "convex") return read_convex(map, paths);
  if (kind == "sphere") return read_sphere(map);
  if (kind == "capsule") return read_capsule(map);
  if (kind == "rounded_triangle") return read_triangle(map);
  if (kind == "rounded_rectangle") return read_rectangle(map);
  return kind == "box" ? read_box(map) : read_cylinder(map);
}

Eigen::Vector3d read_position(const YamlNode& node) {
  const Eigen::Vector3d xyz = node.numbers(3);
  if (xyz.cwiseAbs().maxCoeff() > kFarthest) {
    node.refuse(node.label() + " is farther than 1e8 m; are these metres?");
  }
  return xyz;
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
  if (const YamlNode* xyz = map.find("xyz")) X.translation() = read_position(*xyz);
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
    std::vector<std::string> all = piece_keys();
    all.insert(all.end(), {"shapes", "pose"});
    return all;
  }();
  return keys;
}

void Pieces::move(const Eigen::Isometry3d& X) {
  for (Shape& shape : shapes) shape = shape.in(X);
  for (geometry::PlacedSurface& placed : surfaces) placed.X_FS = X * placed.X_FS;
}

std::vector<Shape> read_shapes(const YamlNode& list, const NamedPaths& paths) {
  std::vector<Shape> shapes;
  for (const YamlNode& item : list.items()) {
    for (const char* surface : {"mesh", "cloud"}) {
      if (!item.find(surface)) continue;
      item.refuse_key(surface, std::string("a ") + surface +
                                   " is no volume; use its hull, `convex: {file: ...}`, or fit "
                                   "volumes to it");
    }
    item.only(shape_keys());
    const std::string& kind = item.one_of(shape_keys());
    shapes.push_back(read_shape(kind, item.at(kind), paths));
  }
  return shapes;
}

namespace {

/// Appends the piece of a map that has exactly one.
void read_piece(const YamlNode& map, const std::string& kind, const NamedPaths& paths,
                Pieces& pieces) {
  if (kind == "mesh") {
    pieces.surfaces.push_back(read_mesh(map.at(kind), paths));
  } else if (kind == "cloud") {
    pieces.surfaces.push_back(read_cloud(map.at(kind), paths));
  } else {
    pieces.shapes.push_back(read_shape(kind, map.at(kind), paths));
  }
}

}  // namespace

Pieces read_geometry(const YamlNode& map, const NamedPaths& paths) {
  std::vector<std::string> choices = piece_keys();
  choices.push_back("shapes");
  const std::string& kind = map.one_of(choices);
  Pieces pieces;
  if (kind != "shapes") {
    read_piece(map, kind, paths, pieces);
  } else {
    const YamlNode& list = map.at(kind);
    if (list.items().empty()) list.refuse("shapes must not be empty; give at least one");
    for (const YamlNode& item : list.items()) {
      item.only(piece_keys());
      read_piece(item, item.one_of(piece_keys()), paths, pieces);
    }
  }
  if (const YamlNode* pose = map.find("pose")) pieces.move(read_pose(*pose));
  return pieces;
}

}  // namespace tandem::io
