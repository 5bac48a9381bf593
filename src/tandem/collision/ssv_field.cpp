#include "tandem/collision/ssv_field.h"

namespace tandem::collision {

namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

std::size_t index(int i) { return static_cast<std::size_t>(i); }

/// Around a standing body, padding included.
AlignedBox3d box_around(const SsvModel& model, const SsvBody& body) {
  AlignedBox3d box;
  for (int s = body.first_shape; s < body.first_shape + body.shape_count; ++s) {
    const SsvShape& shape = model.shape(s);
    const Vector3d swept = Vector3d::Constant(shape.shape_J.radius());
    for (const Vector3d& v_W : shape.vertices_J) {
      box.extend(v_W - swept);
      box.extend(v_W + swept);
    }
  }
  for (int s = body.first_surface; s < body.first_surface + body.surface_count; ++s) {
    const SsvSurface& placed = model.surfaces[index(s)];
    const Vector3d center = placed.X_JS * placed.center_S;
    const Vector3d half = placed.X_JS.linear().cwiseAbs() * placed.half_S +
                          Vector3d::Constant(placed.surface->radius() + placed.padding);
    box.extend(center - half);
    box.extend(center + half);
  }
  // Rounding of what is placed.
  constexpr double kSlack = 1e-9;
  const Vector3d slack = Vector3d::Constant(kSlack * (1 + box.sizes().norm()));
  return {box.min() - slack, box.max() + slack};
}

}  // namespace

SsvField::SsvField(const SsvModel& model) {
  std::vector<int> place(model.bodies.size(), -1);  // Among those that stand, or those that move.
  std::vector<AlignedBox3d> boxes;
  for (std::size_t b = 0; b < model.bodies.size(); ++b) {
    const SsvBody& body = model.bodies[b];
    if (body.joint < 0) {
      place[b] = static_cast<int>(boxes.size());
      boxes.push_back(box_around(model, body));
    } else {
      place[b] = static_cast<int>(moving_.size());
      moving_.push_back(static_cast<int>(b));
    }
  }
  if (boxes.size() < kFewStanding) return;
  constexpr int kLeaf = 2;
  tree_ = BoxTree(boxes, kLeaf);
  standing_count_ = boxes.size();
  pair_of_.assign(moving_.size() * standing_count_, -1);
  pair_count_ = model.pairs.size();
  for (std::size_t i = 0; i < model.pairs.size(); ++i) {
    const SsvPair& pair = model.pairs[i];
    const bool stands_a = model.body(pair.body_a).joint < 0;
    if (!stands_a && model.body(pair.body_b).joint >= 0) {
      moving_pairs_.push_back(static_cast<int>(i));
      continue;
    }
    const int moving = place[index(stands_a ? pair.body_b : pair.body_a)];
    const int standing = place[index(stands_a ? pair.body_a : pair.body_b)];
    pair_of_[index(moving) * standing_count_ + index(standing)] = static_cast<int>(i);
  }
}

}  // namespace tandem::collision
