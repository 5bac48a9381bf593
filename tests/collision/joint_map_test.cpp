#include "tandem/collision/joint_map.h"

#include <gtest/gtest.h>

#include "collision/batch_targets.h"

namespace tandem::collision {
namespace {

using Eigen::VectorXd;

/// A random cell in which neighbouring links are not allowed to touch: many pairs that one or two
/// joints decide.
std::shared_ptr<const world::Workcell> strict_cell(std::uint64_t seed,
                                                   const test::RandomCellOptions& options) {
  world::WorkcellSpec spec = test::random_cell_spec(seed, options);
  for (world::RobotSpec& robot : spec.robots) robot.semantics.disabled_pairs.clear();
  auto cell = world::Workcell::make(std::move(spec));
  if (!cell) throw std::runtime_error(cell.error().message);
  return *std::move(cell);
}

/// One map and the pairs that it speaks of.
struct Claim {
  const JointMap& map;
  const BatchModel& model;
  const SsvChecker& exact;
  world::PairSelection pairs;

  Claim(const JointMap& of, const BatchModel& in, const SsvChecker& checker)
      : map(of), model(in), exact(checker) {
    const auto& all = exact.cell().pairs();
    for (std::size_t i = 0; i < all.size(); ++i) {
      const int a = group(all[i].a), b = group(all[i].b);
      if (std::min(a, b) == map.group_a && std::max(a, b) == map.group_b) {
        pairs.push_back(static_cast<int>(i));
      }
    }
  }
  int group(int body) const { return model.bodies[static_cast<std::size_t>(body)].joint; }
  const BatchJoint& joint(std::size_t axis) const {
    return model.joints[static_cast<std::size_t>(map.joints[axis])];
  }
  bool is_single() const { return map.joints[0] == map.joints[1]; }

  /// A value `where` of the way through a cell and `rings` more on either side, in the limits.
  void set(std::size_t axis, int cell, int rings, double where, VectorXd& q) const {
    const BatchJoint& j = joint(axis);
    const double side = (j.upper - j.lower) / JointMap::kSide;
    const double value = j.lower + side * (cell - rings + where * (1 + 2 * rings));
    q[j.column] = (std::clamp(value, j.lower, j.upper) - j.offset) / j.multiplier;
  }
};

struct Tally {
  int single = 0, known = 0, free = 0;
};

/// Looks into random cells of a map, as far around as it claims to know.
void examine(const Claim& claim, Rng& rng, Tally& tally) {
  const auto scratch = claim.exact.make_scratch();
  for (int n = 0; n < 200; ++n) {
    VectorXd q(claim.exact.cell().dof());
    for (Eigen::Index j = 0; j < q.size(); ++j) {
      q[j] = rng.uniform(claim.exact.cell().lower()[j], claim.exact.cell().upper()[j]);
    }
    const int u = static_cast<int>(rng.index(JointMap::kSide));
    const int v = claim.is_single() ? 0 : static_cast<int>(rng.index(JointMap::kSide));
    const int room = claim.map.room[JointMap::at(u, v)];
    claim.set(0, u, std::max(room, 0), rng.uniform(0, 1), q);
    if (!claim.is_single()) claim.set(1, v, std::max(room, 0), rng.uniform(0, 1), q);
    const bool is_free = claim.exact.is_free(q, claim.pairs, *scratch);
    tally.free += is_free;
    if (room < 0) continue;
    ++tally.known;
    ASSERT_TRUE(is_free) << "cell " << u << ", " << v << ", room " << room;
  }
}

TEST(JointMaps, ClaimOnlyWhatTheExactCheckerFindsFree) {
  Tally tally;
  for (const test::RandomCellOptions& options : test::kinds_of_cells()) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      SCOPED_TRACE(seed);
      const SsvChecker exact(strict_cell(seed, options));
      const BatchChecker batch(exact);
      const BatchModel model(exact.cell());
      Rng rng(seed);
      for (const JointMap& map : prove_joint_maps(batch, model).all) {
        const Claim claim(map, model, exact);
        ASSERT_FALSE(claim.pairs.empty());
        tally.single += claim.is_single();
        ASSERT_NO_FATAL_FAILURE(examine(claim, rng, tally));
      }
    }
  }
  EXPECT_GT(tally.single, 20);
  // Boxes around shapes without a kernel overlap where the shapes do not.
  EXPECT_GT(tally.known, tally.free / 2) << tally.known << " of " << tally.free;
}

/// The maps of a random cell, given what is known of another.
JointMaps maps_of(const test::RandomCellOptions& options, const JointMaps& known) {
  const SsvChecker exact(strict_cell(1, options));
  return prove_joint_maps(BatchChecker(exact), BatchModel(exact.cell()), known);
}

TEST(JointMaps, AreTakenWhereTheyFollowFromTheSameOnly) {
  test::RandomCellOptions options;
  const JointMaps first = maps_of(options, {});
  ++options.obstacles;  // Concerns no link.
  const JointMaps again = maps_of(options, first);
  options.padding *= 2;
  const JointMaps padded = maps_of(options, first);
  ASSERT_GT(first.all.size(), 4U);
  ASSERT_EQ(again.all.size(), first.all.size());
  ASSERT_EQ(padded.all.size(), first.all.size());
  int between_joints = 0;
  for (std::size_t i = 0; i < first.all.size(); ++i) {
    // Those of two arms' first joints are seen from a frame that obstacles have a say in.
    const bool same_arm =
        first.all[i].joints[0] / options.joints == first.all[i].joints[1] / options.joints;
    if (same_arm) {
      EXPECT_EQ(again.all[i].rooms, first.all[i].rooms);
    }
    between_joints += same_arm;
    EXPECT_NE(padded.all[i].rooms, first.all[i].rooms);
  }
  EXPECT_GT(between_joints, 2);
}

}  // namespace
}  // namespace tandem::collision
