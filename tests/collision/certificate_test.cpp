#include "tandem/collision/certificate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "collision/random_cell.h"
#include "collision/random_motion.h"
#include "tandem/core/contract.h"

namespace tandem::collision {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;
using motion::PiecewiseCubic;
using motion::StraightEdge;
using world::PairScope;
using world::PairSelection;

struct Tally {
  long samples = 0;
  int free = 0, collision = 0, undecided = 0;
  double tightest = 0;  ///< Largest certified part of the sampled least clearance.
};

/// Certifies and compares with `count` samples, random ones and both ends.
void check_motion(const SsvChecker& checker, const motion::Motion& motion,
                  const PairSelection& selection, CollisionChecker::Scratch& scratch, Rng& rng,
                  int count, const CertificateOptions& options, Tally& tally) {
  const Certificate certificate = certify(checker, motion, selection, scratch, options);
  VectorXd q(motion.dof());
  if (certificate.verdict == Verdict::kCollision) {
    ++tally.collision;
    motion.position(certificate.time, q);
    const PairClearance hit = checker.least_clearance(q, {certificate.pair}, scratch);
    EXPECT_LE(hit.distance, 1e-9);
    EXPECT_NEAR(certificate.depth, -hit.distance, 1e-9);
    return;
  }
  if (certificate.verdict == Verdict::kUndecided) {
    ++tally.undecided;
    motion.position(certificate.time, q);
    EXPECT_LT(checker.least_clearance(q, {certificate.pair}, scratch).distance, 1e-3);
    return;
  }
  ++tally.free;
  EXPECT_GT(certificate.least_clearance, 0);
  double sampled = std::numeric_limits<double>::infinity();
  for (int i = 0; i < count; ++i) {
    const double t = i < 2 ? i * motion.duration() : rng.uniform(0, motion.duration());
    motion.position(t, q);
    sampled = std::min(sampled, checker.least_clearance(q, selection, scratch).distance);
  }
  tally.samples += count;
  EXPECT_GE(sampled, certificate.least_clearance) << "certified, yet sampled lower";
  if (options.clearance_ratio > 0) {
    EXPECT_GE(certificate.least_clearance, options.clearance_ratio * sampled * 0.98);
  }
  tally.tightest = std::max(tally.tightest, certificate.least_clearance / sampled);
}

TEST(Certificate, NoSampleContradictsIt) {
  Tally tally;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    test::RandomCellOptions options;
    options.joints = 2 + static_cast<int>(seed % 5);
    if (seed % 4 == 3) options.surface_pieces = 40 * static_cast<int>(seed);
    const SsvChecker checker(test::random_cell(seed, options));
    const world::Workcell& cell = checker.cell();
    const auto scratch = checker.make_scratch();
    Rng rng(seed);
    for (int i = 0; i < 150; ++i) {
      const PairScope scope = i % 3 == 0   ? PairScope::all()
                              : i % 3 == 1 ? PairScope::arm(0, world::ArmMask{2})
                                           : PairScope::between(0, 1);
      const PairSelection selection = cell.select(scope);
      VectorXd q = test::random_configuration(rng, cell);
      for (int k = 0; k < 40 && !checker.is_free(q, selection, *scratch); ++k) {
        q = test::random_configuration(rng, cell);
      }
      const double size = std::pow(10.0, rng.uniform(-1.5, 0.5));
      CertificateOptions certify_options;
      certify_options.clearance_ratio = i % 5 == 0 ? 0.8 : 0.0;
      if (i % 2 == 0) {
        VectorXd to = q;
        for (double& x : to) x += rng.uniform(-size, size);
        check_motion(checker, StraightEdge(q, to), selection, *scratch, rng, 800, certify_options,
                     tally);
      } else {
        check_motion(checker, test::random_cubic(rng, q, size), selection, *scratch, rng, 800,
                     certify_options, tally);
      }
    }
  }
  EXPECT_GE(tally.samples, 1000000);
  EXPECT_GT(tally.collision, 100);
  EXPECT_LE(tally.undecided, 3);
  EXPECT_GT(tally.tightest, 0.9);
  std::printf("%ld samples, %d free, %d in collision, %d undecided\n", tally.samples, tally.free,
              tally.collision, tally.undecided);
}

/// A ball of 0.1 m on a rail, 0.3 m + padding from the one it would touch at x = 1.
struct Slider {
  explicit Slider(std::vector<geometry::Shape> obstacle = {}) {
    world::WorkcellSpec spec = test::slider_cell_spec();
    if (!obstacle.empty()) spec.obstacles[0].shapes_W = std::move(obstacle);
    checker.emplace(test::make_cell(std::move(spec)));
    scratch = checker->make_scratch();
    selection = checker->cell().select(PairScope::all());
  }
  Certificate certify_edge(double from, double to, const CertificateOptions& options = {},
                           const StopCondition& stop = {}) {
    const StraightEdge edge(VectorXd::Constant(1, from), VectorXd::Constant(1, to));
    return certify(*checker, edge, selection, *scratch, options, stop);
  }
  std::optional<SsvChecker> checker;
  std::unique_ptr<CollisionChecker::Scratch> scratch;
  PairSelection selection;
};

TEST(Certificate, FarMotionsTakeOneEvaluation) {
  Slider slider;
  const Certificate certificate = slider.certify_edge(-0.5, 0.0);
  EXPECT_TRUE(certificate.is_free());
  EXPECT_EQ(certificate.evaluations, 1);
  EXPECT_EQ(certificate.pair, 0);
  EXPECT_NEAR(certificate.least_clearance, 0.7, 1e-6);  // Reached at the end of the edge.
}

TEST(Certificate, StandingStillTakesOneEvaluation) {
  Slider slider;
  const Certificate free = slider.certify_edge(0.6999, 0.6999);
  EXPECT_TRUE(free.is_free());
  EXPECT_EQ(free.evaluations, 1);
  EXPECT_NEAR(free.least_clearance, 1e-4, 1e-8);
  const Certificate hit = slider.certify_edge(0.71, 0.71);
  EXPECT_EQ(hit.verdict, Verdict::kCollision);
  EXPECT_NEAR(hit.depth, 0.01, 1e-12);
}

TEST(Certificate, NothingSelectedIsFree) {
  Slider slider;
  slider.selection.clear();
  const Certificate certificate = slider.certify_edge(0, 2);
  EXPECT_TRUE(certificate.is_free());
  EXPECT_EQ(certificate.least_clearance, std::numeric_limits<double>::infinity());
  EXPECT_EQ(certificate.pair, -1);
}

TEST(Certificate, FindsCollisionsThatOnlyTheEndsTouch) {
  Slider slider;
  for (const auto& [from, to] : {std::pair{0.2, 0.7001}, std::pair{0.7001, 0.2}}) {
    const Certificate certificate = slider.certify_edge(from, to);
    EXPECT_EQ(certificate.verdict, Verdict::kCollision);
    EXPECT_NEAR(certificate.time, from < to ? 1 : 0, 0);
    EXPECT_NEAR(certificate.depth, 1e-4, 1e-12);
    EXPECT_LE(certificate.evaluations, 3);
  }
}

TEST(Certificate, TouchingIsNeverFree) {
  Slider slider;
  for (const double gap : {0.0, 1e-12, 1e-10}) {
    EXPECT_FALSE(slider.certify_edge(0.3, 0.7 - gap).is_free()) << gap;
  }
  EXPECT_TRUE(slider.certify_edge(0.3, 0.7 - 1e-4).is_free());
}

// A ball on an arm of 1 m swings past a wall and all but touches it.
TEST(Certificate, IsUndecidedBelowTheSmallestDeviation) {
  constexpr double kGap = 1e-8;
  world::WorkcellSpec spec = test::slider_cell_spec();
  std::vector<robot::Joint> joints = spec.robots[0].model.joints();
  joints[0].type = robot::JointType::kRevolute;
  joints[0].axis_J = Vector3d::UnitZ();
  spec.robots[0].model = *robot::Model::make("swing", spec.robots[0].model.links(), joints);
  spec.robots[0].volumes["carriage"] = {*geometry::Shape::sphere(Vector3d::UnitX(), 0.1)};
  Eigen::Isometry3d X_WO = Eigen::Isometry3d::Identity();
  X_WO.translation().x() = 1.1 + kGap + 0.5;
  spec.obstacles[0].shapes_W = {*geometry::Shape::box(X_WO, {1, 1, 1})};
  const SsvChecker checker(test::make_cell(spec));
  const auto scratch = checker.make_scratch();
  const PairSelection all = checker.cell().select(PairScope::all());
  const StraightEdge edge(VectorXd::Constant(1, -0.3), VectorXd::Constant(1, 0.7));
  CertificateOptions coarse;
  coarse.smallest_deviation = 1e-3;
  const Certificate certificate = certify(checker, edge, all, *scratch, coarse);
  EXPECT_EQ(certificate.verdict, Verdict::kUndecided);
  EXPECT_FALSE(certificate.is_free());
  EXPECT_FALSE(certificate.stopped);
  EXPECT_EQ(certificate.pair, 0);
  EXPECT_NEAR(certificate.time, 0.3, 1e-2);
  const Certificate fine = certify(checker, edge, all, *scratch);
  EXPECT_TRUE(fine.is_free());
  EXPECT_LE(fine.least_clearance, kGap);
}

// A sweep past a plate of 0.1 mm: no sampling of edges would see it.
TEST(Certificate, CatchesWallsThinnerThanAnySample) {
  Rng rng(11);
  Eigen::Isometry3d X_WO = Eigen::Isometry3d::Identity();
  int caught = 0;
  for (int i = 0; i < 200; ++i) {
    X_WO.translation().x() = rng.uniform(0.5, 1.5);
    world::WorkcellSpec spec = test::slider_cell_spec();
    spec.robots[0].volumes["carriage"] = {*geometry::Shape::sphere(Vector3d::Zero(), 1e-5)};
    spec.obstacles[0].shapes_W = {*geometry::Shape::box(X_WO, {1e-4, 0.5, 0.5})};
    const SsvChecker checker(test::make_cell(spec));
    const auto scratch = checker.make_scratch();
    const StraightEdge edge(VectorXd::Constant(1, rng.uniform(-1, 0)),
                            VectorXd::Constant(1, rng.uniform(2, 3)));
    const Certificate certificate =
        certify(checker, edge, checker.cell().select(PairScope::all()), *scratch);
    caught += certificate.verdict == Verdict::kCollision;
    EXPECT_NEAR(edge.at(certificate.time).q[0], X_WO.translation().x(), 6.1e-5);
  }
  EXPECT_EQ(caught, 200);
}

TEST(Certificate, CatchesThinWallsOnTurningArms) {
  Rng rng(12);
  test::RandomCellOptions options;
  options.arms = 1;
  options.obstacles = 0;
  int crossed = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    world::WorkcellSpec spec = test::random_cell_spec(seed, options);
    Eigen::Isometry3d X_WO = test::random_pose(rng, 0.4);
    X_WO.translation().x() += 0.5;
    spec.obstacles.push_back({"wall", {*geometry::Shape::box(X_WO, {1e-4, 1, 1})}, {}});
    const SsvChecker checker(test::make_cell(spec));
    const world::Workcell& cell = checker.cell();
    const auto scratch = checker.make_scratch();
    PairSelection selection;
    const int wall = cell.find_body("wall");
    for (const int pair : cell.select(PairScope::all())) {
      if (cell.pairs()[static_cast<std::size_t>(pair)].b == wall ||
          cell.pairs()[static_cast<std::size_t>(pair)].a == wall) {
        selection.push_back(pair);
      }
    }
    // Where the hand is on the other side of the wall, it must have gone through.
    const int hand = cell.arms()[0].tip_link;
    const auto side = [&](const VectorXd& q) {
      VectorXd positions;
      robot::LinkPoses X_WL;
      cell.forward_kinematics(q, positions, X_WL);
      return (X_WO.inverse() * X_WL[static_cast<std::size_t>(hand)].translation()).x();
    };
    for (int i = 0; i < 20; ++i) {
      const VectorXd a = test::random_configuration(rng, cell);
      const VectorXd b = test::random_configuration(rng, cell);
      const Certificate certificate = certify(checker, StraightEdge(a, b), selection, *scratch);
      if (!certificate.is_free()) continue;
      // Free: then dense samples of the hand change sides only beyond the edge of the wall.
      double last = side(a);
      for (int k = 1; k <= 200; ++k) {
        const VectorXd q = a + (b - a) * (k / 200.0);
        const double now = side(q);
        if (now * last < 0) {
          VectorXd positions;
          robot::LinkPoses X_WL;
          cell.forward_kinematics(q, positions, X_WL);
          const Vector3d p = X_WO.inverse() * X_WL[static_cast<std::size_t>(hand)].translation();
          EXPECT_GT(p.tail<2>().cwiseAbs().maxCoeff(), 0.4);
          ++crossed;
        }
        last = now;
      }
    }
  }
  EXPECT_GT(crossed, 10);
}

TEST(Certificate, KnowsWhatIsInsideAMesh) {
  world::WorkcellSpec spec = test::slider_cell_spec();
  Eigen::Isometry3d X_WO = Eigen::Isometry3d::Identity();
  X_WO.translation().x() = 1;
  spec.obstacles[0].shapes_W.clear();
  spec.obstacles[0].surfaces_W = {{test::box_mesh(Vector3d::Constant(2)), X_WO}};
  const auto certify_edge = [](const world::WorkcellSpec& cell_spec, double from, double to) {
    const SsvChecker checker(test::make_cell(cell_spec));
    const StraightEdge edge(VectorXd::Constant(1, from), VectorXd::Constant(1, to));
    return certify(checker, edge, {0}, *checker.make_scratch());
  };
  const Certificate inside = certify_edge(spec, 0.9, 1.2);  // Nowhere near a triangle.
  EXPECT_EQ(inside.verdict, Verdict::kCollision);
  EXPECT_NEAR(inside.depth, 0.95 + 0.1, 1e-9);
  EXPECT_EQ(certify_edge(spec, -0.5, 2.9).verdict, Verdict::kCollision);
  EXPECT_EQ(certify_edge(spec, -0.5, 0.5).verdict, Verdict::kCollision);
  EXPECT_TRUE(certify_edge(spec, -0.9, -0.2).is_free());
  // Without one of its triangles it has no inside.
  auto triangles = spec.obstacles[0].surfaces_W[0].surface->triangles();
  triangles.pop_back();
  spec.obstacles[0].surfaces_W[0].surface =
      test::make_mesh(spec.obstacles[0].surfaces_W[0].surface->vertices(), triangles);
  const Certificate hollow = certify_edge(spec, 0.9, 1.2);
  EXPECT_TRUE(hollow.is_free());
  EXPECT_NEAR(hollow.least_clearance, 0.7, 1e-6);
  EXPECT_EQ(certify_edge(spec, -0.5, 2.9).verdict, Verdict::kCollision);
}

TEST(Certificate, ClearanceRatioRefines) {
  Slider slider;
  CertificateOptions refined;
  refined.clearance_ratio = 0.99;
  // Past a ball whose nearest approach is in the middle of the edge, sideways.
  Slider sideways({*geometry::Shape::sphere(Vector3d(1, 0.35, 0), 0.2)});
  const Certificate loose = sideways.certify_edge(0.1, 1.93);
  const Certificate tight = sideways.certify_edge(0.1, 1.93, refined);
  ASSERT_TRUE(loose.is_free());
  ASSERT_TRUE(tight.is_free());
  EXPECT_LE(loose.least_clearance, 0.05);
  EXPECT_LE(tight.least_clearance, 0.05);
  EXPECT_GE(tight.least_clearance, 0.99 * 0.05 * 0.999);
  EXPECT_GE(tight.least_clearance, loose.least_clearance);
  EXPECT_NEAR(0.1 + 1.83 * tight.time, 1.0, 0.1);
  refined.clearance_ratio = 1.0;  // As near as the smallest deviation allows.
  EXPECT_NEAR(sideways.certify_edge(0.1, 1.93, refined).least_clearance, 0.05, 1e-4);
}

TEST(Certificate, IntervalsAreJudgedAlone) {
  Slider slider;
  const StraightEdge edge(VectorXd::Zero(1), VectorXd::Constant(1, 2.0));
  const auto certify_part = [&](double t0, double t1) {
    return certify_interval(*slider.checker, edge, t0, t1, slider.selection, *slider.scratch);
  };
  EXPECT_TRUE(certify_part(0, 0.349).is_free());
  EXPECT_TRUE(certify_part(0.651, 1).is_free());
  const Certificate hit = certify_part(0, 0.36);
  EXPECT_EQ(hit.verdict, Verdict::kCollision);
  EXPECT_GE(hit.time, 0.35);
  EXPECT_LE(hit.time, 0.36);
}

TEST(Certificate, StopsOnRequest) {
  Slider slider;
  std::stop_source source;
  source.request_stop();
  const Certificate stopped =
      slider.certify_edge(-1, 0, {}, StopCondition::after(1e9, source.get_token()));
  EXPECT_TRUE(stopped.stopped);
  EXPECT_EQ(stopped.verdict, Verdict::kUndecided);
  EXPECT_EQ(stopped.evaluations, 0);
  EXPECT_TRUE(slider.certify_edge(-1, 0, {}, StopCondition::after(0)).stopped);
  EXPECT_FALSE(slider.certify_edge(-1, 0).stopped);
}

TEST(Certificate, JumpsAreNotFree) {
  // From before the ball to behind it at t = 1, with nothing between.
  PiecewiseCubic::Coefficients before(1, 4), after(1, 4);
  before << 0.2, 0, 0, 0;
  after << 1.8, 0, 0, 0;
  const auto motion = *PiecewiseCubic::make({0, 1, 2.5}, {before, after});
  Slider slider;
  const Certificate certificate =
      certify(*slider.checker, motion, slider.selection, *slider.scratch);
  EXPECT_FALSE(certificate.is_free());
  EXPECT_NEAR(certificate.time, 1, 1e-6);
}

TEST(Certificate, MotionsOutsideTheLimitsAreProvenToo) {
  // Lever arms end at the limits, certificates do not.
  Rng rng(9);
  Tally tally;
  for (std::uint64_t seed : {5, 6, 7, 8}) {
    const SsvChecker checker(test::random_cell(seed));
    const auto scratch = checker.make_scratch();
    const PairSelection all = checker.cell().select(PairScope::all());
    for (int i = 0; i < 50; ++i) {
      const VectorXd a = test::random_configuration(rng, checker.cell(), 3.0);
      VectorXd b = a;
      for (double& x : b) x += rng.uniform(-0.3, 0.3);
      check_motion(checker, StraightEdge(a, b), all, *scratch, rng, 500, {}, tally);
    }
  }
  EXPECT_GT(tally.free, 5);
}

TEST(Certificate, TheScratchLeavesNoTrace) {
  const SsvChecker checker(test::random_cell(7));
  const auto used = checker.make_scratch();
  const PairSelection all = checker.cell().select(PairScope::all());
  Rng rng(2);
  for (int i = 0; i < 50; ++i) {
    const StraightEdge edge(test::random_configuration(rng, checker.cell(), 0.5),
                            test::random_configuration(rng, checker.cell(), 0.5));
    const auto fresh = checker.make_scratch();
    const Certificate a = certify(checker, edge, all, *used);
    const Certificate b = certify(checker, edge, all, *fresh);
    EXPECT_EQ(a.verdict, b.verdict);
    EXPECT_EQ(a.time, b.time);
    EXPECT_EQ(a.pair, b.pair);
    EXPECT_EQ(a.least_clearance, b.least_clearance);
    EXPECT_EQ(a.evaluations, b.evaluations);
  }
}

TEST(Certificate, RefusesWrongUse) {
  Slider slider;
  const StraightEdge wrong(VectorXd::Zero(2), VectorXd::Ones(2));
  EXPECT_THROW(certify(*slider.checker, wrong, slider.selection, *slider.scratch),
               ContractViolation);
  const StraightEdge edge(VectorXd::Zero(1), VectorXd::Ones(1));
  EXPECT_THROW(certify_interval(*slider.checker, edge, 0.5, 0.4, slider.selection, *slider.scratch),
               ContractViolation);
  EXPECT_THROW(certify(*slider.checker, edge, {1}, *slider.scratch), ContractViolation);
  const Slider other;
  EXPECT_THROW(certify(*slider.checker, edge, slider.selection, *other.scratch), ContractViolation);
  CertificateOptions options;
  options.clearance_ratio = 1.5;
  EXPECT_THROW(certify(*slider.checker, edge, slider.selection, *slider.scratch, options),
               ContractViolation);
  options = {};
  options.smallest_deviation = 0;
  EXPECT_THROW(certify(*slider.checker, edge, slider.selection, *slider.scratch, options),
               ContractViolation);
}

}  // namespace
}  // namespace tandem::collision
