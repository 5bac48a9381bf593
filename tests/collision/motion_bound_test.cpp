#include <gtest/gtest.h>

#include "collision/random_cell.h"
#include "tandem/collision/ssv_scratch.h"

namespace tandem::collision {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

/// Deviations of few joints at a time, so that slack in one term cannot hide another that lacks.
VectorXd random_deviation(Rng& rng, Eigen::Index dof) {
  VectorXd D = VectorXd::Zero(dof);
  const double size = std::pow(10.0, rng.uniform(-3, 0.7));
  const std::size_t count = 1 + rng.index(3);
  for (std::size_t i = 0; i < count; ++i) {
    D[static_cast<Eigen::Index>(rng.index(static_cast<std::size_t>(dof)))] = rng.uniform(0, size);
  }
  return D;
}

class MotionBounds : public testing::TestWithParam<std::uint64_t> {
 protected:
  MotionBounds()
      : cell_(test::random_cell(GetParam(), {.joints = 4, .obstacles = 1})),
        model_(*cell_),
        at_m_(model_),
        at_t_(model_) {
    for (std::size_t n = 0; n < model_.nodes.size(); ++n) {
      if (model_.nodes[n].joint >= 0) moving_.push_back(static_cast<int>(n));
    }
  }

  /// How far the centre of a node moves from m to t, seen from the frame of `common` at m.
  Vector3d moved(int node, int common) {
    Vector3d p = at_t_.center(node);
    if (common >= 0) p = at_m_.pose(common) * (at_t_.pose(common).inverse() * p);
    return p - at_m_.center(node);
  }

  std::shared_ptr<const world::Workcell> cell_;
  SsvModel model_;
  SsvScratch at_m_, at_t_;
  std::vector<int> moving_;
};

TEST_P(MotionBounds, HoldAtEveryCornerAndAlongEveryNormal) {
  Rng rng(GetParam());
  double tightest = 0, tightest_along = 0;
  for (int i = 0; i < 20000; ++i) {
    const VectorXd q = test::random_configuration(rng, *cell_);
    const VectorXd D = random_deviation(rng, q.size());
    VectorXd q_t = q, q_small = q;
    for (Eigen::Index j = 0; j < q.size(); ++j) {
      const double part = rng.index(4) == 0 ? rng.uniform(-1, 1) : rng.index(2) == 0 ? 1.0 : -1.0;
      q_t[j] += part * D[j];
      q_small[j] += 1e-6 * part * D[j];
    }
    const int node = moving_[rng.index(moving_.size())];
    const int joint = model_.nodes[static_cast<std::size_t>(node)].joint;
    int common = joint;
    while (common >= 0 && rng.index(3) > 0) {
      common = model_.joints[static_cast<std::size_t>(common)].parent;
    }
    at_m_.place(q);
    at_t_.place(q_small);
    const Vector3d first_order = moved(node, common) * 1e6;
    at_t_.place(q_t);
    const Vector3d shift = moved(node, common);
    at_m_.set_deviation(D);
    const double bound = at_m_.travel(node, model_.depth_of(common));
    EXPECT_LE(shift.norm(), bound + 1e-12);
    if (bound > 1e-3) tightest = std::max(tightest, shift.norm() / bound);
    // The worst normals are those along which only the second order moves the point.
    for (const Vector3d& n : {Vector3d(shift - first_order), shift, test::random_point(rng, 1)}) {
      if (n.norm() < 1e-8) continue;
      const Vector3d nhat = n.normalized();
      const double along = at_m_.travel_along(nhat, joint, common, at_m_.center(node));
      EXPECT_LE(std::abs(nhat.dot(shift)), along + 1e-9);
      EXPECT_LE(along, bound + 1e-12);
      if (along > 1e-3) {
        tightest_along = std::max(tightest_along, std::abs(nhat.dot(shift)) / along);
      }
    }
  }
  EXPECT_GT(tightest, 0.99);
  EXPECT_GT(tightest_along, 0.99);
}

INSTANTIATE_TEST_SUITE_P(Cells, MotionBounds, testing::Range<std::uint64_t>(0, 6));

}  // namespace
}  // namespace tandem::collision
