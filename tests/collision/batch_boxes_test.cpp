#include "tandem/collision/batch_boxes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "collision/batch_targets.h"
#include "collision/random_motion.h"
#include "tandem/collision/batch_certificate.h"
#include "tandem/core/contract.h"

namespace tandem::collision {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using motion::PiecewiseCubic;
using test::for_each_target;
using test::kinds_of_cells;
using world::PairScope;
using world::PairSelection;

constexpr double kCap = BatchChecker::kClearanceCap;

/// Everything that a question about one cell takes.
struct Asked {
  Asked(std::uint64_t seed, const test::RandomCellOptions& options)
      : exact(test::random_cell(seed, options)) {}

  double least(const VectorXd& q) {
    return std::min(kCap, exact.least_clearance(q, all, *exact_scratch).distance);
  }
  VectorXd inside(const VectorXd& q) const {
    return q.cwiseMax(exact.cell().lower()).cwiseMin(exact.cell().upper());
  }

  SsvChecker exact;
  BatchChecker batch{exact};
  PairSelection all = exact.cell().select(PairScope::all());
  BatchChecker::Pairs pairs = batch.compile(all);
  BatchChecker::ScratchPtr scratch = batch.make_scratch();
  std::unique_ptr<CollisionChecker::Scratch> exact_scratch = exact.make_scratch();
};

struct Boxes {
  MatrixXd Q, D;
};

/// Boxes of all sizes around random centres; some joints do not deviate.
Boxes random_boxes(Rng& rng, const world::Workcell& cell, int count) {
  Boxes boxes{MatrixXd(cell.dof(), count), MatrixXd(cell.dof(), count)};
  for (int i = 0; i < count; ++i) {
    boxes.Q.col(i) = test::random_configuration(rng, cell);
    const double size = std::pow(10.0, rng.uniform(-4, 0));
    for (double& d : boxes.D.col(i)) d = rng.index(4) == 0 ? 0.0 : size * rng.uniform(0, 1);
  }
  return boxes;
}

struct Tally {
  int free = 0, touching = 0, open = 0, overlooked = 0;
};

/// Compares with the exact checker at the centre, at corners and inside.
void check_box(Asked& asked, Rng& rng, const VectorXd& q, const VectorXd& D, const BoxProof& proof,
               Tally& tally) {
  const double at_center = asked.least(q);
  switch (proof.verdict) {
    case BoxProof::Verdict::kTouching:
      ++tally.touching;
      EXPECT_LE(at_center, 0);
      return;
    case BoxProof::Verdict::kOpen:
      ++tally.open;
      tally.overlooked += at_center < -2 * asked.batch.margin();
      EXPECT_GE(proof.excess, 0);
      return;
    case BoxProof::Verdict::kFree:
      break;
  }
  ++tally.free;
  EXPECT_GT(proof.least_clearance, 0);
  EXPECT_LE(proof.least_clearance, at_center);
  for (int k = 0; k < 40; ++k) {
    VectorXd p = q;
    for (Eigen::Index j = 0; j < p.size(); ++j) {
      const double corner = rng.index(2) == 0 ? -1.0 : 1.0;
      p[j] += D[j] * (k % 2 == 0 ? corner : rng.uniform(-1, 1));
    }
    ASSERT_LE(proof.least_clearance, asked.least(asked.inside(p)));
  }
}

TEST(BatchBoxes, FreeOnesAreFreeAtEverySampleAndTouchingOnesTouch) {
  for_each_target([] {
    std::uint64_t seed = 300;
    Tally tally;
    for (const test::RandomCellOptions& options : kinds_of_cells()) {
      Asked asked(++seed, options);
      Rng rng(seed);
      const Boxes boxes = random_boxes(rng, asked.exact.cell(), 203);
      std::vector<BoxProof> proofs, verdicts;
      prove_boxes(asked.batch, boxes.Q, boxes.D, *asked.pairs, true, *asked.scratch, proofs);
      prove_boxes(asked.batch, boxes.Q, boxes.D, *asked.pairs, false, *asked.scratch, verdicts);
      ASSERT_EQ(proofs.size(), 203U);
      ASSERT_EQ(verdicts.size(), 203U);
      for (int i = 0; i < boxes.Q.cols(); ++i) {
        const auto k = static_cast<std::size_t>(i);
        EXPECT_EQ(proofs[k].verdict, verdicts[k].verdict);
        check_box(asked, rng, boxes.Q.col(i), boxes.D.col(i), proofs[k], tally);
      }
    }
    EXPECT_GT(tally.free, 150);
    EXPECT_GT(tally.touching, 100);
    EXPECT_GT(tally.open, 150);
  });
}

/// Shapes with kernels: centres that touch are found to, and points are proven.
TEST(BatchBoxes, WithKernelsNothingIsOverlooked) {
  Tally tally;
  int unproven = 0, apart = 0;
  std::uint64_t seed = 400;
  for (const auto core : {geometry::CoreType::kPoint, geometry::CoreType::kSegment}) {
    for (int k = 0; k < 4; ++k) {
      Asked asked(++seed, {.obstacles = 0, .cores = {core}});
      Rng rng(seed);
      Boxes boxes = random_boxes(rng, asked.exact.cell(), 150);
      std::vector<BoxProof> proofs;
      prove_boxes(asked.batch, boxes.Q, boxes.D, *asked.pairs, true, *asked.scratch, proofs);
      for (int i = 0; i < boxes.Q.cols(); ++i) {
        check_box(asked, rng, boxes.Q.col(i), boxes.D.col(i), proofs[static_cast<std::size_t>(i)],
                  tally);
      }
      boxes.D.setZero();
      prove_boxes(asked.batch, boxes.Q, boxes.D, *asked.pairs, true, *asked.scratch, proofs);
      for (int i = 0; i < boxes.Q.cols(); ++i) {
        if (asked.least(boxes.Q.col(i)) <= 1e-3) continue;
        ++apart;
        unproven += proofs[static_cast<std::size_t>(i)].verdict != BoxProof::Verdict::kFree;
      }
    }
  }
  EXPECT_GT(tally.touching, 50);
  EXPECT_EQ(tally.overlooked, 0);
  EXPECT_GT(apart, 200);
  EXPECT_EQ(unproven, 0);
}

TEST(BatchBoxes, RefusesWhatItCannotMean) {
  Asked asked(1, {}), other(2, {});
  const VectorXd q = asked.inside(VectorXd::Zero(asked.exact.cell().dof()));
  const VectorXd D = VectorXd::Constant(q.size(), 0.1);
  std::vector<BoxProof> out(3);
  const auto ask = [&](const MatrixXd& Q, const MatrixXd& half) {
    prove_boxes(asked.batch, Q, half, *asked.pairs, true, *asked.scratch, out);
  };
  EXPECT_THROW(ask(q, -D), ContractViolation);
  EXPECT_THROW(ask(q, VectorXd(D.head(1))), ContractViolation);
  EXPECT_THROW(ask(q, MatrixXd::Zero(q.size(), 2)), ContractViolation);
  EXPECT_THROW(ask(q * std::nan(""), D), ContractViolation);
  EXPECT_THROW(prove_boxes(asked.batch, q, D, *other.pairs, true, *asked.scratch, out),
               ContractViolation);
  ask(MatrixXd(q.size(), 0), MatrixXd(q.size(), 0));
  EXPECT_TRUE(out.empty());
}

/// A random motion that stays inside the joint limits.
PiecewiseCubic motion_inside(Rng& rng, Asked& asked, double size) {
  const world::Workcell& cell = asked.exact.cell();
  for (;; size *= 0.8) {
    VectorXd q = test::random_configuration(rng, cell);
    for (int k = 0; k < 40 && !asked.exact.is_free(q, asked.all, *asked.exact_scratch); ++k) {
      q = test::random_configuration(rng, cell);
    }
    PiecewiseCubic curve = test::random_cubic(rng, q, size);
    VectorXd D(cell.dof());
    curve.position(0.5 * curve.duration(), q);
    curve.deviation(0, curve.duration(), D);
    if ((q - D - cell.lower()).minCoeff() >= 0 && (cell.upper() - q - D).minCoeff() >= 0) {
      return curve;
    }
  }
}

struct PartTally {
  int free = 0, collision = 0, undecided = 0, differing = 0;
};

/// Compares the certificate of [t0, t1] with the exact one and with samples.
void check_part(Asked& asked, const PiecewiseCubic& curve, double t0, double t1,
                const CertificateOptions& options, const Certificate& part, PartTally& tally) {
  const Certificate exact =
      certify_interval(asked.exact, curve, t0, t1, asked.all, *asked.exact_scratch, options);
  tally.differing += part.verdict != exact.verdict;
  VectorXd q(curve.dof());
  if (part.verdict == Verdict::kUndecided) {
    ++tally.undecided;
    return;
  }
  if (part.verdict == Verdict::kCollision) {
    ++tally.collision;
    EXPECT_TRUE(t0 <= part.time && part.time <= t1);
    curve.position(part.time, q);
    const double hit = asked.exact.least_clearance(q, {part.pair}, *asked.exact_scratch).distance;
    EXPECT_LE(hit, 1e-9);
    EXPECT_NEAR(part.depth, -hit, 1e-9);
    return;
  }
  ++tally.free;
  EXPECT_GT(part.least_clearance, 0);
  double sampled = kCap;
  for (int k = 0; k <= 200; ++k) {
    curve.position(t0 + k / 200.0 * (t1 - t0), q);
    sampled = std::min(sampled, asked.least(q));
  }
  ASSERT_LE(part.least_clearance, sampled);
}

TEST(CertifyParts, AgreesWithTheExactCertificateAndWithSamples) {
  std::uint64_t seed = 500;
  PartTally tally;
  for (const test::RandomCellOptions& options : kinds_of_cells()) {
    Asked asked(++seed, options);
    Rng rng(seed);
    for (int i = 0; i < 40; ++i) {
      const PiecewiseCubic curve =
          motion_inside(rng, asked, std::pow(10.0, rng.uniform(-1.5, 0.3)));
      const double end = curve.duration();
      const std::vector<double> times{0, 0.3 * end, 0.35 * end, end};
      const CertificateOptions certify_options{.clearance_ratio = i % 2 == 0 ? 0.5 : 0.0};
      const auto parts =
          certify_parts(asked.batch, *asked.pairs, curve, times, *asked.scratch, certify_options);
      ASSERT_EQ(parts.size(), 3U);
      for (std::size_t k = 0; k < 3; ++k) {
        check_part(asked, curve, times[k], times[k + 1], certify_options, parts[k], tally);
      }
    }
  }
  EXPECT_GT(tally.free, 150);
  EXPECT_GT(tally.collision, 100);
  EXPECT_LE(tally.differing, 3);
  EXPECT_LE(tally.undecided, 3);
}

TEST(CertifyParts, ProvesThePartOfTheClearanceThatIsAskedFor) {
  int compared = 0;
  for (std::uint64_t seed = 600; seed < 606; ++seed) {
    test::RandomCellOptions options;
    options.cores = {seed % 2 == 0 ? geometry::CoreType::kPoint : geometry::CoreType::kSegment};
    Asked asked(seed, options);
    Rng rng(seed);
    for (int i = 0; i < 40; ++i) {
      const PiecewiseCubic curve = motion_inside(rng, asked, 0.1);
      const std::vector<double> times{0, curve.duration()};
      const auto parts = certify_parts(asked.batch, *asked.pairs, curve, times, *asked.scratch,
                                       {.clearance_ratio = 0.5});
      if (!parts[0].is_free()) continue;
      VectorXd q(curve.dof());
      double sampled = kCap;
      for (int k = 0; k <= 400; ++k) {
        curve.position(k / 400.0 * curve.duration(), q);
        sampled = std::min(sampled, asked.least(q));
      }
      if (sampled < 20 * asked.batch.margin()) continue;
      ++compared;
      EXPECT_GE(parts[0].least_clearance, 0.5 * sampled - 2 * asked.batch.margin());
    }
  }
  EXPECT_GT(compared, 60);
}

TEST(CertifyParts, StopsWhenToldTo) {
  Asked asked(7, {});
  Rng rng(7);
  const PiecewiseCubic curve = motion_inside(rng, asked, 0.2);
  std::stop_source source;
  source.request_stop();
  const std::vector<double> times{0, 0.5 * curve.duration(), curve.duration()};
  const auto parts = certify_parts(asked.batch, *asked.pairs, curve, times, *asked.scratch, {},
                                   StopCondition::after(100, source.get_token()));
  ASSERT_EQ(parts.size(), 2U);
  for (const Certificate& part : parts) {
    EXPECT_TRUE(part.stopped);
    EXPECT_EQ(part.verdict, Verdict::kUndecided);
  }
}

}  // namespace
}  // namespace tandem::collision
