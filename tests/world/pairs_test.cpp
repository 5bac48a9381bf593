#include <array>
#include <set>

#include "small_cells.h"
#include "tandem/core/contract.h"
#include "tandem/core/rng.h"

namespace tandem::world {
namespace {

using test::arm_spec;
using test::ball;
using test::make_cell;
using test::pair_state;
using test::serial_robot;
using test::Tree;
using test::two_arms;

TEST(Pairs, OfTwoArmsAreCheckedUnlessThereIsAReason) {
  const auto cell = make_cell(two_arms());
  ASSERT_TRUE(cell);
  EXPECT_EQ(pair_state(*cell, "left/a1", "left/a2"), "disabled by SRDF: Adjacent");
  EXPECT_EQ(pair_state(*cell, "left/base", "left/a1"), "disabled by SRDF: Adjacent");
  EXPECT_EQ(pair_state(*cell, "left/a1", "left/a3"), "checked");
  EXPECT_EQ(pair_state(*cell, "left/base", "left/a2"), "checked");
  EXPECT_EQ(pair_state(*cell, "left/a3", "right/a1"), "checked");
  EXPECT_EQ(pair_state(*cell, "left/a3", "right/base"), "checked");
  EXPECT_EQ(pair_state(*cell, "left/base", "right/a1"), "checked");
  EXPECT_EQ(pair_state(*cell, "table", "right/a1"), "checked");
  EXPECT_EQ(pair_state(*cell, "left/base", "right/base"), "no arm moves them");
  EXPECT_EQ(pair_state(*cell, "left/base", "table"), "no arm moves them");
}

TEST(Pairs, NeighboursAreCheckedWithoutAnSrdf) {
  WorkcellSpec spec = two_arms();
  spec.robots[0].semantics.disabled_pairs.clear();
  const auto cell = make_cell(spec);
  EXPECT_EQ(pair_state(*cell, "left/a1", "left/a2"), "checked");
  EXPECT_EQ(pair_state(*cell, "left/base", "left/a1"), "checked");
  EXPECT_EQ(pair_state(*cell, "right/a1", "right/a2"), "disabled by SRDF: Adjacent");
}

TEST(Pairs, AllowedAndAttachedOnesAreSkippedForTheirReason) {
  WorkcellSpec spec = two_arms();
  spec.allowed = {{"table", "left/a3", "it slides on it"}};
  spec.attached = {{"part", "left/a3", {ball()}, {"right/a3", "right/base"}},
                   {"cap", "left/a3", {ball()}, {}}};
  const auto cell = make_cell(spec);
  EXPECT_EQ(pair_state(*cell, "left/a3", "table"), "allowed: it slides on it");
  EXPECT_EQ(pair_state(*cell, "right/a3", "table"), "checked");
  EXPECT_EQ(pair_state(*cell, "part", "left/a3"), "on the same link");
  EXPECT_EQ(pair_state(*cell, "part", "cap"), "on the same link");
  EXPECT_EQ(pair_state(*cell, "part", "right/a3"), "attached, may touch");
  EXPECT_EQ(pair_state(*cell, "part", "right/base"), "attached, may touch");
  EXPECT_EQ(pair_state(*cell, "part", "right/a2"), "checked");
  EXPECT_EQ(pair_state(*cell, "part", "left/a2"), "checked");
  EXPECT_EQ(pair_state(*cell, "part", "table"), "checked");
  EXPECT_EQ(pair_state(*cell, "cap", "right/a3"), "checked");
}

/// A torso that turns, with a left and a right arm of two joints, and hands welded to their ends.
WorkcellSpec torso_cell() {
  Tree tree;
  const int base = tree.add("base");
  const int torso = tree.add("torso", base);
  const int head = tree.add("head", torso, robot::JointType::kFixed);
  int end[2];
  for (int side = 0; side < 2; ++side) {
    const std::string s = side == 0 ? "l" : "r";
    end[side] = tree.add(s + "2", tree.add(s + "1", torso));
    tree.add(s + "hand", end[side], robot::JointType::kFixed);
  }
  // Fingers follow a joint that no arm moves.
  const int finger = tree.add("finger", end[0]);
  tree.add("thumb", end[0]);
  tree.joints.back().mimic = robot::Mimic{static_cast<int>(tree.joints.size()) - 2, -1.0, 0.0};
  static_cast<void>(head);
  static_cast<void>(finger);
  WorkcellSpec spec;
  spec.name = "torso";
  RobotSpec robot;
  robot.name = "r";
  robot.model = tree.make();
  spec.robots.push_back(robot);
  for (const auto& [name, from, to] :
       {std::array{"torso", "base", "torso"}, {"left", "torso", "l2"}, {"right", "torso", "r2"}}) {
    ArmSpec arm = arm_spec(name, "r", "");
    arm.base = from;
    arm.tip = to;
    spec.arms.push_back(arm);
  }
  spec.obstacles.push_back({"box", {ball()}});
  return spec;
}

ArmMask mask_of(const Workcell& cell, const std::string& a, const std::string& b) {
  for (std::size_t i = 0; i < cell.pairs().size(); ++i) {
    const std::string pair = cell.describe_pair(static_cast<int>(i));
    if (pair == a + " and " + b || pair == b + " and " + a) return cell.pairs()[i].moved_by;
  }
  return 0;
}

TEST(Pairs, BelowATorsoKnowWhoMovesThemAgainstEachOther) {
  const auto cell = make_cell(torso_cell());
  ASSERT_TRUE(cell);
  const ArmMask torso = 1, left = 2, right = 4;
  const auto moved_by = [&](const std::string& name) {
    return cell->bodies()[static_cast<std::size_t>(cell->find_body(name))].moved_by;
  };
  EXPECT_EQ(moved_by("r/base"), 0u);
  EXPECT_EQ(moved_by("box"), 0u);
  EXPECT_EQ(moved_by("r/head"), torso);
  EXPECT_EQ(moved_by("r/l1"), torso | left);
  EXPECT_EQ(moved_by("r/rhand"), torso | right);
  EXPECT_EQ(moved_by("r/thumb"), torso | left);

  EXPECT_EQ(mask_of(*cell, "r/l2", "box"), torso | left);
  EXPECT_EQ(mask_of(*cell, "r/l2", "r/base"), torso | left);
  EXPECT_EQ(mask_of(*cell, "r/head", "box"), torso);
  // The torso carries both: it does not change how they stand to each other.
  EXPECT_EQ(mask_of(*cell, "r/l2", "r/head"), left);
  EXPECT_EQ(mask_of(*cell, "r/l2", "r/r1"), left | right);
  EXPECT_EQ(mask_of(*cell, "r/l1", "r/lhand"), left);

  EXPECT_EQ(pair_state(*cell, "r/l2", "r/lhand"), "rigidly connected");
  EXPECT_EQ(pair_state(*cell, "r/torso", "r/head"), "rigidly connected");
  EXPECT_EQ(pair_state(*cell, "r/finger", "r/thumb"), "rigidly connected");
  EXPECT_EQ(pair_state(*cell, "r/finger", "r/lhand"), "rigidly connected");
  EXPECT_EQ(pair_state(*cell, "r/base", "box"), "no arm moves them");
}

TEST(Pairs, OfMimicsBelongToTheArmOfTheJointTheyFollow) {
  WorkcellSpec spec = torso_cell();
  ArmSpec hand = arm_spec("hand", "r", "");
  hand.base = "l2";
  hand.tip = "finger";
  spec.arms.push_back(hand);
  const auto cell = make_cell(spec);
  ASSERT_TRUE(cell);
  EXPECT_EQ(mask_of(*cell, "r/finger", "r/thumb"), 8u);
  EXPECT_EQ(mask_of(*cell, "r/thumb", "r/lhand"), 8u);
  EXPECT_EQ(mask_of(*cell, "r/thumb", "box"), 1u | 2u | 8u);
}

/// Ids of the pairs with a mask that `wanted` accepts.
template <class Wanted>
PairSelection filtered(const Workcell& cell, Wanted wanted) {
  PairSelection ids;
  for (std::size_t i = 0; i < cell.pairs().size(); ++i) {
    if (wanted(cell.pairs()[i].moved_by)) ids.push_back(static_cast<int>(i));
  }
  return ids;
}

TEST(Scope, OfThreeArms) {
  WorkcellSpec spec = two_arms();
  spec.robots.push_back(serial_robot("third", 2));
  spec.arms.push_back(arm_spec("third", "third", "arm"));
  const auto cell = make_cell(spec);
  ASSERT_TRUE(cell);
  const auto all = cell->select(PairScope::all());
  EXPECT_EQ(all.size(), cell->pairs().size());
  for (int i = 0; i < 3; ++i) {
    const ArmMask bit = 1u << i;
    EXPECT_EQ(cell->select(PairScope::arm(i)),
              filtered(*cell, [&](ArmMask m) { return m == bit; }));
    EXPECT_FALSE(cell->select(PairScope::arm(i)).empty());
    for (int j = 0; j < 3; ++j) {
      if (i == j) continue;
      const ArmMask both = bit | (1u << j);
      EXPECT_EQ(cell->select(PairScope::arm(i, 1u << j)),
                filtered(*cell, [&](ArmMask m) { return m == bit || m == both; }));
      EXPECT_EQ(cell->select(PairScope::between(i, j)),
                filtered(*cell, [&](ArmMask m) { return m == both; }));
    }
  }
  // What each arm meets alone and what two of them meet together is all there is.
  std::multiset<int> parts;
  for (int i = 0; i < 3; ++i) {
    for (const int id : cell->select(PairScope::arm(i))) parts.insert(id);
    for (int j = 0; j < i; ++j) {
      for (const int id : cell->select(PairScope::between(i, j))) parts.insert(id);
    }
  }
  EXPECT_EQ(PairSelection(parts.begin(), parts.end()), all);
  EXPECT_THROW(cell->select(PairScope::arm(-1)), ContractViolation);
  EXPECT_THROW(PairScope::between(0, 32), ContractViolation);
}

TEST(Scope, BelowATorso) {
  const auto cell = make_cell(torso_cell());
  const auto names = [&](const PairScope& scope) {
    std::set<std::string> all;
    for (const int id : cell->select(scope)) all.insert(cell->describe_pair(id));
    return all;
  };
  // Alone, the left arm meets itself and what it shares the torso with, but neither world nor base.
  const auto left = names(PairScope::arm(1));
  EXPECT_TRUE(left.contains("r/head and r/l2"));
  EXPECT_FALSE(left.contains("r/l2 and box"));
  EXPECT_FALSE(left.contains("r/base and r/l2"));
  const auto on_torso = names(PairScope::arm(1, 1u));
  EXPECT_TRUE(on_torso.contains("r/l2 and box"));
  EXPECT_TRUE(on_torso.contains("r/head and r/l2"));
  EXPECT_FALSE(on_torso.contains("r/head and box"));
  EXPECT_TRUE(names(PairScope::between(0, 1)).contains("r/l2 and box"));
  EXPECT_FALSE(names(PairScope::between(0, 1)).contains("r/head and r/l2"));
}

/// A random tree with revolute, prismatic, fixed and mimic joints in general position.
Tree random_tree(Rng& rng, int links) {
  Tree tree;
  tree.add("l0");
  for (int i = 1; i < links; ++i) {
    const int parent = static_cast<int>(rng.index(static_cast<std::size_t>(i)));
    const robot::JointType types[] = {robot::JointType::kRevolute, robot::JointType::kRevolute,
                                      robot::JointType::kPrismatic, robot::JointType::kFixed};
    tree.add(test::numbered("l", i), parent, types[rng.index(4)]);
    robot::Joint& joint = tree.joints.back();
    const auto draw = [&] { return rng.uniform(-1, 1); };
    joint.axis_J = Eigen::Vector3d(draw(), draw(), draw()).normalized();
    joint.X_PJ.translation() = Eigen::Vector3d(draw(), draw(), draw());
    const robot::Joint& source = tree.joints[rng.index(tree.joints.size())];
    if (rng.index(5) == 0 && &source != &joint && source.type != robot::JointType::kFixed &&
        !source.mimic) {
      joint.mimic = robot::Mimic{static_cast<int>(&source - tree.joints.data()), draw(), draw()};
    }
  }
  return tree;
}

/// Whether the relative pose of two links differs between two placements.
bool differs(const robot::LinkPoses& before, const robot::LinkPoses& after, int a, int b) {
  const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
  return !(before[i].inverse() * before[j]).isApprox(after[i].inverse() * after[j], 1e-9);
}

/// One robot whose free joints go to one of three arms, or to none.
WorkcellSpec random_cell(Rng& rng) {
  WorkcellSpec spec;
  spec.name = "random";
  RobotSpec robot;
  robot.name = "r";
  robot.model = random_tree(rng, 14).make();
  for (const char* name : {"x", "y", "z"}) robot.semantics.groups.push_back({name, {}, -1});
  for (int i = 0; i < robot.model.position_count(); ++i) {
    const std::size_t arm = rng.index(4);
    const int joint = robot.model.joint_of_position(i);
    if (arm < 3) robot.semantics.groups[arm].joints.push_back(joint);
  }
  for (const robot::Group& group : robot.semantics.groups) {
    if (group.joints.empty()) continue;
    ArmSpec arm = arm_spec(group.name, "r", group.name);
    const int child =
        robot.model.joints()[static_cast<std::size_t>(group.joints.back())].child_link;
    arm.tip = robot.model.links()[static_cast<std::size_t>(child)].name;
    spec.arms.push_back(arm);
  }
  spec.robots.push_back(robot);
  spec.obstacles.push_back({"box", {ball()}});
  spec.attached.push_back({"part", "r/l7", {ball()}, {}});
  return spec;
}

Eigen::VectorXd random_vector(Rng& rng, int size) {
  Eigen::VectorXd v(size);
  for (Eigen::Index i = 0; i < size; ++i) v[i] = rng.uniform(-1.5, 1.5);
  return v;
}

/// Moves one arm at a time and watches which relative poses change.
class MovedBy {
 public:
  MovedBy(const Workcell& cell, Rng& rng) {
    Eigen::VectorXd positions;
    const Eigen::VectorXd q = random_vector(rng, cell.dof());
    cell.forward_kinematics(q, positions, before_);
    for (const Arm& arm : cell.arms()) {
      Eigen::VectorXd moved = q;
      moved.segment(arm.offset, arm.dof()) = random_vector(rng, arm.dof());
      cell.forward_kinematics(moved, positions, after_.emplace_back());
    }
  }
  ArmMask operator()(int link_a, int link_b) const {
    ArmMask mask = 0;
    for (std::size_t i = 0; i < after_.size(); ++i) {
      if (differs(before_, after_[i], link_a, link_b)) mask |= ArmMask{1} << i;
    }
    return mask;
  }

 private:
  robot::LinkPoses before_;
  std::vector<robot::LinkPoses> after_;
};

/// Masks of all pairs, 0 for skipped ones; each pair exactly once.
std::map<std::pair<int, int>, ArmMask> masks_by_pair(const Workcell& cell) {
  std::map<std::pair<int, int>, ArmMask> masks;
  for (const BodyPair& pair : cell.pairs()) {
    EXPECT_LT(pair.a, pair.b);
    EXPECT_NE(pair.moved_by, 0u);
    EXPECT_TRUE(masks.emplace(std::pair(pair.a, pair.b), pair.moved_by).second);
  }
  for (const SkippedPair& pair : cell.skipped_pairs()) {
    EXPECT_LT(pair.a, pair.b);
    EXPECT_FALSE(pair.reason.empty());
    EXPECT_TRUE(masks.emplace(std::pair(pair.a, pair.b), 0u).second);
  }
  EXPECT_EQ(masks.size(), cell.bodies().size() * (cell.bodies().size() - 1) / 2);
  return masks;
}

TEST(Pairs, MasksMatchWhatMovesOnRandomTrees) {
  Rng rng(5);
  std::size_t compared = 0, moved = 0;
  for (int round = 0; round < 60; ++round) {
    const WorkcellSpec spec = random_cell(rng);
    if (spec.arms.empty()) continue;
    const auto cell = make_cell(spec);
    ASSERT_TRUE(cell);
    const MovedBy moved_by(*cell, rng);
    for (const Body& body : cell->bodies()) {
      EXPECT_EQ(body.moved_by, moved_by(body.link, 0)) << body.name;
    }
    for (const auto& [pair, mask] : masks_by_pair(*cell)) {
      const Body& a = cell->bodies()[static_cast<std::size_t>(pair.first)];
      const Body& b = cell->bodies()[static_cast<std::size_t>(pair.second)];
      EXPECT_EQ(mask, moved_by(a.link, b.link)) << a.name << " " << b.name;
      ++compared;
      moved += mask != 0;
    }
  }
  EXPECT_GT(compared, 4000u);
  EXPECT_GT(moved, compared / 4);
  EXPECT_LT(moved, compared);
}

}  // namespace
}  // namespace tandem::world
