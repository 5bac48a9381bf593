#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "tandem/collision/ssv_model.h"
#include "tandem/geometry/bounding_tree.h"
#include "tandem/geometry/distance.h"

namespace tandem::collision {

namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using geometry::BoundingTree;
using geometry::CoreType;
using geometry::Shape;
using geometry::Surface;
using Sphere = BoundingTree::Sphere;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::size_t index(int i) { return static_cast<std::size_t>(i); }

/// Right-handed rows that span the core's box: along its extents where it has some.
Matrix3d box_axes(const Shape& shape) {
  const Matrix3d& u = shape.extents();
  if (shape.size_count() == 0) return Matrix3d::Identity();
  const Vector3d x = u.col(0).normalized();
  Vector3d y = x.unitOrthogonal();
  if (shape.size_count() > 1) y = (u.col(1) - x.dot(u.col(1)) * x).normalized();
  Matrix3d R;
  R << x.transpose(), y.transpose(), x.cross(y).transpose();
  return R;
}

SsvShape compile_shape(const Shape& shape_J, int slot) {
  SsvShape compiled{shape_J, slot, shape_J.hull_vertices(), box_axes(shape_J), {}, {}};
  Vector3d low = Vector3d::Constant(kInfinity), high = -low;
  for (const Matrix3d& R = compiled.R_BJ; const Vector3d& p_J : compiled.vertices_J) {
    low = low.cwiseMin(R * p_J);
    high = high.cwiseMax(R * p_J);
  }
  if (shape_J.type() == CoreType::kCylinder) {  // Its hull's corners may lie askew to the box.
    const Vector3d center = compiled.R_BJ * shape_J.origin();
    const double half_length = shape_J.extents().col(0).norm();
    const Vector3d half(half_length, shape_J.core_radius(), shape_J.core_radius());
    low = center - half;
    high = center + half;
  }
  compiled.p_JBo = compiled.R_BJ.transpose() * (0.5 * (low + high));
  compiled.half = 0.5 * (high - low);
  return compiled;
}

SsvSurface compile_surface(const geometry::PlacedSurface& placed, const Isometry3d& X_JL,
                           double padding) {
  Vector3d low = Vector3d::Constant(kInfinity), high = -low;
  for (const Vector3d& p_S : placed.surface->vertices()) {
    low = low.cwiseMin(p_S);
    high = high.cwiseMax(p_S);
  }
  return {placed.surface, X_JL * placed.X_FS, padding, 0.5 * (low + high), 0.5 * (high - low)};
}

/// A body while it is compiled. Its pieces are numbered shapes first, then surface by surface.
class BodyCompiler {
 public:
  BodyCompiler(SsvModel& model, const SsvBody& body) : model_(model), body_(body) {}

  void compile(bool with_anchors);

 private:
  /// Which surface a piece is of, -1 for a shape, and its index there.
  struct Origin {
    int surface;
    int piece;
  };
  Origin origin(int piece) const;
  const SsvSurface& surface(int index_) const { return model_.surfaces[index(index_)]; }
  void add_spheres();
  template <class F>
  void for_each_ball(int piece, F&& f) const;
  Sphere tightened(const BoundingTree& tree, const BoundingTree::Node& node) const;
  std::vector<bool> find_anchors() const;
  void join_shapes(std::vector<int>& group) const;
  void join_triangles(int surface, std::vector<int>& group) const;

  SsvModel& model_;
  const SsvBody& body_;
  std::vector<Sphere> spheres_;   // By piece.
  std::vector<int> first_piece_;  // By surface of the body.
};

BodyCompiler::Origin BodyCompiler::origin(int piece) const {
  if (piece < body_.shape_count) return {-1, body_.first_shape + piece};
  const auto next = std::ranges::upper_bound(first_piece_, piece);
  const auto s = static_cast<int>(next - first_piece_.begin()) - 1;
  return {body_.first_surface + s, piece - first_piece_[index(s)]};
}

void BodyCompiler::add_spheres() {
  for (int s = 0; s < body_.shape_count; ++s) {
    const Shape& shape_J = model_.shape(body_.first_shape + s).shape_J;
    spheres_.push_back({shape_J.bounding_center(), shape_J.bounding_radius()});
  }
  for (int s = body_.first_surface; s < body_.first_surface + body_.surface_count; ++s) {
    first_piece_.push_back(static_cast<int>(spheres_.size()));
    const SsvSurface& placed = surface(s);
    for (int p = 0; p < placed.surface->piece_count(); ++p) {
      const Shape piece_S = placed.surface->piece(p, placed.padding);
      spheres_.push_back({placed.X_JS * piece_S.bounding_center(), piece_S.bounding_radius()});
    }
  }
}

/// Calls f(centre, radius) for balls whose hull is the piece.
template <class F>
void BodyCompiler::for_each_ball(int piece, F&& f) const {
  const auto [s, p] = origin(piece);
  if (s < 0) {
    const SsvShape& shape = model_.shape(p);
    for (const Vector3d& v : shape.vertices_J) f(v, shape.shape_J.radius());
  } else if (const SsvSurface& placed = surface(s); placed.surface->is_mesh()) {
    for (const int v : placed.surface->triangles()[index(p)]) {
      f(Vector3d(placed.X_JS * placed.surface->vertices()[index(v)]),
        placed.surface->radius() + placed.padding);
    }
  } else {
    f(spheres_[index(piece)].center, spheres_[index(piece)].radius);
  }
}

/// The sphere of a node around its pieces themselves, instead of around their spheres.
/// Ref: Badoiu, Clarkson, Smaller core-sets for balls (2003).
Sphere BodyCompiler::tightened(const BoundingTree& tree, const BoundingTree::Node& node) const {
  constexpr int kMostPieces = 64;  // Above, little is gained.
  constexpr int kWork = 1200, kLeastRounds = 2, kMostRounds = 300;
  if (node.is_leaf() || (node.count > kMostPieces && body_.surface_count > 0)) return node.sphere;
  const int rounds =
      body_.surface_count > 0 ? kLeastRounds : std::clamp(kWork / node.count, 16, kMostRounds);
  Sphere best = node.sphere;
  Vector3d center = node.sphere.center;
  for (int round = 1; round <= rounds; ++round) {
    double radius = 0;
    Vector3d furthest = center;
    for (int i = node.first; i < node.first + node.count; ++i) {
      const int piece = tree.order()[index(i)];
      const Sphere& sphere = spheres_[index(piece)];
      double reach = 0;
      Vector3d towards = sphere.center;
      for_each_ball(piece, [&](const Vector3d& v, double r) {
        if (const double d = (v - center).norm() + r; d > reach) {
          reach = d;
          towards = v;
        }
      });
      reach = std::min(reach, (sphere.center - center).norm() + sphere.radius);
      if (reach <= radius) continue;
      radius = reach;
      furthest = towards;
    }
    if (radius < best.radius) best = {center, radius};
    center += (furthest - center) / (round + 1.0);
  }
  return best;
}

int find_root(std::vector<int>& group, int i) {
  while (group[index(i)] != i) i = group[index(i)] = group[index(group[index(i)])];
  return i;
}

void join(std::vector<int>& group, int i, int j) {
  group[index(find_root(group, i))] = find_root(group, j);
}

void BodyCompiler::join_shapes(std::vector<int>& group) const {
  constexpr int kMostShapes = 2000;  // More stay apart: more anchors, but no quadratic work.
  if (body_.shape_count > kMostShapes) return;
  for (int i = 0; i < body_.shape_count; ++i) {
    for (int j = i + 1; j < body_.shape_count; ++j) {
      const Sphere &a = spheres_[index(i)], &b = spheres_[index(j)];
      if ((a.center - b.center).norm() > a.radius + b.radius) continue;
      if (find_root(group, i) == find_root(group, j)) continue;
      const double apart = geometry::distance(model_.shape(body_.first_shape + i).shape_J,
                                              model_.shape(body_.first_shape + j).shape_J);
      if (apart <= 0) join(group, i, j);
    }
  }
}

void BodyCompiler::join_triangles(int s, std::vector<int>& group) const {
  const Surface& mesh = *surface(s).surface;
  const int first = first_piece_[index(s - body_.first_surface)];
  std::vector<int> of_vertex(mesh.vertices().size(), -1);
  for (int t = 0; t < mesh.piece_count(); ++t) {
    for (const int v : mesh.triangles()[index(t)]) {
      int& known = of_vertex[index(v)];
      if (known < 0) known = first + t;
      join(group, first + t, known);
    }
  }
}

/// One piece of every group of pieces that touch each other.
std::vector<bool> BodyCompiler::find_anchors() const {
  std::vector<int> group(spheres_.size());
  std::iota(group.begin(), group.end(), 0);
  join_shapes(group);
  for (int s = body_.first_surface; s < body_.first_surface + body_.surface_count; ++s) {
    if (surface(s).surface->is_mesh()) join_triangles(s, group);
  }
  std::vector<bool> is_anchor(spheres_.size());
  for (std::size_t i = 0; i < group.size(); ++i) is_anchor[i] = group[i] == static_cast<int>(i);
  return is_anchor;
}

void BodyCompiler::compile(bool with_anchors) {
  add_spheres();
  const BoundingTree tree(spheres_);
  const std::vector<bool> is_anchor =
      with_anchors ? find_anchors() : std::vector<bool>(spheres_.size());
  const std::size_t root = model_.nodes.size();
  for (const BoundingTree::Node& node : tree.nodes()) {
    const bool is_root = &node == tree.nodes().data();
    // What is visited often is kept; the pieces of a moving surface would take too much memory.
    const bool keep = body_.joint >= 0 && (body_.surface_count == 0 || is_root);
    const auto [center, radius] = tightened(tree, node);
    SsvNode compiled{center,
                     radius,
                     static_cast<std::int16_t>(body_.joint),
                     false,
                     false,
                     keep ? model_.node_slots++ : -1,
                     static_cast<int>(root) + node.right,
                     -1};
    if (node.is_leaf()) {
      const int piece = tree.order()[index(node.first)];
      const auto [s, p] = origin(piece);
      compiled.piece = p;
      compiled.right = -s - 1;
      compiled.has_anchors = is_anchor[index(piece)];
      compiled.is_ball = s < 0 ? model_.shape(p).shape_J.type() == CoreType::kPoint
                               : !surface(s).surface->is_mesh();
    }
    model_.nodes.push_back(compiled);
  }
  for (std::size_t n = model_.nodes.size(); n-- > root;) {  // Children first.
    SsvNode& node = model_.nodes[n];
    if (node.is_leaf()) continue;
    node.has_anchors = model_.nodes[n + 1].has_anchors || model_.node(node.right).has_anchors;
  }
}

}  // namespace

void add_body(const world::Body& body, int joint, const Isometry3d& X_JL, bool with_anchors,
              SsvModel& model) {
  expects(joint <= std::numeric_limits<std::int16_t>::max(), "joints are numbered by 16 bits");
  SsvBody compiled{joint,
                   static_cast<int>(model.nodes.size()),
                   static_cast<int>(model.shapes.size()),
                   static_cast<int>(body.shapes_L.size()),
                   static_cast<int>(model.surfaces.size()),
                   static_cast<int>(body.surfaces_L.size()),
                   false};
  for (const Shape& shape_L : body.shapes_L) {
    model.shapes.push_back(
        compile_shape(shape_L.in(X_JL).padded(body.padding), joint < 0 ? -1 : model.shape_slots++));
  }
  for (const geometry::PlacedSurface& placed : body.surfaces_L) {
    model.surfaces.push_back(compile_surface(placed, X_JL, body.padding));
    compiled.is_solid = compiled.is_solid || placed.surface->is_closed();
  }
  BodyCompiler(model, compiled).compile(with_anchors);
  model.bodies.push_back(compiled);
}

Vector3d SsvModel::core_point(const SsvNode& leaf) const {
  if (!leaf.is_shape()) return leaf.p_JC;  // Of a triangle too its smallest sphere's centre.
  const std::vector<Vector3d>& vertices_J = shape(leaf.piece).vertices_J;
  Vector3d sum = Vector3d::Zero();
  for (const Vector3d& v : vertices_J) sum += v;
  return sum / static_cast<double>(vertices_J.size());
}

double SsvModel::sweep(const SsvNode& leaf) const {
  if (leaf.is_ball) return leaf.radius;
  if (leaf.is_shape()) return shape(leaf.piece).shape_J.radius();
  const SsvSurface& placed = surfaces[index(leaf.surface())];
  return placed.surface->radius() + placed.padding;
}

}  // namespace tandem::collision
