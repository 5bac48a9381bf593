// The gearbox cell's list `cycle`: the eight motions with the parts in the hands.

#include <gtest/gtest.h>

#include <limits>

#include "tandem/geometry/distance.h"
#include "tandem/io/workcell_yaml.h"
#include "tandem/pipeline/plan.h"
#include "tandem/verification/verify.h"
#include "test_data.h"

namespace tandem {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using geometry::Shape;
using world::Body;
using world::Workcell;

const char* const kArms[] = {"left", "right"};
const char* const kParts[] = {"gear", "bolt", "shaft"};

const Body& body(const Workcell& cell, const std::string& name) {
  return cell.bodies()[static_cast<std::size_t>(cell.find_body(name))];
}

std::vector<Shape> in_world(const Workcell& cell, const Body& body, const VectorXd& q) {
  VectorXd positions;
  robot::LinkPoses X_WL;
  cell.forward_kinematics(q, positions, X_WL);
  std::vector<Shape> shapes_W;
  for (const Shape& shape : body.shapes_L) {
    shapes_W.push_back(shape.in(X_WL[static_cast<std::size_t>(body.link)]));
  }
  return shapes_W;
}

double distance(const std::vector<Shape>& a_W, const std::vector<Shape>& b_W) {
  double least = std::numeric_limits<double>::infinity();
  for (const Shape& a : a_W) {
    for (const Shape& b : b_W) least = std::min(least, geometry::distance(a, b));
  }
  return least;
}

double distance(const Workcell& cell, const std::string& a, const std::string& b,
                const VectorXd& q) {
  return distance(in_world(cell, body(cell, a), q), in_world(cell, body(cell, b), q));
}

class GearboxCycle : public ::testing::Test {
 protected:
  void SetUp() override {
    auto loaded = io::load_workcell(test::source_path("scenarios/gearbox/workcell.yaml"));
    ASSERT_TRUE(loaded) << loaded.error().message;
    cell_ = *loaded;
    auto list = cell_->find_list("cycle");
    ASSERT_TRUE(list) << list.error().message;
    auto resolved = pipeline::resolve_all(cell_, **list);
    ASSERT_TRUE(resolved) << resolved.error().message;
    queries_ = std::move(*resolved);
  }

  const pipeline::ResolvedQuery& query(const std::string& name) const {
    for (const auto& one : queries_) {
      if (one.name == "cycle/" + name) return one;
    }
    throw std::runtime_error("no query " + name);
  }

  std::shared_ptr<const Workcell> cell_;
  std::vector<pipeline::ResolvedQuery> queries_;
};

TEST_F(GearboxCycle, IsTheSameEightMotions) {
  ASSERT_EQ(queries_.size(), cell_->queries().size());
  for (std::size_t i = 0; i < queries_.size(); ++i) {
    const auto empty = pipeline::resolve(cell_, cell_->queries()[i]);
    ASSERT_TRUE(empty);
    EXPECT_EQ(queries_[i].name, "cycle/" + empty->name);
    EXPECT_EQ(queries_[i].start, empty->start);
    EXPECT_EQ(queries_[i].goal, empty->goal);
  }
}

TEST_F(GearboxCycle, EveryPartIsCarriedOnceAndLeft) {
  for (const std::string part : kParts) {
    for (const std::string arm : kArms) {
      const std::string name = part + "_" + arm;
      std::string states;
      for (const auto& one : queries_) {
        const auto object = one.cell->find_object(name);
        ASSERT_TRUE(object);
        states += object->carried() ? 'c' : one.cell->scene().objects.contains(name) ? 'd' : 's';
        EXPECT_TRUE(!object->carried() || object->link == arm + "/panda_hand_tcp");
      }
      // Standing until it is picked, carried in one motion, done with after that.
      EXPECT_EQ(states, part == "gear" ? "sscddddd" : part == "bolt" ? "sssscddd" : "sssssscd");
    }
  }
}

// Hand and part are not checked against each other, for nothing could come of it; so here.
TEST_F(GearboxCycle, CarriedPartsLieBetweenTheFingersAndNotThroughThem) {
  for (const std::string part : kParts) {
    const auto& carry = query("drop_" + part + "s");
    for (const std::string arm : kArms) {
      const std::string name = part + "_" + arm;
      double fingers[2], closing[2];
      for (const int side : {0, 1}) {
        const std::string finger = arm + (side ? "/panda_rightfinger" : "/panda_leftfinger");
        fingers[side] = distance(*carry.cell, name, finger, carry.start);
      }
      for (const char* link : {"/panda_hand", "/panda_link7"}) {
        EXPECT_GT(distance(*carry.cell, name, arm + link, carry.start), 0.01) << name;
      }
      // Both fingers reach it when the hand closes, each within its 40 mm.
      for (const int side : {0, 1}) {
        EXPECT_GT(fingers[side], 0.002) << name;
        EXPECT_LT(fingers[side], 0.04) << name;
      }
      const Body& b = body(*carry.cell, name);
      const int tool = carry.cell->arms()[arm == "left" ? 0 : 1].tip_link;
      ASSERT_EQ(b.link, tool);
      const auto extent = [&](const Vector3d& axis) {
        double high = -1;
        for (const Shape& shape : b.shapes_L) {
          high = std::max(high, shape.support(axis).dot(axis) + shape.radius());
        }
        return high;
      };
      closing[0] = extent(Vector3d::UnitY());
      closing[1] = extent(-Vector3d::UnitY());
      EXPECT_LT(std::max(closing[0], closing[1]), 0.04) << name << ": wider than the open hand";
      EXPECT_GT(std::min(closing[0], closing[1]), 0) << name << ": beside the grip's middle";
      EXPECT_GT(extent(-Vector3d::UnitZ()), 0) << name << ": below the tool's centre";
    }
  }
}

TEST_F(GearboxCycle, PartsEndUpOnTheFloorOfTheBoxSideBySide) {
  const Workcell& end = *queries_.back().cell;
  const VectorXd& q = queries_.back().goal;
  std::vector<std::string> names;
  for (const std::string part : kParts) {
    for (const std::string arm : kArms) names.push_back(part + "_" + arm);
  }
  const std::vector<Shape>& box = body(end, "box_platform").shapes_L;
  const std::vector<Shape> floor(box.begin(), box.begin() + 1), walls(box.begin() + 1, box.end());
  for (const std::string& name : names) {
    const std::vector<Shape> part = in_world(end, body(end, name), q);
    EXPECT_NEAR(distance(part, floor), 0, 1e-9) << name << " neither floats nor sinks";
    EXPECT_GT(distance(part, walls), 0.005) << name;
    const Vector3d p = part[0].origin() - Vector3d(0.286, 0, 0.68);
    EXPECT_TRUE(std::abs(p.x()) < 0.1 && std::abs(p.y()) < 0.15) << name << " is in the box";
    for (const std::string& other : names) {
      if (other > name) {
        EXPECT_GT(distance(end, name, other, q), 0.005) << name << ' ' << other;
      }
    }
    for (const std::string finger : {"left/panda_leftfinger", "right/panda_rightfinger"}) {
      EXPECT_GT(distance(end, name, finger, query("drop_shafts").goal), 0.03) << name;
    }
  }
}

TEST_F(GearboxCycle, OnlyTheFloorOfTheStorageMayBeTouched) {
  for (const auto& one : queries_) {
    for (const world::AllowedPair& pair : one.cell->scene().allowed) {
      EXPECT_EQ(pair.b, "storage_floor");
    }
  }
  const Workcell& lifting = *query("drop_gears").cell;
  for (const char* other : {"storage", "box_platform", "bolt_left", "gear_right",
                            "right/panda_hand", "left/panda_link5", "platform"}) {
    const int a = lifting.find_body("gear_left"), b = lifting.find_body(other);
    ASSERT_GE(b, 0) << other;
    EXPECT_TRUE(std::ranges::any_of(lifting.pairs(), [&](const world::BodyPair& pair) {
      return pair.a == std::min(a, b) && pair.b == std::max(a, b);
    })) << other;
  }
}

TEST_F(GearboxCycle, DefaultPresetSolvesItAndVerifyAgrees) {
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    for (const auto& one : queries_) {
      // Generous, for builds with sanitizers.
      const auto plan = pipeline::plan(cell_, one, {.seed = seed, .deadline = 60});
      ASSERT_TRUE(plan) << one.name << ": " << plan.error().message;
      EXPECT_EQ(plan->ends.cell, one.cell);
      const auto report =
          verification::verify(one.cell, plan->trajectory, one.start, one.goal, {.rate = 50});
      ASSERT_TRUE(report) << report.error().message;
      EXPECT_TRUE(report->ok()) << one.name << ": " << report->failures.front();
    }
  }
}

// Plans that were made for empty hands: with the parts in them, some hit something.
TEST_F(GearboxCycle, PartsMatter) {
  int bad = 0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    for (const char* name : {"drop_gears", "drop_bolts", "drop_shafts"}) {
      const auto plan = pipeline::plan(cell_, cell_->query(name), {.seed = seed, .deadline = 60});
      ASSERT_TRUE(plan) << plan.error().message;
      const auto& ends = query(name);
      const auto report =
          verification::verify(ends.cell, plan->trajectory, ends.start, ends.goal, {.rate = 50});
      ASSERT_TRUE(report) << report.error().message;
      bad += report->ok() ? 0 : 1;
    }
  }
  EXPECT_GT(bad, 0);
  std::printf("%d of 9 plans for empty hands are no good with parts\n", bad);
}

}  // namespace
}  // namespace tandem
