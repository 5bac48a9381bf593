#include "tandem/planning/nearest.h"

#include <gtest/gtest.h>

#include "tandem/core/contract.h"
#include "tandem/core/rng.h"

namespace tandem::planning {
namespace {

using Eigen::VectorXd;

VectorXd random_vector(Rng& rng, int dof) {
  VectorXd q(dof);
  for (double& x : q) x = rng.uniform(-3, 3);
  return q;
}

TEST(NearestConfigurations, FindsWhatASweepFinds) {
  Rng rng(1);
  for (const int dof : {1, 2, 7, 14, 64}) {
    NearestConfigurations tree(dof);
    for (int round = 0; round < 2; ++round) {
      std::vector<VectorXd> all;
      tree.clear();
      EXPECT_EQ(tree.nearest(VectorXd::Zero(dof)), -1);
      for (int i = 0; i < 200; ++i) {
        all.push_back(random_vector(rng, dof));
        tree.add(all.back());
        ASSERT_EQ(tree.size(), i + 1);
        const VectorXd q = random_vector(rng, dof);
        double least = std::numeric_limits<double>::infinity();
        for (const VectorXd& other : all) least = std::min(least, (other - q).norm());
        const int found = tree.nearest(q);
        ASSERT_TRUE(0 <= found && found <= i);
        ASSERT_LE((all[static_cast<std::size_t>(found)] - q).norm(), least * (1 + 1e-5) + 1e-6);
        ASSERT_EQ(tree.nearest(all.back()), i);
      }
    }
  }
}

TEST(NearestConfigurations, BugsOfTheCaller) {
  EXPECT_THROW(NearestConfigurations(0), ContractViolation);
  NearestConfigurations tree(2);
  EXPECT_THROW(tree.add(VectorXd::Zero(3)), ContractViolation);
  EXPECT_THROW(tree.add(VectorXd::Constant(2, std::nan(""))), ContractViolation);
  EXPECT_THROW(tree.nearest(VectorXd::Zero(1)), ContractViolation);
}

}  // namespace
}  // namespace tandem::planning
