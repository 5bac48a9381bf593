#include "tandem/io/plan_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "plan_samples.h"
#include "tandem/core/contract.h"

namespace tandem::io {
namespace {

using test::rough_plan;
using test::small_cell;
using test::TemporaryFolder;

void expect_same(const motion::PiecewiseCubic& a, const motion::PiecewiseCubic& b) {
  EXPECT_EQ(a.knots(), b.knots());
  ASSERT_EQ(a.segments().size(), b.segments().size());
  for (std::size_t k = 0; k < a.segments().size(); ++k) {
    EXPECT_TRUE((a.segments()[k].array() == b.segments()[k].array()).all()) << "segment " << k;
  }
}

void expect_same(const motion::ArmMotion& a, const motion::ArmMotion& b) {
  expect_same(a.spline(), b.spline());
  ASSERT_EQ(a.map().has_value(), b.map().has_value());
  if (!a.map()) return;
  EXPECT_EQ(a.map()->knots(), b.map()->knots());
  EXPECT_EQ(a.map()->segments(), b.map()->segments());
}

void expect_same(const pipeline::PlanReport& a, const pipeline::PlanReport& b) {
  EXPECT_NEAR(a.times.path_planning, b.times.path_planning, 1e-15);
  EXPECT_NEAR(a.times.total, b.times.total, 1e-15);
  EXPECT_EQ(a.times.plpp, b.times.plpp);
  EXPECT_EQ(a.counts.edge_checks, b.counts.edge_checks);
  EXPECT_EQ(a.counts.repairs, b.counts.repairs);
  ASSERT_EQ(a.arms.size(), b.arms.size());
  for (std::size_t i = 0; i < a.arms.size(); ++i) {
    EXPECT_EQ(a.arms[i].f_after, b.arms[i].f_after);
    EXPECT_EQ(a.arms[i].L_before, b.arms[i].L_before);
    EXPECT_EQ(a.arms[i].joint_length, b.arms[i].joint_length);
  }
  EXPECT_EQ(a.rungs, b.rungs);
  EXPECT_EQ(a.least_clearance, b.least_clearance);
  ASSERT_EQ(a.phases.size(), b.phases.size());
  for (std::size_t i = 0; i < a.phases.size(); ++i) {
    EXPECT_EQ(a.phases[i].name, b.phases[i].name);
    EXPECT_EQ(a.phases[i].path, b.phases[i].path);
  }
}

void expect_same(const world::SceneState& a, const world::SceneState& b) {
  ASSERT_EQ(a.objects.size(), b.objects.size());
  for (const auto& [name, object] : a.objects) {
    const world::ObjectState& other = b.objects.at(name);
    EXPECT_EQ(object.link, other.link);
    EXPECT_EQ(object.touching, other.touching);
    EXPECT_EQ(object.X_LO.translation(), other.X_LO.translation());
    // Through a quaternion and back.
    EXPECT_LT((object.X_LO.linear() - other.X_LO.linear()).norm(), 1e-14);
  }
  ASSERT_EQ(a.allowed.size(), b.allowed.size());
  for (std::size_t i = 0; i < a.allowed.size(); ++i) {
    EXPECT_EQ(a.allowed[i].a, b.allowed[i].a);
    EXPECT_EQ(a.allowed[i].b, b.allowed[i].b);
    EXPECT_EQ(a.allowed[i].reason, b.allowed[i].reason);
  }
}

TEST(PlanFile, RoundTripIsExact) {
  const TemporaryFolder folder;
  const auto cell = small_cell();
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const pipeline::Plan plan = rough_plan(*cell, seed);
    const auto saved = save_plan(folder / "plan.json", plan, *cell, true);
    ASSERT_TRUE(saved) << saved.error().message;
    const auto loaded = load_plan(folder / "plan.json");
    ASSERT_TRUE(loaded) << loaded.error().message;
    EXPECT_EQ(loaded->version, "0.1.0");
    EXPECT_EQ(loaded->query, "cross");
    EXPECT_EQ(loaded->strategy, "centralized");
    EXPECT_EQ(loaded->preset, seed % 2 ? "paper" : "default");
    EXPECT_EQ(loaded->seed, plan.seed);
    EXPECT_EQ(loaded->plpp, plan.plpp);
    EXPECT_EQ(loaded->arms, (std::vector<std::string>{"left", "right"}));
    ASSERT_EQ(loaded->joints.size(), 2u);
    EXPECT_EQ(loaded->joints[1].front(), "right/joint1");
    EXPECT_EQ(loaded->joints[1].size(), 4u);
    EXPECT_EQ(loaded->start, plan.ends.start);
    EXPECT_EQ(loaded->goal, plan.ends.goal);
    for (std::size_t i = 0; i < 2; ++i) {
      expect_same(loaded->trajectory.arms()[i], plan.trajectory.arms()[i]);
    }
    expect_same(loaded->report, plan.report);
    expect_same(loaded->scene, plan.ends.cell->scene());
  }
}

TEST(PlanFile, RebuildsTheSceneOfItsMotion) {
  const TemporaryFolder folder;
  const auto cell = small_cell();
  const auto plan = rough_plan(*cell, 11);
  ASSERT_TRUE(save_plan(folder / "plan.json", plan, *cell));
  const auto loaded = load_plan(folder / "plan.json");
  ASSERT_TRUE(loaded) << loaded.error().message;
  const auto rebuilt = in_scene_of(*loaded, cell);
  ASSERT_TRUE(rebuilt) << rebuilt.error().message;
  for (const world::BodyPair& pair : plan.ends.cell->pairs()) {
    EXPECT_TRUE(std::ranges::any_of((*rebuilt)->pairs(), [&](const world::BodyPair& other) {
      return other.a == pair.a && other.b == pair.b && other.moved_by == pair.moved_by;
    }));
  }
  EXPECT_EQ((*rebuilt)->pairs().size(), plan.ends.cell->pairs().size());
  EXPECT_NE((*rebuilt)->pairs().size(), cell->pairs().size());

  auto spec = test::small_cell_spec();
  spec.obstacles.pop_back();
  const auto other = in_scene_of(*loaded, *world::Workcell::make(spec));
  ASSERT_FALSE(other);
  EXPECT_NE(other.error().message.find("does not fit workcell 'small'"), std::string::npos);
  EXPECT_NE(other.error().message.find("'wall'"), std::string::npos) << other.error().message;
}

TEST(PlanFile, OfAnUnchangedCellHasAnEmptyScene) {
  const TemporaryFolder folder;
  const auto cell = small_cell();
  auto plan = rough_plan(*cell, 1);
  plan.ends.cell = nullptr;
  ASSERT_TRUE(save_plan(folder / "plan.json", plan, *cell));
  const auto loaded = load_plan(folder / "plan.json");
  ASSERT_TRUE(loaded);
  EXPECT_TRUE(loaded->scene.objects.empty() && loaded->scene.allowed.empty());
  EXPECT_EQ(*in_scene_of(*loaded, cell), cell);
}

TEST(PlanFile, SavingTwiceGivesTheSameBytes) {
  const TemporaryFolder folder;
  const auto cell = small_cell();
  const auto plan = rough_plan(*cell, 3);
  ASSERT_TRUE(save_plan(folder / "a.json", plan, *cell));
  ASSERT_TRUE(save_plan(folder / "b.json", plan, *cell));
  EXPECT_EQ(test::read_text(folder / "a.json"), test::read_text(folder / "b.json"));
}

TEST(PlanFile, HasTheKeysOfTheSchema) {
  const auto cell = small_cell();
  const auto text = plan_json(rough_plan(*cell, 4), *cell, "plan.json");
  ASSERT_TRUE(text);
  const auto json = nlohmann::json::parse(*text);
  EXPECT_EQ(json["schema_version"], 3);
  EXPECT_EQ(json["scene"]["objects"].size(), 2u);
  const auto& arm = json["arms"][0];
  EXPECT_EQ(arm["coefficients"].size() + 1, arm["knots"].size());
  EXPECT_EQ(arm["coefficients"][0].size(), arm["joints"].size());
  EXPECT_EQ(arm["coefficients"][0][0].size(), 4u);
  EXPECT_FALSE(arm.contains("time_map"));
  EXPECT_EQ(json["report"]["times_ms"].size(), 8u);
  EXPECT_TRUE(json["report"]["arms"]["left"].contains("L_after"));
}

TEST(PlanFile, OfTheVersionBeforeTimeMapsIsRead) {
  const TemporaryFolder folder;
  const auto cell = small_cell();
  const auto plan = rough_plan(*cell, 4);
  const auto text = plan_json(plan, *cell, folder / "plan.json");
  ASSERT_TRUE(text);
  auto json = nlohmann::json::parse(*text);
  json["schema_version"] = 2;
  test::write_text(folder / "plan.json", json.dump());
  const auto loaded = load_plan(folder / "plan.json");
  ASSERT_TRUE(loaded) << loaded.error().message;
  expect_same(loaded->trajectory.arms()[0], plan.trajectory.arms()[0]);
  json["arms"][0]["time_map"] = {{"knots", {0, 1}}, {"coefficients", {{0}}}};
  test::write_text(folder / "plan.json", json.dump());
  EXPECT_FALSE(load_plan(folder / "plan.json"));
}

TEST(PlanFile, WorkcellIsFoundFromThePlanFileAfterAMove) {
  const TemporaryFolder folder;
  namespace fs = std::filesystem;
  fs::create_directories(folder / "a/plans");
  fs::create_directories(folder / "a/cells");
  test::write_text(folder / "a/cells/cell.yaml", "");
  auto spec = test::small_cell_spec();
  spec.file = folder / "a/plans/../cells/cell.yaml";
  const auto cell = *world::Workcell::make(spec);
  ASSERT_TRUE(save_plan(folder / "a/plans/plan.json", rough_plan(*cell, 1), *cell));
  const auto json = nlohmann::json::parse(test::read_text(folder / "a/plans/plan.json"));
  EXPECT_EQ(json["workcell"], "../cells/cell.yaml");
  fs::rename(folder / "a", folder / "b");
  const auto loaded = load_plan(folder / "b/plans/plan.json");
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_TRUE(fs::equivalent(loaded->workcell, folder / "b/cells/cell.yaml"));
}

TEST(PlanFile, WorkcellIsFoundThroughALinkedFolder) {
  const TemporaryFolder folder;
  namespace fs = std::filesystem;
  fs::create_directories(folder / "deep/er/plans");
  fs::create_directory_symlink(folder / "deep/er/plans", folder / "plans");
  test::write_text(folder / "cell.yaml", "");
  auto spec = test::small_cell_spec();
  spec.file = folder / "cell.yaml";
  const auto cell = *world::Workcell::make(spec);
  ASSERT_TRUE(save_plan(folder / "plans/plan.json", rough_plan(*cell, 1), *cell));
  for (const char* way : {"plans/plan.json", "deep/er/plans/plan.json"}) {
    const auto loaded = load_plan(folder / way);
    ASSERT_TRUE(loaded) << loaded.error().message;
    EXPECT_TRUE(fs::equivalent(loaded->workcell, folder / "cell.yaml"));
  }
}

TEST(PlanFile, CellInMemoryLeavesTheWorkcellEmpty) {
  const TemporaryFolder folder;
  const auto cell = small_cell();
  ASSERT_TRUE(save_plan(folder / "plan.json", rough_plan(*cell, 1), *cell));
  EXPECT_TRUE(load_plan(folder / "plan.json")->workcell.empty());
}

TEST(PlanFile, ClearanceWithoutPairsIsInfinite) {
  const TemporaryFolder folder;
  const auto cell = small_cell();
  auto plan = rough_plan(*cell, 1);
  plan.report.least_clearance = std::numeric_limits<double>::infinity();
  ASSERT_TRUE(save_plan(folder / "plan.json", plan, *cell));
  EXPECT_EQ(load_plan(folder / "plan.json")->report.least_clearance,
            std::numeric_limits<double>::infinity());
}

TEST(PlanFile, RefusesToOverwriteUnlessAsked) {
  const TemporaryFolder folder;
  const auto cell = small_cell();
  test::write_text(folder / "plan.json", "mine");
  const auto refused = save_plan(folder / "plan.json", rough_plan(*cell, 1), *cell);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kInvalidInput);
  EXPECT_NE(refused.error().message.find("exists"), std::string::npos);
  EXPECT_EQ(test::read_text(folder / "plan.json"), "mine");
  EXPECT_TRUE(save_plan(folder / "plan.json", rough_plan(*cell, 1), *cell, true));
  EXPECT_TRUE(load_plan(folder / "plan.json"));
}

TEST(PlanFile, NamesThatAreNotUtf8AreAnError) {
  const auto cell = small_cell();
  auto plan = rough_plan(*cell, 1);
  plan.query = "pick_\xff";
  const auto text = plan_json(plan, *cell, "plan.json");
  ASSERT_FALSE(text);
  EXPECT_NE(text.error().message.find("UTF-8"), std::string::npos);
}

TEST(PlanFile, PlanOfAnotherCellBreaksTheContract) {
  const auto cell = small_cell();
  auto plan = rough_plan(*cell, 1);
  plan.trajectory = motion::CellMotion({plan.trajectory.arms()[0]});
  EXPECT_THROW((void)plan_json(plan, *cell, "plan.json"), ContractViolation);
  plan = rough_plan(*cell, 1);
  plan.ends.start[2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW((void)plan_json(plan, *cell, "plan.json"), ContractViolation);
}

}  // namespace
}  // namespace tandem::io
