#include <algorithm>
#include <map>
#include <tuple>

#include "tandem/collision/batch_model.h"
#include "tandem/core/contract.h"

namespace tandem::collision {

namespace {

using geometry::Shape;

/// Sorts pairs into items, and leaves out what can never touch.
class PairCompiler {
 public:
  PairCompiler(const BatchModel& model, const world::Workcell& cell, double within)
      : model_(model), cell_(cell), within_(within) {
    pairs_.model = &model;
  }

  void add(int index);
  BatchPairs finish();

 private:
  struct Item {
    BatchItem item;
    std::vector<BatchBodyPair> body_pairs;
  };

  const BatchBody& body(int b) const { return model_.bodies[static_cast<std::size_t>(b)]; }
  void add_standing(int pair, int a, int b);
  void add_moving(int pair, int a, int b);
  bool group_reaches(int group, int standing);

  const BatchModel& model_;
  const world::Workcell& cell_;
  double within_;
  BatchPairs pairs_;
  std::map<std::tuple<int, int>, Item> standing_, moving_;
  std::map<std::tuple<int, int>, bool> reaches_;
};

/// A rounded box as a shape, in the frame that it stands still in.
Shape outer_box(const BatchShape& shape) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  for (int row = 0; row < 3; ++row) {
    for (int i = 0; i < 3; ++i) {
      X.linear()(i, row) = shape.R_BJ[static_cast<std::size_t>(3 * row + i)];
    }
  }
  // Rotations rounded to single precision are none.
  X.linear() = Eigen::Quaterniond(X.linear()).normalized().toRotationMatrix();
  X.translation() = Eigen::Vector3d(shape.p_JC[0], shape.p_JC[1], shape.p_JC[2]);
  const Eigen::Vector3d half(shape.half[0], shape.half[1], shape.half[2]);
  constexpr double kLeastEdge = 1e-6;
  return *Shape::box(X, (2 * half).cwiseMax(kLeastEdge), static_cast<double>(shape.outer));
}

bool PairCompiler::group_reaches(int group, int standing) {
  const auto [found, is_new] = reaches_.try_emplace({group, standing}, false);
  if (!is_new) return found->second;
  const BatchBody& other = body(standing);
  for (int s = other.first_shape; s < other.first_shape + other.shape_count; ++s) {
    const Shape shape_C = outer_box(model_.shapes[static_cast<std::size_t>(s)]);
    if (may_touch(model_, group, -1, model_.groups[static_cast<std::size_t>(group)], shape_C,
                  within_)) {
      found->second = true;
      break;
    }
  }
  return found->second;
}

void PairCompiler::add_standing(int pair, int a, int b) {
  const BatchBody& moved = body(a);
  const BatchBody& other = body(b);
  if (!group_reaches(moved.joint, b)) return;
  BatchBodyPair compiled{pair, a, b, static_cast<int>(pairs_.standing_shapes.size()), 0};
  for (int s = other.first_shape; s < other.first_shape + other.shape_count; ++s) {
    const Shape shape_C = outer_box(model_.shapes[static_cast<std::size_t>(s)]);
    if (!may_touch(model_, moved.joint, -1, moved.sphere, shape_C, within_)) continue;
    pairs_.standing_shapes.push_back(s);
    ++compiled.shape_count;
  }
  if (compiled.shape_count == 0) return;
  Item& entry = standing_[{moved.joint, b}];
  entry.item.group_a = moved.joint;
  entry.item.group_b = -1;
  entry.item.standing = b;
  entry.item.common = -1;
  entry.item.shared = 0;
  entry.item.reach = model_.groups[static_cast<std::size_t>(moved.joint)].radius + other.outer;
  entry.item.center = other.p_CB;
  entry.item.half = other.half;
  entry.body_pairs.push_back(compiled);
}

void PairCompiler::add_moving(int pair, int a, int b) {
  const int joint_a = body(a).joint, joint_b = body(b).joint;
  const int common = model_.common_joint(joint_a, joint_b);
  // One of them may stand still in the frame of the common joint.
  for (const auto& [still, moved] : {std::pair(a, b), std::pair(b, a)}) {
    if (body(still).joint != common) continue;
    const BatchSphere& sphere = body(still).sphere;
    const Eigen::Vector3d center(sphere.p_JC[0], sphere.p_JC[1], sphere.p_JC[2]);
    const Shape ball = *Shape::sphere(center, static_cast<double>(sphere.radius));
    if (!may_touch(model_, body(moved).joint, common, body(moved).sphere, ball, within_)) {
      return;
    }
  }
  Item& entry = moving_[{joint_a, joint_b}];
  entry.item.group_a = joint_a;
  entry.item.group_b = joint_b;
  entry.item.standing = -1;
  entry.item.common = common;
  entry.item.shared = model_.depth_of(common);
  entry.item.reach = model_.groups[static_cast<std::size_t>(joint_a)].radius +
                     model_.groups[static_cast<std::size_t>(joint_b)].radius;
  entry.body_pairs.push_back({pair, a, b, 0, 0});
}

void PairCompiler::add(int index) {
  expects(0 <= index && index < static_cast<int>(cell_.pairs().size()),
          "a selection holds indices into pairs()");
  const world::BodyPair& pair = cell_.pairs()[static_cast<std::size_t>(index)];
  const int joint_a = body(pair.a).joint, joint_b = body(pair.b).joint;
  if (joint_a < 0) return add_standing(index, pair.b, pair.a);
  if (joint_b < 0) return add_standing(index, pair.a, pair.b);
  if (joint_a <= joint_b) return add_moving(index, pair.a, pair.b);
  add_moving(index, pair.b, pair.a);
}

BatchPairs PairCompiler::finish() {
  std::vector<bool> placed(model_.joints.size(), false);
  const auto place = [&](int joint) {
    for (int j = joint; j >= 0; j = model_.joints[static_cast<std::size_t>(j)].parent) {
      placed[static_cast<std::size_t>(j)] = true;
    }
  };
  for (auto* items : {&standing_, &moving_}) {
    for (auto& [key, entry] : *items) {
      entry.item.first = static_cast<int>(pairs_.body_pairs.size());
      entry.item.count = static_cast<int>(entry.body_pairs.size());
      pairs_.body_pairs.insert(pairs_.body_pairs.end(), entry.body_pairs.begin(),
                               entry.body_pairs.end());
      pairs_.items.push_back(entry.item);
      place(entry.item.group_a);
      place(entry.item.group_b);
    }
  }
  pairs_.standing_items = standing_.size();
  for (std::size_t j = 0; j < placed.size(); ++j) {
    if (placed[j]) pairs_.joints.push_back(static_cast<int>(j));
  }
  return std::move(pairs_);
}

}  // namespace

BatchPairs compile_pairs(const BatchModel& model, const world::Workcell& cell,
                         const world::PairSelection& selection, double within) {
  PairCompiler compiler(model, cell, within);
  for (const int pair : selection) compiler.add(pair);
  return compiler.finish();
}

}  // namespace tandem::collision
