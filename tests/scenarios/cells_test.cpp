// The shelf, bins and handover cells are what they say: furniture that stands, goals that both arms
// reach, plans that pass an independent check.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "tandem/geometry/distance.h"
#include "tandem/io/workcell_yaml.h"
#include "tandem/pipeline/plan.h"
#include "tandem/verification/verify.h"
#include "test_data.h"

namespace tandem {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;
using geometry::Shape;
using Cell = std::shared_ptr<const world::Workcell>;

struct Scenario {
  const char* file;
  const char* data;  ///< What the cell needs of the test data; "" if nothing.
};

void PrintTo(const Scenario& scenario, std::ostream* out) { *out << scenario.file; }

class Cells : public ::testing::TestWithParam<Scenario> {
 protected:
  void SetUp() override {
    if (*GetParam().data) {
      TANDEM_SKIP_WITHOUT_DATA(GetParam().data);
      setenv("TANDEM_DATA_DIR", test::data_path("").c_str(), 0);
    }
    auto loaded = io::load_workcell(test::source_path("scenarios") / GetParam().file);
    ASSERT_TRUE(loaded) << loaded.error().message;
    cell_ = *loaded;
  }

  /// Both ends of every query, in their order.
  std::vector<pipeline::ResolvedQuery> ends() const {
    std::vector<pipeline::ResolvedQuery> all;
    for (const world::Query& query : cell_->queries()) {
      const auto resolved = pipeline::resolve(cell_, query);
      EXPECT_TRUE(resolved) << resolved.error().message;
      if (resolved) all.push_back(*resolved);
    }
    return all;
  }

  Cell cell_;
};

double top_of(const Shape& shape) { return shape.support(Vector3d::UnitZ()).z() + shape.radius(); }
double bottom_of(const Shape& shape) {
  return shape.support(-Vector3d::UnitZ()).z() - shape.radius();
}

TEST_P(Cells, FurnitureStandsAndPassesThroughNothing) {
  const auto& obstacles = cell_->spec().obstacles;
  for (std::size_t i = 0; i < obstacles.size(); ++i) {
    double bottom = 1e9;
    for (const Shape& shape : obstacles[i].shapes_W) bottom = std::min(bottom, bottom_of(shape));
    bool stands = std::abs(bottom) < 1e-9;
    for (std::size_t j = 0; j < obstacles.size(); ++j) {
      if (i == j) continue;
      for (const Shape& a : obstacles[i].shapes_W) {
        for (const Shape& b : obstacles[j].shapes_W) {
          const double distance = geometry::distance(a, b);
          EXPECT_GT(distance, -1e-6) << obstacles[i].name << " in " << obstacles[j].name;
          stands = stands || (distance < 1e-6 && std::abs(bottom_of(a) - bottom) < 1e-9 &&
                              std::abs(top_of(b) - bottom) < 1e-9);
        }
      }
    }
    EXPECT_TRUE(stands) << obstacles[i].name << " floats at " << bottom << " m";
  }
}

TEST_P(Cells, QueriesAreFeasibleAndMoveBothArms) {
  EXPECT_GE(cell_->queries().size(), 4u);
  EXPECT_LE(cell_->queries().size(), 8u);
  for (const pipeline::ResolvedQuery& query : ends()) {
    const auto feasible = pipeline::check_ends(*cell_, query);
    EXPECT_TRUE(feasible) << feasible.error().message;
    for (const world::Arm& arm : cell_->arms()) {
      const VectorXd moved = (query.goal - query.start).segment(arm.offset, arm.dof());
      EXPECT_GT(moved.cwiseAbs().maxCoeff(), 0.1) << query.name << ": " << arm.name;
    }
  }
}

TEST_P(Cells, ArmsShareTheirSpace) {
  int pairs = 0;
  for (const world::BodyPair& pair : cell_->pairs()) {
    const world::Body& a = cell_->bodies()[static_cast<std::size_t>(pair.a)];
    const world::Body& b = cell_->bodies()[static_cast<std::size_t>(pair.b)];
    pairs += a.moved_by && b.moved_by && a.moved_by != b.moved_by;
  }
  EXPECT_GE(pairs, 49);
  double nearest = 1e9;
  VectorXd positions;
  robot::LinkPoses X_WL;
  for (const pipeline::ResolvedQuery& query : ends()) {
    cell_->forward_kinematics(query.goal, positions, X_WL);
    nearest = std::min(
        nearest,
        (cell_->tool_pose(0, X_WL).translation() - cell_->tool_pose(1, X_WL).translation()).norm());
  }
  EXPECT_LT(nearest, 0.4);
}

TEST_P(Cells, PlansPassTheIndependentCheck) {
  for (const world::Query& query : cell_->queries()) {
    SCOPED_TRACE(query.name);
    // Generous, for builds with sanitizers.
    const auto plan = pipeline::plan(cell_, query, {.deadline = 120});
    ASSERT_TRUE(plan) << plan.error().message;
    const auto report = verification::verify(cell_, plan->trajectory, plan->ends.start,
                                             plan->ends.goal, {.rate = 50});
    ASSERT_TRUE(report) << report.error().message;
    for (const std::string& failure : report->failures) ADD_FAILURE() << failure;
  }
}

TEST_P(Cells, HandsMeetInTheHandover) {
  if (!std::string(GetParam().file).starts_with("handover")) GTEST_SKIP() << "no handover";
  int meetings = 0;
  VectorXd positions;
  robot::LinkPoses X_WL;
  for (const pipeline::ResolvedQuery& query : ends()) {
    if (!query.name.starts_with("meet")) continue;
    ++meetings;
    cell_->forward_kinematics(query.goal, positions, X_WL);
    const Eigen::Isometry3d left = cell_->tool_pose(0, X_WL), right = cell_->tool_pose(1, X_WL);
    EXPECT_LE((left.translation() - right.translation()).norm(), 0.0505)
        << query.name;  // Rounded joint values.
    EXPECT_LT(left.linear().col(2).dot(right.linear().col(2)), -0.999) << "face to face";
  }
  EXPECT_EQ(meetings, 4);
}

INSTANTIATE_TEST_SUITE_P(Scenarios, Cells,
                         ::testing::Values(Scenario{"shelf/workcell.yaml", ""},
                                           Scenario{"bins/workcell.yaml", ""},
                                           Scenario{"handover/workcell.yaml", ""},
                                           Scenario{"shelf/fr3_duo.yaml", "robots/fr3_duo"},
                                           Scenario{"bins/dual_ur5e.yaml", "robots/dual_ur5e"},
                                           Scenario{"handover/baxter.yaml", "robots/baxter_mbm"}),
                         [](const auto& scenario) {
                           std::string name = scenario.param.file;
                           name = name.substr(0, name.size() - 5);
                           std::ranges::replace(name, '/', '_');
                           return name;
                         });

}  // namespace
}  // namespace tandem
