#include "tandem/collision/ssv_known.h"

#include <algorithm>

namespace tandem::collision {

namespace {

using geometry::PlacedSurface;
using geometry::Shape;

std::size_t index(int i) { return static_cast<std::size_t>(i); }

bool is_same(const Shape& a, const Shape& b) {
  return a.type() == b.type() && a.origin() == b.origin() && a.extents() == b.extents() &&
         a.core_radius() == b.core_radius() && a.radius() == b.radius() &&
         (a.type() != geometry::CoreType::kConvex || &a.hull() == &b.hull());
}

bool is_same(const PlacedSurface& a, const PlacedSurface& b) {
  return a.surface == b.surface && a.X_FS.matrix() == b.X_FS.matrix();
}

bool is_same(const world::Body& a, const world::Body& b) {
  const auto same = [](const auto& x, const auto& y) { return is_same(x, y); };
  return a.padding == b.padding && std::ranges::equal(a.shapes_L, b.shapes_L, same) &&
         std::ranges::equal(a.surfaces_L, b.surfaces_L, same);
}

/// A node of a copy whose first node, shape and surface are `by` further on.
struct Shift {
  int node, shape, surface;
};

SsvNode shifted(SsvNode node, const Shift& by) {
  if (!node.is_leaf()) {
    node.right += by.node;
  } else if (node.is_shape()) {
    node.piece += by.shape;
  } else {
    node.right -= by.surface;
  }
  return node;
}

void copy_body(const SsvModel& from, const SsvBody& body, int joint, SsvModel& to) {
  SsvBody copy = body;
  copy.joint = joint;
  copy.root = static_cast<int>(to.nodes.size());
  copy.first_shape = static_cast<int>(to.shapes.size());
  copy.first_surface = static_cast<int>(to.surfaces.size());
  const Shift by{copy.root - body.root, copy.first_shape - body.first_shape,
                 copy.first_surface - body.first_surface};
  for (int s = body.first_shape; s < body.first_shape + body.shape_count; ++s) {
    to.shapes.push_back(from.shape(s));
    if (to.shapes.back().slot >= 0) to.shapes.back().slot = to.shape_slots++;
  }
  const auto surface = from.surfaces.begin() + body.first_surface;
  to.surfaces.insert(to.surfaces.end(), surface, surface + body.surface_count);
  for (int n = body.root; n < from.node_end(body.root); ++n) {
    SsvNode node = shifted(from.node(n), by);
    node.joint = static_cast<std::int16_t>(joint);
    if (node.slot >= 0) node.slot = to.node_slots++;
    to.nodes.push_back(node);
  }
  to.bodies.push_back(copy);
}

}  // namespace

/// The other cell's body of the same name; -1: none where it is looked for.
int SsvKnown::find(const world::Body& body) {
  const std::vector<world::Body>& bodies = like_->cell().bodies();
  for (std::size_t b = next_; b < std::min(next_ + 2, bodies.size()); ++b) {
    if (bodies[b].name != body.name) continue;
    next_ = b + 1;
    return static_cast<int>(b);
  }
  return -1;
}

bool SsvKnown::add(const world::Body& body, const LinkFrame& frame, SsvModel& model) {
  // Anchors are part of what is compiled.
  if (!like_ || like_->model().with_anchors != model.with_anchors) return false;
  const int found = find(body);
  if (found < 0) return false;
  const world::Body& other = like_->cell().bodies()[index(found)];
  const LinkFrame& other_frame = like_->model().frames[index(other.link)];
  // Whether a body stands still decides what a scratch keeps of it.
  if ((frame.joint < 0) != (other_frame.joint < 0) ||
      frame.X_JL.matrix() != other_frame.X_JL.matrix() || !is_same(body, other)) {
    return false;
  }
  copy_body(like_->model(), like_->model().body(found), frame.joint, model);
  ++model.taken_over;
  return true;
}

}  // namespace tandem::collision
