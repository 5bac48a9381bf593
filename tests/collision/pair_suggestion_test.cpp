// Proposals of pairs that need no check, on robots simple enough to know the answer.

#include "tandem/collision/pair_suggestion.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

namespace tandem::collision {
namespace {

using Eigen::Vector3d;
using geometry::Shape;
using Reasons = std::map<std::set<std::string>, SuggestionReason>;

robot::Link link(const std::string& name) {
  robot::Link made;
  made.name = name;
  return made;
}

robot::Joint joint(const std::string& name, int parent, int child, double at, double lower,
                   double upper, robot::JointType type = robot::JointType::kPrismatic) {
  robot::Joint made;
  made.name = name;
  made.type = type;
  made.parent_link = parent;
  made.child_link = child;
  made.X_PJ.translation().x() = at;
  made.limits.lower = lower;
  made.limits.upper = upper;
  return made;
}

std::vector<Shape> ball(double radius) { return {*Shape::sphere(Vector3d::Zero(), radius)}; }

/// Slides along x that all hang on "base" at 0, by way of "bare", which has no shape:
///   near  always inside base; far  never reaches anything; rest  touches near at 0, not everywhere;
///   meet  touches far now and then, never at 0.
world::RobotSpec rail() {
  world::RobotSpec spec;
  spec.name = "rail";
  std::vector<robot::Link> links = {link("base"), link("bare"), link("near"), link("far"),
                                    link("rest"), link("meet")};
  std::vector<robot::Joint> joints = {
      joint("weld", 0, 1, 0, 0, 0, robot::JointType::kFixed), joint("jn", 1, 2, 0, -0.1, 0.1),
      joint("jf", 2, 3, 9, 0, 1), joint("jr", 2, 4, 0, 0, 5), joint("jm", 2, 5, 5, 0, 4)};
  spec.model = *robot::Model::make("rail", links, joints);
  for (const char* name : {"base", "near", "far", "rest", "meet"}) spec.volumes[name] = ball(0.5);
  return spec;
}

Reasons suggested(const world::RobotSpec& spec, const SuggestionOptions& options = {}) {
  const auto pairs = suggest_disabled_pairs(spec, options);
  EXPECT_TRUE(pairs) << pairs.error().message;
  Reasons reasons;
  if (!pairs) return reasons;
  for (const PairSuggestion& pair : *pairs) {
    EXPECT_TRUE(reasons.emplace(std::set{pair.link_a, pair.link_b}, pair.reason).second);
  }
  return reasons;
}

TEST(PairSuggestion, KnowsTheFourReasons) {
  const Reasons expected = {
      {{"base", "near"}, SuggestionReason::kAdjacent},  // Past the link without a shape.
      {{"near", "far"}, SuggestionReason::kAdjacent},
      {{"near", "rest"}, SuggestionReason::kAdjacent},
      {{"near", "meet"}, SuggestionReason::kAdjacent},
      {{"base", "far"}, SuggestionReason::kNever},
      {{"base", "rest"}, SuggestionReason::kDefault},
      {{"base", "meet"}, SuggestionReason::kNever},
      {{"rest", "far"}, SuggestionReason::kNever},
      // {rest, meet} and {meet, far} touch now and then and must be checked.
  };
  EXPECT_EQ(suggested(rail()), expected);
}

TEST(PairSuggestion, AlwaysIsWhatTouchesInEverySampleButNotAtZero) {
  world::RobotSpec spec = rail();
  robot::JointLimits limits = spec.model.joints()[3].limits;
  ASSERT_EQ(spec.model.joints()[3].name, "jr");
  // At 0 it stays away by a hair; anywhere else in its range it touches.
  limits.lower = 0;
  limits.upper = 0.9;
  spec.model.set_limits(3, limits);
  spec.volumes["meet"] = {*Shape::sphere(Vector3d(-3.999999, 0, 0), 0.5)};  // At 1.000001 for jm = 0.
  limits = spec.model.joints()[4].limits;
  limits.upper = 1e-9;
  spec.model.set_limits(4, limits);
  const Reasons reasons = suggested(spec, {.samples = 300});
  EXPECT_EQ(reasons.at({"rest", "meet"}), SuggestionReason::kAlways);
}

TEST(PairSuggestion, LeavesOutWhatIsDisabledAlready) {
  world::RobotSpec spec = rail();
  spec.semantics.disabled_pairs = {{"base", "near", "Adjacent"}, {"rest", "meet", "User"}};
  const Reasons reasons = suggested(spec);
  EXPECT_FALSE(reasons.contains({"base", "near"}));
  EXPECT_FALSE(reasons.contains({"rest", "meet"}));
  EXPECT_EQ(reasons.size(), 7u);
}

TEST(PairSuggestion, EqualSeedsAgreeAndEndlessJointsTurnOnce) {
  world::RobotSpec spec = rail();
  robot::JointLimits none;
  spec.model = *robot::Model::make(
      "turner", {link("base"), link("a"), link("b")},
      {joint("ja", 0, 1, 1, 0, 0, robot::JointType::kContinuous),
       joint("jb", 1, 2, 1, 0, 0, robot::JointType::kContinuous)});
  spec.model.set_limits(0, none);
  spec.model.set_limits(1, none);
  spec.volumes = {{"base", ball(0.3)}, {"a", ball(0.3)}, {"b", ball(0.3)}};
  // The joints turn about x, along which everything lies: nothing ever moves nearer.
  EXPECT_EQ(suggested(spec).at({"base", "b"}), SuggestionReason::kNever);
  EXPECT_EQ(suggested(rail(), {.samples = 20, .seed = 7}),
            suggested(rail(), {.samples = 20, .seed = 7}));
}

TEST(PairSuggestion, StopsOnRequest) {
  std::stop_source source;
  source.request_stop();
  SuggestionOptions options;
  options.stop = StopCondition::after(1e9, source.get_token());
  const auto pairs = suggest_disabled_pairs(rail(), options);
  ASSERT_FALSE(pairs);
  EXPECT_EQ(pairs.error().code, ErrorCode::kCancelled);
}

}  // namespace
}  // namespace tandem::collision
