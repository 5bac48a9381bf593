#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>

#include "tandem/io/moveit_scene.h"

namespace tandem::io {

namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using geometry::CoreType;
using geometry::Shape;

std::string numbers(std::initializer_list<double> values) {
  std::string line;
  for (const double value : values) {
    std::array<char, 32> digits;
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
    if (!line.empty()) line += ' ';
    line.append(digits.data(), end);
  }
  return line + "\n";
}

std::string numbers(const Vector3d& v) { return numbers({v.x(), v.y(), v.z()}); }

std::string pose_lines(const Isometry3d& X) {
  const Eigen::Quaterniond q(X.linear());
  return numbers(X.translation()) + numbers({q.x(), q.y(), q.z(), q.w()});
}

Isometry3d pose(const Matrix3d& R, const Vector3d& p) {
  Isometry3d X = Isometry3d::Identity();
  X.linear() = R;
  X.translation() = p;
  return X;
}

/// A rotation whose z is along `axis`, which is not zero.
Matrix3d turned_to(const Vector3d& axis) {
  return Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), axis).toRotationMatrix();
}

/// One of MoveIt's shapes: its lines, and where it is.
struct Piece {
  std::string lines;
  Isometry3d X_WS;
};

/// A mesh in the making, seen from So with the world's axes.
struct Mesh {
  Vector3d p_WS;
  std::vector<Vector3d> vertices;
  std::vector<std::array<int, 3>> triangles;

  /// Everything within `r` of a triangle, along its normal; nothing if it has no area.
  void add_prism(const Vector3d& a, const Vector3d& b, const Vector3d& c, double r) {
    const Vector3d n = (b - a).cross(c - a);
    if (n.isZero(0)) return;
    const Vector3d up = r * n.normalized();
    const int first = static_cast<int>(vertices.size());
    for (const double side : {-1.0, 1.0}) {
      for (const Vector3d& corner : {a, b, c}) vertices.push_back(corner - p_WS + side * up);
    }
    constexpr int kFaces[8][3] = {{0, 2, 1}, {3, 4, 5}, {0, 1, 4}, {0, 4, 3},
                                  {1, 2, 5}, {1, 5, 4}, {2, 0, 3}, {2, 3, 5}};
    for (const auto& [i, j, k] : kFaces) triangles.push_back({first + i, first + j, first + k});
  }
};

/// MoveIt's shapes that make up one obstacle.
class Pieces {
 public:
  void add(const Shape& shape) {
    switch (shape.type()) {
      case CoreType::kTriangle:
        return add_triangle(shape);
      case CoreType::kCylinder:
        return add_rounded_cylinder(shape);
      case CoreType::kConvex:
        return add_polytope(shape);
      case CoreType::kPoint:
      case CoreType::kSegment:
      case CoreType::kRectangle:
      case CoreType::kBox:
        return add_orthotope(shape);
    }
  }

  void add(const geometry::PlacedSurface& placed) {
    const geometry::Surface& surface = *placed.surface;
    if (!surface.is_mesh()) {
      for (const Vector3d& p_S : surface.vertices()) sphere(placed.X_FS * p_S, surface.radius());
      return;
    }
    if (surface.radius() > 0) note("a mesh is exported without the radius swept around it");
    add_mesh(surface.vertices(), surface.triangles(), placed.X_FS);
  }

  const std::vector<Piece>& all() const { return pieces_; }
  const std::vector<std::string>& notes() const { return notes_; }

 private:
  void note(const std::string& text) {
    if (std::ranges::find(notes_, text) == notes_.end()) notes_.push_back(text);
  }
  void sphere(const Vector3d& p_WC, double radius) {
    pieces_.push_back({"sphere\n" + numbers({radius}), pose(Matrix3d::Identity(), p_WC)});
  }
  void box(const Isometry3d& X_WC, const Vector3d& size) {
    pieces_.push_back({"box\n" + numbers(size), X_WC});
  }
  /// @param half  from the middle to the centre of an end, not zero.
  void cylinder(const Vector3d& p_WC, const Vector3d& half, double radius, double length) {
    pieces_.push_back({"cylinder\n" + numbers({radius, length}), pose(turned_to(half), p_WC)});
  }
  /// Everything within `r` of the line from a to b, without its ends.
  void add_edge(const Vector3d& a, const Vector3d& b, double r) {
    if (a != b) cylinder((a + b) / 2, (b - a) / 2, r, (b - a).norm());
  }
  void add_mesh(const Mesh& mesh) {
    add_mesh(mesh.vertices, mesh.triangles, pose(Matrix3d::Identity(), mesh.p_WS));
  }
  void add_mesh(const std::vector<Vector3d>& vertices,
                const std::vector<std::array<int, 3>>& triangles, const Isometry3d& X_WS) {
    std::string lines =
        "mesh\n" + std::to_string(vertices.size()) + " " + std::to_string(triangles.size()) + "\n";
    for (const Vector3d& vertex : vertices) lines += numbers(vertex);
    for (const auto& [a, b, c] : triangles) {
      lines += std::to_string(a) + " " + std::to_string(b) + " " + std::to_string(c) + "\n";
    }
    pieces_.push_back({std::move(lines), X_WS});
  }

  /// A point, segment, rectangle or box with a ball swept around it: balls at its corners,
  /// cylinders along its edges, and what lies over its faces.
  void add_orthotope(const Shape& shape) {
    const Matrix3d& u = shape.extents();
    const int count = shape.size_count();
    const double r = shape.radius();
    if (r > 0) {
      for (const Vector3d& corner : shape.hull_vertices()) sphere(corner, r);
      for (int i = 0; i < count; ++i) add_edges(shape, i);
    }
    if (count < 2) return;
    Matrix3d R;
    R.col(0) = u.col(0).normalized();
    R.col(1) = u.col(1).normalized();
    R.col(2) = R.col(0).cross(R.col(1));
    const Isometry3d X_WC = pose(R, shape.origin());
    const Vector3d size = 2 * u.colwise().norm().transpose();
    if (r == 0) return box(X_WC, size);
    for (int i = count == 2 ? 2 : 0; i < 3; ++i) box(X_WC, size + 2 * r * Vector3d::Unit(i));
  }

  /// Cylinders around the core's edges along extent `i`.
  void add_edges(const Shape& shape, int i) {
    const Matrix3d& u = shape.extents();
    const int others = shape.size_count() - 1;
    for (int signs = 0; signs < 1 << others; ++signs) {
      Vector3d middle = shape.origin();
      for (int k = 0; k < others; ++k) {
        const int other = (i + 1 + k) % shape.size_count();
        middle += (signs >> k & 1 ? 1.0 : -1.0) * u.col(other);
      }
      add_edge(middle - u.col(i), middle + u.col(i), shape.radius());
    }
  }

  void add_triangle(const Shape& shape) {
    const std::vector<Vector3d> corners = shape.hull_vertices();
    const double r = shape.radius();
    for (std::size_t k = 0; r > 0 && k < 3; ++k) {
      sphere(corners[k], r);
      add_edge(corners[k], corners[(k + 1) % 3], r);
    }
    Mesh prism{corners[0], {}, {}};
    prism.add_prism(corners[0], corners[1], corners[2], r);
    if (!prism.triangles.empty()) add_mesh(prism);
  }

  /// The polytope, and with a ball swept around it what lies over its faces, edges and corners.
  void add_polytope(const Shape& shape) {
    const geometry::ConvexHull& hull = shape.hull();
    const std::vector<Vector3d> corners = shape.hull_vertices();
    const double r = shape.radius();
    const auto at = [&corners](int i) -> const Vector3d& {
      return corners[static_cast<std::size_t>(i)];
    };
    Mesh mesh{shape.origin(), {}, hull.triangles};
    for (const Vector3d& corner : corners) mesh.vertices.push_back(corner - mesh.p_WS);
    if (r > 0) {
      for (const Vector3d& corner : corners) sphere(corner, r);
      for (const auto& [a, b] : hull.edges) add_edge(at(a), at(b), r);
      for (const auto& [a, b, c] : hull.triangles) mesh.add_prism(at(a), at(b), at(c), r);
    }
    add_mesh(mesh);
  }

  void add_rounded_cylinder(const Shape& shape) {
    const double r = shape.radius();
    if (r > 0) note("a rounded cylinder is exported as the cylinder around it");
    const Vector3d half = shape.extents().col(0);
    cylinder(shape.origin(), half, shape.core_radius() + r, 2 * (half.norm() + r));
  }

  std::vector<Piece> pieces_;
  std::vector<std::string> notes_;
};

bool fits_a_line(const std::string& name) {
  return !name.empty() && name.find_first_of("\r\n") == std::string::npos &&
         !std::isspace(static_cast<unsigned char>(name.front())) &&
         !std::isspace(static_cast<unsigned char>(name.back()));
}

/// The object stands where its first piece is.
void write_object(const std::string& name, const std::vector<Piece>& pieces, std::string& text) {
  const Isometry3d& X_WO = pieces.front().X_WS;
  text += "* " + name + "\n" + pose_lines(X_WO) + std::to_string(pieces.size()) + "\n";
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const Isometry3d X_OS = i == 0 ? Isometry3d::Identity() : X_WO.inverse() * pieces[i].X_WS;
    text += pieces[i].lines + pose_lines(X_OS) + "0 0 0 0\n";
  }
  text += "0\n";  // Subframes.
}

}  // namespace

Result<MoveitSceneText> moveit_scene_text(const std::string& name,
                                          const std::vector<world::ObstacleSpec>& obstacles) {
  MoveitSceneText scene;
  const auto refused = [](const std::string& what) {
    return fail(ErrorCode::kInvalidInput,
                "the name '" + what +
                    "' cannot be written into a scene, where it must fill a line; rename it");
  };
  if (!fits_a_line(name)) return refused(name);
  scene.text = name + "\n";
  for (const world::ObstacleSpec& obstacle : obstacles) {
    if (!fits_a_line(obstacle.name)) return refused(obstacle.name);
    Pieces pieces;
    for (const Shape& shape : obstacle.shapes_W) pieces.add(shape);
    for (const geometry::PlacedSurface& surface : obstacle.surfaces_W) pieces.add(surface);
    if (pieces.all().empty()) continue;
    write_object(obstacle.name, pieces.all(), scene.text);
    for (const std::string& note : pieces.notes())
      scene.notes.push_back(obstacle.name + ": " + note);
  }
  scene.text += ".\n";
  return scene;
}

}  // namespace tandem::io
