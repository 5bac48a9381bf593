#include "tandem/collision/certificate.h"

#include <gtest/gtest.h>

#include <cmath>

#include "collision/random_cell.h"
#include "tandem/motion/piecewise_cubic.h"

namespace tandem::collision {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;
using motion::PiecewiseCubic;
using motion::StraightEdge;
using world::PairScope;
using world::PairSelection;

/// Random cubic segments, continuous in position and velocity, that wander from q by about `size`.
PiecewiseCubic random_cubic(Rng& rng, const VectorXd& q, double size) {
  const int count = 1 + static_cast<int>(rng.index(4));
  std::vector<double> knots{0};
  std::vector<PiecewiseCubic::Coefficients> segments;
  VectorXd c0 = q, c1 = VectorXd::Zero(q.size());
  const auto random_vector = [&] {
    VectorXd v(q.size());
    for (double& x : v) x = rng.uniform(-size, size);
    return v;
  };
  c1 = random_vector();
  for (int k = 0; k < count; ++k) {
    const double h = rng.uniform(0.1, 0.6);
    PiecewiseCubic::Coefficients c(q.size(), 4);
    c << c0, c1, 2 * random_vector(), 3 * random_vector();
    segments.push_back(c);
    knots.push_back(knots.back() + h);
    c0 = c.col(0) + h * (c.col(1) + h * (c.col(2) + h * c.col(3)));
    c1 = c.col(1) + h * (2 * c.col(2) + 3 * h * c.col(3));
  }
  return *PiecewiseCubic::make(knots, segments);
}

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
    // Branch and bound makes this about as cheap as the yes or no.
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
        check_motion(checker, random_cubic(rng, q, size), selection, *scratch, rng, 800,
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

}  // namespace
}  // namespace tandem::collision
