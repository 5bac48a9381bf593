#include "tandem/verification/verify.h"

#include <gtest/gtest.h>

#include <cmath>

#include "motion/random_motions.h"
#include "tandem/core/rng.h"
#include "tandem/trajectory/limit_check.h"

namespace tandem::verification {
namespace {

using Eigen::Vector2d;
using Eigen::Vector4d;
using Eigen::VectorXd;
using motion::CellMotion;
using motion::PiecewiseCubic;
using Coefficients = PiecewiseCubic::Coefficients;

/// A planar arm in the plane z = 0.5 whose links are boxes: a first joint, a link of 0.4 m, a turn
/// about z and a link of 0.3 m; both 0.04 m wide.
robot::Model planar_arm(bool slides) {
  const auto bar = [](double length) {
    robot::Geometry geometry;
    geometry.X_LG.translation().x() = length / 2;
    geometry.shape = robot::BoxGeometry{{length, 0.04, 0.04}};
    return geometry;
  };
  std::vector<robot::Link> links(3);
  links[0].name = "base";
  links[1].name = "link1";
  links[1].collision = {bar(0.4)};
  links[2].name = "link2";
  links[2].collision = {bar(0.3)};
  std::vector<robot::Joint> joints(2);
  for (int i = 0; i < 2; ++i) {
    auto& joint = joints[static_cast<std::size_t>(i)];
    joint.name = "joint" + std::to_string(i + 1);
    joint.type = slides && i == 0 ? robot::JointType::kPrismatic : robot::JointType::kRevolute;
    joint.axis_J = joint.type == robot::JointType::kPrismatic ? Eigen::Vector3d::UnitX()
                                                              : Eigen::Vector3d::UnitZ();
    joint.parent_link = i;
    joint.child_link = i + 1;
    if (i == 1) joint.X_PJ.translation().x() = 0.4;
    joint.limits = {-2.5, 2.5, 2.0, 6.0, 40.0};
  }
  return robot::Model::make("planar", links, joints).value();
}

world::RobotSpec planar_robot(const std::string& name, bool slides, double x, double yaw) {
  world::RobotSpec spec;
  spec.name = name;
  spec.model = planar_arm(slides);
  spec.X_WB = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ());
  spec.X_WB.translation() = Eigen::Vector3d(x, 0, 0.5);
  robot::Group group;
  group.name = "arm";
  group.joints = {spec.model.find_joint("joint1"), spec.model.find_joint("joint2")};
  group.tip_link = spec.model.find_link("link2");
  spec.semantics.groups = {group};
  spec.semantics.disabled_pairs = {{"link1", "link2", "Adjacent"}};
  return spec;
}

/// Left turns at the origin, right slides towards it from x = 1.6; a post stands at (0.5, 0).
world::WorkcellSpec planar_spec() {
  world::WorkcellSpec spec;
  spec.name = "planar";
  spec.robots = {planar_robot("left", false, 0, 0), planar_robot("right", true, 1.6, M_PI)};
  for (const char* name : {"left", "right"}) {
    world::ArmSpec arm;
    arm.name = arm.robot = name;
    arm.group = "arm";
    spec.arms.push_back(arm);
  }
  spec.obstacles.push_back(
      {"post", {geometry::Shape::sphere(Eigen::Vector3d(0.5, 0, 0.5), 0.05).value()}});
  return spec;
}

std::shared_ptr<const world::Workcell> planar_cell() {
  auto cell = world::Workcell::make(planar_spec());
  if (!cell) throw std::runtime_error(cell.error().message);
  return *cell;
}

/// From a to b in `duration`: jerk +j, -j, -j, +j; C2, at rest and without acceleration at both
/// ends. Velocity peaks at 2 |b - a| / duration, acceleration at 8 |b - a| / duration^2, jerk is
/// 32 |b - a| / duration^3.
PiecewiseCubic glide(const VectorXd& a, const VectorXd& b, double duration) {
  const double h = duration / 4;
  const VectorXd j = (b - a) / (2 * h * h * h);
  std::vector<Coefficients> segments;
  VectorXd q = a, qd = VectorXd::Zero(a.size()), qdd = qd;
  for (double sign : {1.0, -1.0, -1.0, 1.0}) {
    Coefficients c(a.size(), 4);
    c << q, qd, qdd / 2, sign * j / 6;
    segments.push_back(c);
    q += h * qd + h * h / 2 * qdd + h * h * h / 6 * sign * j;
    qd += h * qdd + h * h / 2 * sign * j;
    qdd += h * sign * j;
  }
  return PiecewiseCubic::make({0, h, 2 * h, 3 * h, 4 * h}, segments).value();
}

/// `motion` with `change` added to the coefficients of joint 0 on segment k.
PiecewiseCubic changed(const PiecewiseCubic& motion, std::size_t k, const Vector4d& change) {
  auto segments = motion.segments();
  segments[k].row(0) += change;
  return PiecewiseCubic::make(motion.knots(), segments).value();
}

/// Both arms move a little, far from everything.
const Vector2d kLeftFrom(0.5, 0.1), kLeftTo(1.2, -0.2), kRightFrom(0, 0.3), kRightTo(0.1, -0.3);

VectorXd stacked(const Vector2d& left, const Vector2d& right) {
  VectorXd q(4);
  q << left, right;
  return q;
}

class Verify : public testing::Test {
 protected:
  /// Verifies left and right, whose ends are what they are told to be.
  VerifyReport run(const motion::ArmMotion& left, const motion::ArmMotion& right,
                   const VerifyOptions& options = {}) const {
    const auto end_of = [](const motion::ArmMotion& arm) { return Vector2d(arm.at(1e9).q); };
    const auto report =
        verify(cell_, CellMotion({left, right}), stacked(left.at(0).q, right.at(0).q),
               stacked(end_of(left), end_of(right)), options);
    if (!report) throw std::runtime_error(report.error().message);
    return *report;
  }
  /// One failure, this one.
  static void expect_only(const VerifyReport& report, const std::string& sentence) {
    ASSERT_EQ(report.failures.size(), 1u) << testing::PrintToString(report.failures);
    EXPECT_EQ(report.failures[0], sentence);
  }
  static void expect_among(const VerifyReport& report, const std::string& part) {
    for (const std::string& failure : report.failures) {
      if (failure.find(part) != std::string::npos) return;
    }
    ADD_FAILURE() << "no failure says '" << part
                  << "': " << testing::PrintToString(report.failures);
  }

  std::shared_ptr<const world::Workcell> cell_ = planar_cell();
  PiecewiseCubic left_ = glide(kLeftFrom, kLeftTo, 2), right_ = glide(kRightFrom, kRightTo, 2);
};

TEST_F(Verify, AGoodMotionPasses) {
  const VerifyReport report = run(left_, right_);
  EXPECT_TRUE(report.ok()) << testing::PrintToString(report.failures);
  EXPECT_EQ(report.samples, 2001);
  EXPECT_LT(report.largest_jumps.maxCoeff(), 1e-12);
  // Velocity comes nearest to its limit: 2 * 0.7 / 2 of 2; acceleration 8 * 0.7 / 2^2 of 6.
  EXPECT_NEAR(report.worst_limit_ratio, 0.35, 1e-12);
}

TEST_F(Verify, ReportsTheLeastClearance) {
  // Straight arm from 0.5 rad: the post is 0.5 sin(angle) from its axis.
  const VerifyReport report =
      run(glide(Vector2d(0.5, 0), Vector2d(1.2, 0), 2), glide(kRightFrom, kRightFrom, 2));
  EXPECT_TRUE(report.ok()) << testing::PrintToString(report.failures);
  EXPECT_NEAR(report.least_clearance, 0.5 * std::sin(0.5) - 0.02 - 0.05, 1e-5);
  EXPECT_EQ(report.nearest_pair, "left/link2 and post");
  EXPECT_EQ(report.nearest_time, 0);
}

TEST_F(Verify, SamplesAtTheRateAndAtTheEnd) {
  EXPECT_EQ(run(left_, right_, {.rate = 100}).samples, 201);
  EXPECT_EQ(run(left_, right_, {.rate = 99.9}).samples, 201);  // 0 to 199 and the end.
  EXPECT_EQ(run(left_, right_, {.rate = 0.1}).samples, 2);
  // Only the end touches the post.
  const auto report = run(glide(Vector2d(0.5, 0), Vector2d(0, 0), 2), right_, {.rate = 0.1});
  expect_among(report, "left/link2 and post touch from 2 s to 2 s (1 samples)");
}

TEST_F(Verify, AMotionThroughAnObstacle) {
  const auto left = glide(Vector2d(-0.7, 0), Vector2d(0.7, 0), 4);
  const VerifyReport report = run(left, right_);
  ASSERT_EQ(report.failures.size(), 1u) << testing::PrintToString(report.failures);
  // The arm touches where 0.5 sin |angle| is below 0.07.
  double first = 0;
  while (0.5 * std::sin(-left.at(first).q[0]) > 0.07) first += 1e-3;
  double first_said = 0, last_said = 0;
  long samples = 0;
  ASSERT_EQ(std::sscanf(report.failures[0].c_str(),
                        "left/link2 and post touch from %lf s to %lf s (%ld samples), deepest at",
                        &first_said, &last_said, &samples),
            3)
      << report.failures[0];
  EXPECT_NEAR(first_said, first, 1.5e-3);
  EXPECT_NEAR(last_said, 4 - first, 1.5e-3);
  EXPECT_NEAR(static_cast<double>(samples), 1e3 * (4 - 2 * first), 3);
  EXPECT_EQ(report.nearest_pair, "left/link2 and post");
  EXPECT_LE(report.least_clearance, 0);
}

TEST_F(Verify, ThinContactsBetweenSlowSamplesAreSeenAtTheRate) {
  // Grazes the post by less than a millimetre around the middle.
  const double graze = std::asin(0.0695 / 0.5);
  auto left = glide(Vector2d(1.0, 0), Vector2d(graze, 0), 2)
                  .then(glide(Vector2d(graze, 0), Vector2d(1.0, 0), 2));
  EXPECT_FALSE(run(left, right_).ok());
  EXPECT_TRUE(run(left, right_, {.rate = 0.3}).ok());
}

TEST_F(Verify, ArmsThatMeet) {
  // Right reaches over the post, left comes down on it.
  const VerifyReport report = run(glide(Vector2d(1.2, 0), Vector2d(0.25, 0), 3),
                                  glide(Vector2d(0, -0.4), Vector2d(0.45, -0.4), 3));
  ASSERT_EQ(report.failures.size(), 1u) << testing::PrintToString(report.failures);
  expect_among(report, "left/link2 and right/link2 touch from");
  expect_among(report, " s to 3 s (");
}

TEST_F(Verify, AnArmThatWaitsAtItsEndIsChecked) {
  // Right is done after 1.5 s and stands where left comes by after more than 2.
  const auto right = glide(Vector2d(0, -0.4), Vector2d(0.45, -0.4), 1.5);
  const auto left = glide(Vector2d(1.5, 0), Vector2d(1.5, -0.1), 2)
                        .then(glide(Vector2d(1.5, -0.1), Vector2d(0.25, 0), 3));
  const VerifyReport report = run(left, right);
  EXPECT_EQ(report.samples, 5001);
  ASSERT_EQ(report.failures.size(), 1u) << testing::PrintToString(report.failures);
  expect_among(report, "left/link2 and right/link2 touch from");
  expect_among(report, " s to 5 s (");
  EXPECT_GT(report.nearest_time, 2);
}

TEST_F(Verify, BrokenVelocityLimit) {
  // 2 * 0.7 / 0.69 = 2.03 rad/s; the other limits give way.
  auto spec = cell_->spec();
  for (auto& robot : spec.robots) {
    for (int j = 0; j < 2; ++j) {
      auto limits = robot.model.joints()[static_cast<std::size_t>(j)].limits;
      limits.acceleration = limits.jerk = 1e6;
      robot.model.set_limits(j, limits);
    }
  }
  cell_ = world::Workcell::make(spec).value();
  const VerifyReport report = run(glide(Vector2d(0.5, 0), Vector2d(1.2, 0), 0.69), right_);
  expect_only(report, "velocity of left/joint1 reaches 2.028986 rad/s at 0.345 s, its limit is 2");
  EXPECT_NEAR(report.worst_limit_ratio, 1.4 / 0.69 / 2, 1e-9);
}

TEST_F(Verify, BrokenAccelerationAndJerkLimits) {
  // Acceleration 8 * 0.7 / 0.96^2 = 6.076, jerk 25.3, velocity 1.46.
  expect_only(run(glide(Vector2d(0.5, 0), Vector2d(1.2, 0), 0.96), right_),
              "acceleration of left/joint1 reaches 6.076389 rad/s^2 at 0.24 s, its limit is 6");
  // Jerk 32 * 0.1 / 0.43^3 = 40.2, acceleration 4.33, velocity 0.47; the slide is in metres.
  expect_only(run(left_, glide(Vector2d(0.1, 0), Vector2d(0, 0), 0.43)),
              "jerk of right/joint1 reaches -40.24803 m/s^3 at 0 s, its limit is 40");
}

TEST_F(Verify, BrokenPositionLimits) {
  expect_only(run(glide(Vector2d(0.5, 2.0), Vector2d(0.7, 2.6), 2), right_),
              "position of left/joint2 reaches 2.6 rad at 2 s, its limit is 2.5");
  expect_only(run(left_, glide(Vector2d(-2.4, 0), Vector2d(-2.6, 0), 2)),
              "position of right/joint1 reaches -2.6 m at 2 s, its limit is -2.5");
  EXPECT_TRUE(run(left_, glide(Vector2d(-2.4, 0), Vector2d(-2.5 - 9e-7, 0), 2)).ok());
}

TEST_F(Verify, LimitsJustReachedPassAndJustMissedFail) {
  // Velocity peaks at 2 |b - a| / T; at T = 4 nothing else is near.
  auto spec = cell_->spec();
  auto limits = spec.robots[0].model.joints()[0].limits;
  limits.velocity = 0.35;
  spec.robots[0].model.set_limits(0, limits);
  cell_ = world::Workcell::make(spec).value();
  const auto at = [&](double factor) {
    return run(glide(Vector2d(0.5, 0), Vector2d(1.2, 0), 4 / factor), right_);
  };
  EXPECT_TRUE(at(1).ok());
  EXPECT_TRUE(at(1 + 0.9e-6).ok());
  EXPECT_FALSE(at(1 + 1.1e-6).ok());
}

TEST_F(Verify, JumpsOverKnots) {
  const VerifyReport q = run(changed(left_, 1, {1e-3, 0, 0, 0}), right_);
  ASSERT_EQ(q.failures.size(), 1u) << testing::PrintToString(q.failures);
  expect_among(q, "position of left/joint1 jumps by ");
  expect_among(q, "0.001 rad at ");
  expect_among(q, " s, at most 1e-06 is allowed");
  EXPECT_NEAR(q.largest_jumps[0], 1e-3, 1e-12);

  const VerifyReport qd = run(changed(left_, 1, {0, 1e-3, 0, 0}), right_);
  ASSERT_EQ(qd.failures.size(), 2u) << testing::PrintToString(qd.failures);
  expect_among(qd, "position of left/joint1 jumps by -0.0005 rad at 1 s");
  expect_among(qd, "velocity of left/joint1 jumps by ");
  EXPECT_NEAR(qd.largest_jumps[1], 1e-3, 1e-12);

  const VerifyReport qdd = run(changed(left_, 2, {0, 0, 1e-3, 0}), right_);
  ASSERT_EQ(qdd.failures.size(), 3u) << testing::PrintToString(qdd.failures);
  expect_among(qdd, "acceleration of left/joint1 jumps by ");
  EXPECT_NEAR(qdd.largest_jumps[2], 2e-3, 1e-12);

  // A change of 1e-7 over half a second moves nothing by 1e-6.
  EXPECT_TRUE(run(changed(left_, 1, {0, 0, 1e-7, 0}), right_).ok());
  EXPECT_FALSE(run(changed(left_, 1, {0, 0, 1e-7, 0}), right_, {.jump_tolerance = 1e-8}).ok());
}

TEST_F(Verify, WrongEnds) {
  const auto ends = [&](const Vector2d& start, const Vector2d& goal) {
    return verify(cell_, CellMotion({left_, right_}), stacked(start, kRightFrom),
                  stacked(goal, kRightTo))
        .value();
  };
  EXPECT_TRUE(ends(kLeftFrom, kLeftTo).ok());
  expect_only(ends(kLeftFrom + Vector2d(0, 0.25), kLeftTo),
              "left/joint2 starts at 0.1 rad at 0 s, it should at 0.35");
  expect_only(ends(kLeftFrom, kLeftTo - Vector2d(1, 0)),
              "left/joint1 ends at 1.2 rad at 2 s, it should at 0.2");
  EXPECT_TRUE(ends(kLeftFrom, kLeftTo + Vector2d(0, 9e-7)).ok());
}

TEST_F(Verify, EndsThatDoNotStandStill) {
  // A plain cubic from rest to rest: accelerations are 6 (b - a) / T^2 at its ends.
  Coefficients c = Coefficients::Zero(2, 4);
  c.row(0) << 0.5, 0, 3 * 0.1 / 4, -2 * 0.1 / 8;
  const VerifyReport cubic = run(PiecewiseCubic::make({0, 2}, {c}).value(), right_);
  ASSERT_EQ(cubic.failures.size(), 2u) << testing::PrintToString(cubic.failures);
  EXPECT_EQ(cubic.failures[0],
            "acceleration of left/joint1 is 0.15 rad/s^2 at the start (0 s), it should be 0");
  EXPECT_EQ(cubic.failures[1],
            "acceleration of left/joint1 is -0.15 rad/s^2 at the end (2 s), it should be 0");

  c.row(0) << 0.5, 0.1, 0, 0;
  const VerifyReport line = run(PiecewiseCubic::make({0, 2}, {c}).value(), right_);
  ASSERT_EQ(line.failures.size(), 2u) << testing::PrintToString(line.failures);
  EXPECT_EQ(line.failures[0],
            "velocity of left/joint1 is 0.1 rad/s at the start (0 s), it should be 0");
  // An arm that ends before the other must come to rest at its own end.
  EXPECT_FALSE(run(PiecewiseCubic::make({0, 1}, {c}).value(), right_).ok());
}

TEST_F(Verify, RatiosAndJumpsAgreeWithExactExtremesOfRandomMotions) {
  Rng rng(11);
  for (int round = 0; round < 20; ++round) {
    std::vector<PiecewiseCubic> arms;
    double exact = 0;
    Eigen::Vector3d jumps = Eigen::Vector3d::Zero();
    for (int arm = 0; arm < 2; ++arm) {
      std::vector<double> knots{0};
      std::vector<Coefficients> segments;
      for (int k = 0; k < 3; ++k) {
        knots.push_back(knots.back() + rng.uniform(0.02, 0.1));
        Coefficients c(2, 4);
        for (double& x : c.reshaped()) x = rng.uniform(-3, 3);
        segments.push_back(c);
      }
      arms.push_back(PiecewiseCubic::make(knots, segments).value());
      const trajectory::Extremes extremes = trajectory::extremes(arms.back());
      const double ratio =
          std::max({extremes.velocity.maxCoeff() / 2.0, extremes.acceleration.maxCoeff() / 6.0,
                    extremes.jerk.maxCoeff() / 40.0});
      exact = std::max(exact, ratio);
      jumps = jumps.cwiseMax(arms.back().largest_jumps());
    }
    const VerifyReport report = run(arms[0], arms[1]);
    EXPECT_LE(report.worst_limit_ratio, exact * (1 + 1e-12));
    EXPECT_GE(report.worst_limit_ratio, exact * (1 - 1e-4));
    EXPECT_LT((report.largest_jumps - jumps).norm(), 1e-12);
  }
}

/// The left arm along maps that bend, stop, go back and jump.
TEST_F(Verify, FollowsTimeMaps) {
  Rng rng(12);
  for (int round = 0; round < 20; ++round) {
    const motion::ArmMotion left =
        *motion::ArmMotion(left_).along(motion::random_map(rng, 3, left_.duration()));
    const VerifyReport report = run(left, right_);
    const trajectory::Extremes e = trajectory::extremes(CellMotion({left, right_}));
    const double exact = std::max(
        {e.velocity.maxCoeff() / 2.0, e.acceleration.maxCoeff() / 6.0, e.jerk.maxCoeff() / 40.0});
    // Between samples a steep map peaks higher.
    EXPECT_LE(report.worst_limit_ratio, exact * (1 + 1e-6));
    EXPECT_GE(report.worst_limit_ratio, exact * (1 - 5e-2));
    const Eigen::Vector3d jumps = left.largest_jumps().cwiseMax(right_.largest_jumps());
    EXPECT_LT((report.largest_jumps - jumps).norm(), 1e-6 * (1 + jumps.norm()));
  }
}

TEST_F(Verify, AcceptsASmoothTimeMapAndNamesAKink) {
  const auto along = [&](std::vector<double> knots, std::vector<motion::TimeMap::Segment> c) {
    const auto map = motion::TimeMap::make(std::move(knots), std::move(c)).value();
    return run(motion::ArmMotion(left_).along(map).value(), right_);
  };
  const VerifyReport slow = along({0, 4}, {{{0, 0.5}}});
  EXPECT_TRUE(slow.ok()) << slow.failures.front();
  const VerifyReport waits = along({0, 1, 5}, {{{0}}, {{0, 0.5}}});
  EXPECT_TRUE(waits.ok()) << waits.failures.front();
  const VerifyReport kink = along({0, 2, 4.5}, {{{0, 0.5}}, {{1, 0.4}}});
  expect_among(kink, "velocity of left/");
  expect_among(kink, "at 2 s");
}

TEST_F(Verify, MotionsThatDoNotFitTheCell) {
  const VectorXd q = VectorXd::Zero(4);
  const auto expect_invalid = [&](const Result<VerifyReport>& report, const std::string& part) {
    ASSERT_FALSE(report);
    EXPECT_EQ(report.error().code, ErrorCode::kInvalidInput);
    EXPECT_NE(report.error().message.find(part), std::string::npos) << report.error().message;
  };
  expect_invalid(verify(cell_, CellMotion({left_}), q, q), "has 1 arms, workcell planar has 2");
  expect_invalid(verify(cell_, CellMotion({left_, left_.joints(0, 1)}), q, q),
                 "motion of arm right has 1 joints, the arm has 2");
  const CellMotion both({left_, right_});
  expect_invalid(verify(cell_, both, VectorXd::Zero(3), q), "start has 3 and goal 4 values");
  expect_invalid(verify(cell_, both, q, q, {.rate = 0}), "is 0 Hz");
  expect_invalid(verify(cell_, both, q, q, {.rate = -1}), "is -1 Hz");
  expect_invalid(verify(cell_, both, q, q, {.rate = std::nan("")}), "rate");
}

TEST_F(Verify, StopsWhenTold) {
  const CellMotion both({left_, right_});
  const VectorXd start = stacked(kLeftFrom, kRightFrom), goal = stacked(kLeftTo, kRightTo);
  const auto begin = Clock::now();
  const auto late = verify(cell_, both, start, goal, {.rate = 1e7}, StopCondition::after(0.02));
  EXPECT_LT(std::chrono::duration<double>(Clock::now() - begin).count(), 0.5);
  ASSERT_FALSE(late);
  EXPECT_EQ(late.error().code, ErrorCode::kTimeout);
  std::stop_source source;
  source.request_stop();
  const auto told =
      verify(cell_, both, start, goal, {}, StopCondition::after(1e9, source.get_token()));
  ASSERT_FALSE(told);
  EXPECT_EQ(told.error().code, ErrorCode::kCancelled);
}

// The arm passes well above a stub; what hangs below its tip does not.
TEST(VerifyCarrying, TheSameMotionIsGoodWithoutThePartAndBadWithIt) {
  world::WorkcellSpec spec = planar_spec();
  spec.obstacles.push_back(
      {"part", {geometry::Shape::sphere(Eigen::Vector3d::Zero(), 0.03).value()}});
  spec.obstacles.push_back(
      {"stub", {geometry::Shape::sphere(Eigen::Vector3d(0.05, 0.65, 0.35), 0.05).value()}});
  const auto cell = world::Workcell::make(spec).value();
  Eigen::Isometry3d X_LO = Eigen::Isometry3d::Identity();
  X_LO.translation() = Eigen::Vector3d(0.25, 0, -0.15);
  const auto carrying = cell->in_scene({{{"part", {"left/link2", X_LO}}}, {}}).value();

  const Vector2d from(1.0, 0), to(2.2, 0);
  const CellMotion motion({glide(from, to, 3), glide(kRightFrom, kRightFrom, 3)});
  const auto check = [&](const auto& in) {
    return verify(in, motion, stacked(from, kRightFrom), stacked(to, kRightFrom)).value();
  };
  const VerifyReport empty = check(cell), loaded = check(carrying);
  EXPECT_TRUE(empty.ok()) << empty.failures.front();
  ASSERT_EQ(loaded.failures.size(), 1u);
  EXPECT_NE(loaded.failures[0].find("part and stub touch"), std::string::npos)
      << loaded.failures[0];
  // Where the part is nearest to the stub: their centres are 0.65 m and a little from the axis.
  EXPECT_LT(loaded.least_clearance, -0.07);
}

}  // namespace
}  // namespace tandem::verification
