#include <algorithm>
#include <optional>

#include "tandem/collision/batch_model.h"
#include "tandem/collision/box_tree.h"
#include "tandem/core/contract.h"

namespace tandem::collision {

namespace {

using geometry::Shape;

/// Sorts pairs into items, and leaves out what can never touch.
class PairCompiler {
 public:
  PairCompiler(const BatchModel& model, const world::Workcell& cell, double within)
      : model_(model),
        cell_(cell),
        within_(within),
        group_reaches_(model.joints.size()),
        body_reaches_(model.bodies.size()),
        standing_shapes_(model.shapes.size()),
        reached_(model.joints.size()) {
    pairs_.model = &model;
  }

  void add(int index);
  BatchPairs finish();

 private:
  /// A pair of bodies and the item that it belongs to.
  struct Entry {
    int group_a, other;  ///< Joints, or the standing body.
    BatchBodyPair pair;
  };

  const BatchBody& body(int b) const { return model_.bodies[static_cast<std::size_t>(b)]; }
  void add_standing(int pair, int a, int b);
  void add_moving(int pair, int a, int b);
  const StandingShape& standing_shape(int shape);
  bool group_reaches(int group, int standing);
  BatchItem standing_item(const Entry& entry) const;
  BatchItem moving_item(const Entry& entry) const;
  template <class F>
  void add_items(std::vector<Entry>& entries, F&& item_of);
  void grow_trees();

  const BatchModel& model_;
  const world::Workcell& cell_;
  double within_;
  BatchPairs pairs_;
  std::vector<Entry> standing_, moving_;
  // What was asked for so far, by group, body or shape.
  std::vector<std::optional<Reach>> group_reaches_, body_reaches_;
  std::vector<std::optional<StandingShape>> standing_shapes_;
  enum class Known : std::uint8_t { kNothing, kApart, kNear };
  std::vector<std::vector<Known>> reached_;  ///< By group, then by standing body.
};

/// A rounded box as it stands.
StandingShape outer_box(const BatchShape& shape) {
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
  return {*Shape::box(X, (2 * half).cwiseMax(kLeastEdge), static_cast<double>(shape.outer)),
          X.translation(), kLeastEdge + static_cast<double>(shape.bound())};
}

/// The value at i, made when it is first asked for.
template <class T, class Make>
const T& known(std::vector<std::optional<T>>& values, int i, Make&& make) {
  std::optional<T>& value = values[static_cast<std::size_t>(i)];
  if (!value) value = make();
  return *value;
}

const StandingShape& PairCompiler::standing_shape(int shape) {
  return known(standing_shapes_, shape,
               [&] { return outer_box(model_.shapes[static_cast<std::size_t>(shape)]); });
}

bool PairCompiler::group_reaches(int group, int standing) {
  std::vector<Known>& of_group = reached_[static_cast<std::size_t>(group)];
  of_group.resize(model_.bodies.size(), Known::kNothing);
  Known& found = of_group[static_cast<std::size_t>(standing)];
  if (found != Known::kNothing) return found == Known::kNear;
  const Reach& reach = known(group_reaches_, group, [&] {
    return Reach(model_, group, -1, model_.groups[static_cast<std::size_t>(group)]);
  });
  found = Known::kApart;
  const BatchBody& other = body(standing);
  for (int s = other.first_shape; s < other.first_shape + other.shape_count; ++s) {
    if (!reach.may_touch(standing_shape(s), within_)) continue;
    found = Known::kNear;
    break;
  }
  return found == Known::kNear;
}

void PairCompiler::add_standing(int pair, int a, int b) {
  const BatchBody& moved = body(a);
  const BatchBody& other = body(b);
  if (!group_reaches(moved.joint, b)) return;
  const Reach& reach =
      known(body_reaches_, a, [&] { return Reach(model_, moved.joint, -1, moved.sphere); });
  BatchBodyPair compiled{pair, a, b, static_cast<int>(pairs_.standing_shapes.size()), 0};
  for (int s = other.first_shape; s < other.first_shape + other.shape_count; ++s) {
    if (!reach.may_touch(standing_shape(s), within_)) continue;
    pairs_.standing_shapes.push_back(s);
    ++compiled.shape_count;
  }
  if (compiled.shape_count > 0) standing_.push_back({moved.joint, b, compiled});
}

void PairCompiler::add_moving(int pair, int a, int b) {
  const int common = model_.common_joint(body(a).joint, body(b).joint);
  // One of them may stand still in the frame of the common joint.
  for (const auto& [still, moved] : {std::pair(a, b), std::pair(b, a)}) {
    if (body(still).joint != common) continue;
    const BatchSphere& sphere = body(still).sphere;
    const Eigen::Vector3d center(sphere.p_JC[0], sphere.p_JC[1], sphere.p_JC[2]);
    const auto radius = static_cast<double>(sphere.radius);
    const StandingShape ball{*Shape::sphere(center, radius), center, radius};
    const Reach reach(model_, body(moved).joint, common, body(moved).sphere);
    if (!reach.may_touch(ball, within_)) return;
  }
  moving_.push_back({body(a).joint, body(b).joint, {pair, a, b, 0, 0}});
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

BatchItem PairCompiler::standing_item(const Entry& entry) const {
  const BatchBody& other = body(entry.other);
  BatchItem item{};
  item.group_a = entry.group_a;
  item.group_b = -1;
  item.standing = entry.other;
  item.common = -1;
  item.shared = 0;
  item.joint_map = nullptr;
  item.reach = model_.groups[static_cast<std::size_t>(entry.group_a)].radius + other.outer;
  item.center = other.p_CB;
  item.half = other.half;
  return item;
}

BatchItem PairCompiler::moving_item(const Entry& entry) const {
  BatchItem item{};
  item.group_a = entry.group_a;
  item.group_b = entry.other;
  item.standing = -1;
  item.common = model_.common_joint(entry.group_a, entry.other);
  item.shared = model_.depth_of(item.common);
  item.reach = model_.groups[static_cast<std::size_t>(entry.group_a)].radius +
               model_.groups[static_cast<std::size_t>(entry.other)].radius;
  const std::vector<JointMap>& maps = model_.joint_maps->all;
  const auto map = std::ranges::find_if(maps, [&](const JointMap& candidate) {
    return candidate.group_a == item.group_a && candidate.group_b == item.group_b;
  });
  item.joint_map = map == maps.end() ? nullptr : &*map;
  return item;
}

template <class F>
void PairCompiler::add_items(std::vector<Entry>& entries, F&& item_of) {
  const auto key = [](const Entry& entry) { return std::pair(entry.group_a, entry.other); };
  std::ranges::stable_sort(entries, {}, key);
  for (std::size_t i = 0; i < entries.size();) {
    BatchItem item = item_of(entries[i]);
    item.first = static_cast<int>(pairs_.body_pairs.size());
    const std::size_t first = i;
    for (; i < entries.size() && key(entries[i]) == key(entries[first]); ++i) {
      pairs_.body_pairs.push_back(entries[i].pair);
    }
    item.count = static_cast<int>(i - first);
    pairs_.items.push_back(item);
  }
}

/// Trees over the items of groups that have many with standing bodies.
void PairCompiler::grow_trees() {
  constexpr int kFew = 16, kLeaf = 4;
  const auto end = static_cast<int>(pairs_.standing_items);
  for (int first = 0; first < end;) {
    BatchGroupItems of_group{pairs_.items[static_cast<std::size_t>(first)].group_a, first, 0, {}};
    std::vector<Eigen::AlignedBox3d> boxes;
    for (int i = first; i < end; ++i) {
      const BatchItem& item = pairs_.items[static_cast<std::size_t>(i)];
      if (item.group_a != of_group.group) break;
      const Eigen::Vector3d center(item.center[0], item.center[1], item.center[2]);
      const Eigen::Vector3d half(item.half[0], item.half[1], item.half[2]);
      const float outer = body(item.standing).outer;
      const Eigen::Vector3d reach = half + Eigen::Vector3d::Constant(static_cast<double>(outer));
      boxes.emplace_back(center - reach, center + reach);
      ++of_group.count;
    }
    if (of_group.count > kFew) {
      const BoxTree tree(boxes, kLeaf);
      std::vector<BatchItem> sorted;
      for (const int i : tree.order) {
        sorted.push_back(pairs_.items[static_cast<std::size_t>(first + i)]);
      }
      std::ranges::copy(sorted, pairs_.items.begin() + first);
      for (const BoxTree::Node& node : tree.nodes) {
        // Rounding to single precision, of the difference to a point too.
        const Eigen::Vector3d c = node.box.center();
        const Eigen::Vector3d half =
            0.5 * node.box.sizes() + Eigen::Vector3d::Constant(1e-6 * (1 + c.norm()));
        of_group.nodes.push_back(
            {{static_cast<float>(c.x()), static_cast<float>(c.y()), static_cast<float>(c.z())},
             {static_cast<float>(half.x()), static_cast<float>(half.y()),
              static_cast<float>(half.z())},
             node.skip,
             first + node.first,
             node.count});
      }
    }
    first += of_group.count;
    pairs_.standing_groups.push_back(std::move(of_group));
  }
}

BatchPairs PairCompiler::finish() {
  add_items(standing_, [&](const Entry& entry) { return standing_item(entry); });
  pairs_.standing_items = pairs_.items.size();
  grow_trees();
  add_items(moving_, [&](const Entry& entry) { return moving_item(entry); });
  std::vector<bool> placed(model_.joints.size(), false);
  const auto place = [&](int joint) {
    for (int j = joint; j >= 0; j = model_.joints[static_cast<std::size_t>(j)].parent) {
      placed[static_cast<std::size_t>(j)] = true;
    }
  };
  for (const BatchItem& item : pairs_.items) {
    place(item.group_a);
    place(item.group_b);
  }
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
