#include "tandem/pipeline/bench.h"

#include <gtest/gtest.h>

#include "small_cell.h"

namespace tandem::pipeline {
namespace {

TEST(Statistics, MatchesHandComputedValues) {
  const Statistics s = Statistics::of({4, 1, 3, 2, 5});
  EXPECT_DOUBLE_EQ(s.mean, 3);
  EXPECT_DOUBLE_EQ(s.std, std::sqrt(2.5));
  EXPECT_DOUBLE_EQ(s.p50, 3);
  EXPECT_DOUBLE_EQ(s.p95, 4.8);
  EXPECT_DOUBLE_EQ(s.max, 5);
  EXPECT_DOUBLE_EQ(Statistics::of({}).mean, 0);
  EXPECT_DOUBLE_EQ(Statistics::of({7}).std, 0);
  EXPECT_DOUBLE_EQ(Statistics::of({7}).p99, 7);
}

TEST(Bench, RunsEveryQueryOfEveryCycleWithItsOwnSeed) {
  int calls = 0;
  const auto result = bench(test::small_cell(), 2, {}, [&](const BenchRun&, int done, int total) {
    EXPECT_EQ(done, ++calls);
    EXPECT_EQ(total, 4);
  });
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_EQ(result->cycles, 2);
  ASSERT_EQ(result->runs.size(), 4u);
  EXPECT_EQ(result->runs[2].query, "cross");
  EXPECT_EQ(result->runs[2].cycle, 1);
  for (const BenchRun& run : result->runs) EXPECT_TRUE(run.success) << run.message;
  EXPECT_NE(result->runs[0].duration, result->runs[2].duration);
}

TEST(Bench, KeepsWhatItHasWhenStopped) {
  std::stop_source source;
  PlanOptions options;
  options.token = source.get_token();
  const auto result = bench(test::small_cell(), 100, options, [&](const BenchRun&, int done, int) {
    if (done == 3) source.request_stop();
  });
  ASSERT_TRUE(result);
  EXPECT_EQ(result->runs.size(), 3u);
  EXPECT_EQ(result->cycles, 1);
}

/// The cell with a list in which the left arm takes a ball that reaches into the table then, so
/// that its second query cannot be stood at, and puts it far away.
std::shared_ptr<const world::Workcell> cell_with_round() {
  auto spec = test::small_cell_spec();
  const auto cell = test::small_cell();
  Eigen::VectorXd positions;
  robot::LinkPoses X_WL;
  cell->forward_kinematics(resolve(cell, cell->query("cross"))->goal, positions, X_WL);
  const auto at = [](double x, double y, double z) {
    Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
    X.translation() = Eigen::Vector3d(x, y, z);
    return X;
  };
  spec.obstacles.push_back({"ball", {*geometry::Shape::sphere({0, 0, 0}, 0.02)}});
  spec.obstacles.back().shapes_W[0] = spec.obstacles.back().shapes_W[0].in(at(-1.5, 0, 0.5));
  spec.obstacles.back().X_WO = at(-1.5, 0, 0.5);
  auto reach = spec.queries[0], carry = spec.queries[1], leave = spec.queries[1];
  world::Attach grip;
  grip.object = "ball";
  grip.arm = "left";
  grip.pose = cell->tool_pose(0, X_WL).inverse() * at(0.3, -0.5, -0.03);
  carry.name = "carry";
  carry.changes.attach = {grip};
  leave.name = "leave";
  leave.changes.detach = {{"ball", at(-1.5, 0, 0.5)}};
  spec.lists = {{"round", {reach, carry, leave}}};
  return *world::Workcell::make(spec);
}

TEST(Bench, RunsAListInItsScenesAndGoesOnAfterAFailure) {
  const auto cell = cell_with_round();
  const auto result = bench(cell, 2, {}, {}, "round");
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_EQ(result->list, "round");
  ASSERT_EQ(result->runs.size(), 6u);
  for (std::size_t i = 0; i < 6; ++i) {
    const BenchRun& run = result->runs[i];
    EXPECT_EQ(run.query, (std::vector{"round/cross", "round/carry", "round/leave"})[i % 3]);
    EXPECT_EQ(run.success, i % 3 != 1) << run.message;
  }
  const std::string& message = result->runs[1].message;
  EXPECT_NE(message.find("start of query 'round/carry'"), std::string::npos) << message;
  EXPECT_NE(message.find("table and ball"), std::string::npos) << message;

  const auto unknown = bench(cell, 1, {}, {}, "runde");
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().code, ErrorCode::kNotFound);
}

TEST(Bench, NeedsQueries) {
  auto spec = test::small_cell_spec();
  spec.queries.clear();
  const auto result = bench(*world::Workcell::make(spec), 1, {}, {});
  ASSERT_FALSE(result);
  EXPECT_NE(result.error().message.find("no queries"), std::string::npos);
}

}  // namespace
}  // namespace tandem::pipeline
