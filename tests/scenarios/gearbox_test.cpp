// The gearbox cell is what it says: thin walls, deep and near goals, standing furniture.

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "tandem/collision/ssv_checker.h"
#include "tandem/io/workcell_yaml.h"
#include "tandem/pipeline/plan.h"
#include "test_data.h"

namespace tandem {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using geometry::Shape;

const std::vector<std::string> kQueries = {"grasp_box_table", "pick_gears",        "drop_gears",
                                           "pick_bolts",      "drop_bolts",        "pick_shafts",
                                           "drop_shafts",     "grasp_box_platform"};
const char* const kArms[] = {"left", "right"};

/// An axis-aligned box in W.
struct Extent {
  Vector3d low = Vector3d::Constant(1e9), high = Vector3d::Constant(-1e9);
  void add(const Shape& shape_W) {
    for (int k = 0; k < 3; ++k) {
      const Vector3d axis = Vector3d::Unit(k) * shape_W.radius();
      high[k] = std::max(high[k], (shape_W.support(Vector3d::Unit(k)) + axis)[k]);
      low[k] = std::min(low[k], (shape_W.support(-Vector3d::Unit(k)) - axis)[k]);
    }
  }
};

Extent extent_of(const std::vector<Shape>& shapes) {
  Extent extent;
  for (const Shape& shape : shapes) extent.add(shape);
  return extent;
}

class Gearbox : public ::testing::Test {
 protected:
  void SetUp() override {
    auto loaded = io::load_workcell(test::source_path("scenarios/gearbox/workcell.yaml"));
    ASSERT_TRUE(loaded) << loaded.error().message;
    cell_ = *loaded;
    checker_ = std::make_unique<collision::SsvChecker>(cell_);
    scratch_ = checker_->make_scratch();
  }

  const std::vector<Shape>& obstacle(const std::string& name) const {
    return cell_->bodies()[static_cast<std::size_t>(cell_->find_body(name))].shapes_L;
  }

  /// Walls are the rounded rectangles of a container.
  std::vector<Shape> walls(const std::string& name) const {
    std::vector<Shape> found;
    for (const Shape& shape : obstacle(name)) {
      if (shape.type() == geometry::CoreType::kRectangle) found.push_back(shape);
    }
    return found;
  }

  VectorXd goal(const std::string& query) const {
    VectorXd q(cell_->dof());
    for (std::size_t i = 0; i < 2; ++i) {
      q.segment(cell_->arms()[i].offset, 7) =
          std::get<world::JointGoal>(*cell_->query(query).goal[i]).q;
    }
    return q;
  }

  void place(const VectorXd& q) { cell_->forward_kinematics(q, positions_, X_WL_); }

  Isometry3d pose(const std::string& link) const {
    return X_WL_[static_cast<std::size_t>(cell_->model().find_link(link))];
  }

  /// The URDF's box of a finger, in W: smaller than its volume, larger than its mesh.
  Extent finger(const std::string& arm, const std::string& side) const {
    const std::string name = arm + "/panda_" + side + "finger";
    const auto link = static_cast<std::size_t>(cell_->model().find_link(name));
    const robot::Geometry& g = cell_->model().links()[link].collision.front();
    const Vector3d size = std::get<robot::BoxGeometry>(g.shape).size;
    return extent_of({Shape::box(g.X_LG, size)->in(X_WL_[link])});
  }

  /// How far both fingers of an arm reach below the rim of a container [m].
  double depth_below_rim(const std::string& arm, const std::string& container) const {
    const double rim = extent_of(walls(container)).high.z();
    return rim - std::max(finger(arm, "left").low.z(), finger(arm, "right").low.z());
  }

  std::shared_ptr<const world::Workcell> cell_;
  std::unique_ptr<collision::SsvChecker> checker_;
  std::unique_ptr<collision::CollisionChecker::Scratch> scratch_;
  VectorXd positions_;
  robot::LinkPoses X_WL_;
};

std::string container_of(const std::string& query) {
  if (query.starts_with("pick")) return "storage";
  return query == "grasp_box_table" ? "box_table" : "box_platform";
}

TEST_F(Gearbox, EightQueriesInAChain) {
  ASSERT_EQ(cell_->queries().size(), kQueries.size());
  VectorXd previous;
  for (std::size_t k = 0; k < kQueries.size(); ++k) {
    const world::Query& query = cell_->queries()[k];
    EXPECT_EQ(query.name, kQueries[k]);
    for (const auto& place : query.goal) {
      EXPECT_TRUE(place && std::holds_alternative<world::JointGoal>(*place)) << query.name;
    }
    const auto ends = pipeline::resolve(cell_, query);
    ASSERT_TRUE(ends) << ends.error().message;
    if (k > 0) {
      EXPECT_EQ(ends->start, previous) << query.name;
    }
    previous = ends->goal;
    const auto feasible = pipeline::check_ends(*cell_, *ends);
    EXPECT_TRUE(feasible) << feasible.error().message;
  }
}

TEST_F(Gearbox, GoalsAndHomeAreClearByFiveMillimetres) {
  constexpr double kClear = 0.005;
  const world::PairSelection all = cell_->select(world::PairScope::all());
  const auto clear = [&](const VectorXd& q, const std::string& what) {
    const auto nearest = checker_->least_clearance(q, all, *scratch_);
    EXPECT_GE(nearest.distance, kClear) << what << ": " << collision::describe(*cell_, nearest);
  };
  clear(pipeline::resolve(cell_, cell_->queries().front())->start, "home");
  for (const std::string& query : kQueries) clear(goal(query), query);
}

TEST_F(Gearbox, FingersReachFortyMillimetresBelowTheRims) {
  for (const std::string& query : kQueries) {
    place(goal(query));
    for (const char* arm : kArms) {
      EXPECT_GE(depth_below_rim(arm, container_of(query)), 0.040) << query << ' ' << arm;
    }
  }
}

TEST_F(Gearbox, WallsAreThin) {
  for (const char* container : {"storage", "box_table", "box_platform"}) {
    const std::vector<Shape> thin = walls(container);
    EXPECT_GE(thin.size(), 4u) << container;
    const double rim = extent_of(thin).high.z();
    for (const Shape& wall : thin) {
      EXPECT_LE(2 * wall.radius(), 0.005 + 1e-12) << container;
      EXPECT_NEAR(extent_of({wall}).high.z(), rim, 1e-9) << container;
    }
  }
}

TEST_F(Gearbox, HandsDropTogetherIntoTheBox) {
  const Extent box = extent_of(walls("box_platform"));
  for (const char* query : {"drop_gears", "drop_bolts", "drop_shafts"}) {
    place(goal(query));
    const auto tool = [&](const char* link) -> Vector3d { return pose(link).translation(); };
    EXPECT_LE((tool("left/panda_hand_tcp") - tool("right/panda_hand_tcp")).norm(), 0.25) << query;
    EXPECT_LE((tool("left/panda_hand") - tool("right/panda_hand")).norm(), 0.25) << query;
    for (const char* arm : kArms) {
      for (const char* side : {"left", "right"}) {
        const Extent tip = finger(arm, side);
        EXPECT_TRUE((tip.low.head<2>().array() > box.low.head<2>().array()).all()) << query;
        EXPECT_TRUE((tip.high.head<2>().array() < box.high.head<2>().array()).all()) << query;
      }
    }
  }
}

TEST_F(Gearbox, PartsLieBetweenTheOpenFingers) {
  for (const std::string part : {"gear", "bolt", "shaft"}) {
    place(goal("pick_" + part + "s"));
    for (const std::string arm : kArms) {
      const Extent piece = extent_of(obstacle(part + "_" + arm));
      const Vector3d p_WC = 0.5 * (piece.low + piece.high);
      const Isometry3d X_WE = pose(arm + "/panda_hand_tcp");
      const Vector3d p_EC = X_WE.inverse() * p_WC;
      EXPECT_LT(p_EC.head<2>().norm(), 0.002) << part << ' ' << arm;
      // Seen from the side, piece and fingertips overlap.
      EXPECT_GT(piece.high.z(), finger(arm, "left").low.z() + 0.005) << part << ' ' << arm;
      EXPECT_LT(X_WE.linear().col(2).z(), -0.999) << "the hand points down";
    }
  }
}

TEST_F(Gearbox, GripsHoldAWallBetweenTheFingers) {
  for (const char* query : {"grasp_box_table", "grasp_box_platform"}) {
    place(goal(query));
    const Extent box = extent_of(walls(container_of(query)));
    for (const std::string arm : kArms) {
      const double side = arm == "left" ? 1 : -1;
      const double outer = side > 0 ? box.high.y() : -box.low.y();
      double inmost = 1e9, outmost = -1e9;
      for (const char* which : {"left", "right"}) {
        const Extent tip = finger(arm, which);
        const double y = side * 0.5 * (tip.low.y() + tip.high.y());
        inmost = std::min(inmost, y);
        outmost = std::max(outmost, y);
        EXPECT_GT(tip.low.x(), box.low.x()) << query << ' ' << arm;
        EXPECT_LT(tip.high.x(), box.high.x()) << query << ' ' << arm;
      }
      EXPECT_LT(inmost, outer - 0.005) << query << ' ' << arm;
      EXPECT_GT(outmost, outer) << query << ' ' << arm;
    }
  }
}

/// Whether `foot` is the bottom of something that stands on `base`, at least in part.
bool stands_on(const Extent& foot, const Extent& base) {
  const bool above = (foot.low.head<2>().array() < base.high.head<2>().array()).all() &&
                     (foot.high.head<2>().array() > base.low.head<2>().array()).all();
  return above && std::abs(foot.low.z() - base.high.z()) < 1e-9;
}

TEST_F(Gearbox, EverythingStandsOnSomething) {
  Extent floor;
  floor.low = {-10, -10, -1};
  floor.high = {10, 10, 0};
  std::vector<Extent> bases = {floor};
  std::map<std::string, Extent> things;
  for (const world::ObstacleSpec& obstacle : cell_->spec().obstacles) {
    for (const Shape& shape : obstacle.shapes_W) bases.push_back(extent_of({shape}));
    things[obstacle.name] = extent_of(obstacle.shapes_W);
  }
  for (const world::RobotSpec& robot : cell_->spec().robots) {
    things[robot.name].low = things[robot.name].high = robot.X_WB.translation();
  }
  for (const auto& [name, thing] : things) {
    const bool stands = std::any_of(bases.begin(), bases.end(),
                                    [&](const Extent& base) { return stands_on(thing, base); });
    EXPECT_TRUE(stands) << name << " floats";
  }
}

TEST_F(Gearbox, DefaultPresetSolvesTheCycle) {
  for (const world::Query& query : cell_->queries()) {
    // Generous, for builds with sanitizers; an optimised one needs a tenth of a second.
    const auto plan = pipeline::plan(cell_, query, {.deadline = 60});
    EXPECT_TRUE(plan) << query.name << ": " << plan.error().message;
  }
}

}  // namespace
}  // namespace tandem
