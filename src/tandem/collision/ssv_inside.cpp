#include <array>

#include "tandem/collision/ssv_scratch.h"
#include "tandem/geometry/distance.h"

namespace tandem::collision {

namespace {

using Eigen::Vector3d;

/// A point of one body that lies inside a closed mesh.
struct InsidePoint {
  int leaf;  ///< That it is of.
  Vector3d p_W;
};

/// Calls f(InsidePoint, surface) for the anchors of the body with root `root` that lie inside one
/// of the closed meshes of `body`, until f returns false.
template <class F>
bool visit_inside(SsvScratch& scratch, int root, const SsvBody& body, F&& f) {
  const SsvModel& model = scratch.model();
  for (int s = body.first_surface; s < body.first_surface + body.surface_count; ++s) {
    const SsvSurface& placed = model.surfaces[static_cast<std::size_t>(s)];
    if (!placed.surface->is_closed()) continue;
    const Eigen::Isometry3d X_WS =
        body.joint < 0 ? placed.X_JS : scratch.pose(body.joint) * placed.X_JS;
    const auto in_surface = [&](const Vector3d& p_W) -> Vector3d {
      return X_WS.linear().transpose() * (p_W - X_WS.translation());
    };
    std::array<int, SsvModel::kMostDepth + 1> open;
    std::size_t count = 1;
    open[0] = root;
    while (count > 0) {
      const int n = open[--count];
      const SsvNode& node = model.node(n);
      if (!node.has_anchors) continue;
      const Vector3d p_S = in_surface(scratch.center(n)) - placed.center_S;
      if ((p_S.cwiseAbs() - placed.half_S).cwiseMax(0.0).squaredNorm() >
          node.radius * node.radius) {
        continue;
      }
      if (!node.is_leaf()) {
        open[count++] = node.right;
        open[count++] = n + 1;
        continue;
      }
      const Vector3d p_W = scratch.in_world(node.joint, model.core_point(node));
      if (placed.surface->contains(in_surface(p_W)) && !f(InsidePoint{n, p_W}, s)) return false;
    }
  }
  return true;
}

/// Clearance of a ball (as A) from the nearest piece of surface `s` of a body.
geometry::Clearance clearance_from_surface(SsvScratch& scratch, const geometry::Shape& ball_W,
                                           const SsvBody& body, int s) {
  const SsvModel& model = scratch.model();
  geometry::Clearance best{};
  best.distance = std::numeric_limits<double>::infinity();
  std::array<int, SsvModel::kMostDepth + 1> open;
  std::size_t count = 1;
  open[0] = body.root;
  const auto at_least = [&](int n) {
    return (scratch.center(n) - ball_W.origin()).norm() - model.node(n).radius - ball_W.radius();
  };
  while (count > 0) {
    const int n = open[--count];
    const SsvNode& node = model.node(n);
    if (at_least(n) >= best.distance) continue;
    if (!node.is_leaf()) {
      const bool left_first = at_least(n + 1) < at_least(node.right);
      open[count++] = left_first ? node.right : n + 1;
      open[count++] = left_first ? n + 1 : node.right;
    } else if (node.surface() == s) {
      const geometry::Clearance c = geometry::clearance(ball_W, scratch.piece(n, 1));
      if (c.distance < best.distance) best = c;
    }
  }
  return best;
}

}  // namespace

bool is_inside(SsvScratch& scratch, const SsvPair& pair) {
  const SsvBody& a = scratch.model().bodies[static_cast<std::size_t>(pair.body_a)];
  const SsvBody& b = scratch.model().bodies[static_cast<std::size_t>(pair.body_b)];
  const auto stop = [](const InsidePoint&, int) { return false; };
  return !visit_inside(scratch, pair.a, b, stop) || !visit_inside(scratch, pair.b, a, stop);
}

// A ball whose centre is inside by `gap` must go that far to reach the surface, and on by both
// radii: no translation that frees it is shorter.
void improve_inside(SsvScratch& scratch, int index, PairClearance& best) {
  const SsvModel& model = scratch.model();
  const SsvPair& pair = model.pair(index);
  const auto improve_by = [&](int root, int body_index, bool point_is_a) {
    const SsvBody& body = model.bodies[static_cast<std::size_t>(body_index)];
    visit_inside(scratch, root, body, [&](const InsidePoint& inside, int s) {
      const SsvSurface& placed = model.surfaces[static_cast<std::size_t>(s)];
      const double r_point = model.sweep(model.node(inside.leaf));
      const double r_surface = placed.surface->radius() + placed.padding;
      const auto point_W = geometry::Shape::sphere(inside.p_W, 1)->padded(-1);
      const auto [apart, nhat_W, _, __] = clearance_from_surface(scratch, point_W, body, s);
      const double gap = apart + r_surface, distance = -(gap + r_point + r_surface);
      if (distance >= best.distance) return true;
      const Vector3d p_Wp = inside.p_W + r_point * nhat_W;
      const Vector3d p_Ws = inside.p_W - (gap + r_surface) * nhat_W;
      best = point_is_a ? PairClearance{index, distance, -nhat_W, p_Wp, p_Ws}
                        : PairClearance{index, distance, nhat_W, p_Ws, p_Wp};
      return true;
    });
  };
  improve_by(pair.a, pair.body_b, true);
  improve_by(pair.b, pair.body_a, false);
}

}  // namespace tandem::collision
