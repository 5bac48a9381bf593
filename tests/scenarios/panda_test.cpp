// The Panda of the scenarios: kinematics, limits, states and disabled pairs.

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "panda_model.h"
#include "tandem/core/rng.h"
#include "tandem/geometry/distance.h"
#include "tandem/robot/joint_limits.h"
#include "tandem/robot/kinematics.h"
#include "tandem/robot/srdf.h"

namespace tandem {
namespace {

using Eigen::VectorXd;
using geometry::Shape;

const char* const kPublished = "robots/packages/moveit_resources_panda_description/panda.urdf";

const robot::JointLimits& limits_of(const robot::Model& model, int position) {
  return model.joints()[static_cast<std::size_t>(model.joint_of_position(position))].limits;
}

/// Uniform inside the limits; `edge` of all values lie on one of them.
VectorXd random_positions(const robot::Model& model, Rng& rng, double edge = 0) {
  VectorXd q(model.position_count());
  for (int i = 0; i < q.size(); ++i) {
    const robot::JointLimits& l = limits_of(model, i);
    q[i] = rng.uniform(l.lower, l.upper);
    if (rng.uniform() < edge) q[i] = rng.uniform() < 0.5 ? l.lower : l.upper;
  }
  return q;
}

TEST(Panda, KinematicsAreThePublishedOnes) {
  TANDEM_SKIP_WITHOUT_DATA(kPublished);
  const test::Panda panda;
  const auto published = robot::load_urdf(test::data_path(kPublished));
  ASSERT_TRUE(published) << published.error().message;
  ASSERT_EQ(panda.model.position_count(), published->position_count());
  Rng rng(3);
  robot::LinkPoses X_WL, X_WL_published;
  for (int i = 0; i < 1000; ++i) {
    const VectorXd q = random_positions(panda.model, rng);
    VectorXd q_published(q.size());
    for (int k = 0; k < q.size(); ++k) {
      const auto joint = static_cast<std::size_t>(published->joint_of_position(k));
      const int ours = panda.model.find_joint(published->joints()[joint].name);
      q_published[k] = q[panda.model.joints()[static_cast<std::size_t>(ours)].position_index];
    }
    robot::forward_kinematics(panda.model, q, X_WL);
    robot::forward_kinematics(*published, q_published, X_WL_published);
    for (std::size_t l = 0; l < published->links().size(); ++l) {
      const std::string& name = published->links()[l].name;
      const int link = panda.model.find_link(name);
      ASSERT_GE(link, 0) << name;
      const auto difference =
          X_WL[static_cast<std::size_t>(link)].matrix() - X_WL_published[l].matrix();
      ASSERT_LT(difference.cwiseAbs().maxCoeff(), 1e-9) << name;
    }
  }
}

TEST(Panda, ToolFrameIsBetweenTheFingertips) {
  const test::Panda panda;
  robot::LinkPoses X_WL;
  robot::forward_kinematics(panda.model, VectorXd::Zero(panda.model.position_count()), X_WL);
  const auto pose = [&](const char* link) {
    return X_WL[static_cast<std::size_t>(panda.model.find_link(link))];
  };
  const Eigen::Isometry3d X_HE = pose("panda_hand").inverse() * pose("panda_hand_tcp");
  EXPECT_TRUE(X_HE.isApprox(Eigen::Isometry3d(Eigen::Translation3d(0, 0, 0.1034)), 1e-12));
}

TEST(Panda, LimitsAreThePublishedOnes) {
  const test::Panda panda;
  const double lower[] = {-2.8973, -1.7628, -2.8973, -3.0718, -2.8973, -0.0175, -2.8973};
  const double upper[] = {2.8973, 1.7628, 2.8973, -0.0698, 2.8973, 3.7525, 2.8973};
  const double velocity[] = {2.175, 2.175, 2.175, 2.175, 2.61, 2.61, 2.61};
  const double soft[] = {3.75, 1.875, 2.5, 3.125, 3.75, 5.0, 5.0};
  const double hard[] = {15.0, 7.5, 10.0, 12.5, 15.0, 20.0, 20.0};
  const double jerk[] = {7500, 3750, 5000, 6250, 7500, 10000, 10000};
  robot::Model with_soft = panda.model, with_hard = panda.model;
  const auto overlay = [](const char* file, robot::Model& model) {
    return robot::overlay_joint_limits(test::source_path(std::string(test::kPanda) + file), model);
  };
  ASSERT_TRUE(overlay("joint_limits.yaml", with_soft));
  ASSERT_TRUE(overlay("hard_joint_limits.yaml", with_hard));
  for (int i = 0; i < 7; ++i) {
    const int joint = panda.model.find_joint("panda_joint" + std::to_string(i + 1));
    ASSERT_GE(joint, 0);
    const auto limits = [&](const robot::Model& model) {
      return model.joints()[static_cast<std::size_t>(joint)].limits;
    };
    EXPECT_EQ(limits(panda.model).lower, lower[i]);
    EXPECT_EQ(limits(panda.model).upper, upper[i]);
    EXPECT_EQ(limits(panda.model).velocity, velocity[i]);
    EXPECT_EQ(limits(with_soft).velocity, velocity[i]);
    EXPECT_EQ(limits(with_soft).acceleration, soft[i]);
    EXPECT_EQ(limits(with_hard).acceleration, hard[i]);
    EXPECT_EQ(limits(with_hard).jerk, jerk[i]);
  }
}

TEST(Panda, InertiasAreThoseOfBodies) {
  const test::Panda panda;
  for (const robot::Link& link : panda.model.links()) {
    if (link.collision.empty()) continue;
    ASSERT_TRUE(link.inertial) << link.name;
    EXPECT_GT(link.inertial->mass, 0) << link.name;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> principal(link.inertial->I_I);
    const Eigen::Vector3d moments = principal.eigenvalues();
    EXPECT_GT(moments[0], 0) << link.name;
    EXPECT_GE(moments[0] + moments[1], moments[2]) << link.name;
  }
}

/// Every pair of links with volumes.
class PandaPairs : public ::testing::Test {
 protected:
  void SetUp() override {
    auto read =
        robot::load_srdf(test::source_path(std::string(test::kPanda) + "panda.srdf"), panda_.model);
    ASSERT_TRUE(read) << read.error().message;
    semantics_ = *std::move(read);
  }

  const robot::DisabledPair* disabled(const std::string& a, const std::string& b) const {
    for (const robot::DisabledPair& pair : semantics_.disabled_pairs) {
      if ((pair.link_a == a && pair.link_b == b) || (pair.link_a == b && pair.link_b == a)) {
        return &pair;
      }
    }
    return nullptr;
  }

  bool touch(const std::string& a, const std::string& b) const {
    const auto& X_WA = X_WL_[static_cast<std::size_t>(panda_.model.find_link(a))];
    const auto& X_WB = X_WL_[static_cast<std::size_t>(panda_.model.find_link(b))];
    for (const Shape& shape_a : panda_.volumes.at(a)) {
      for (const Shape& shape_b : panda_.volumes.at(b)) {
        if (geometry::clearance(shape_a.in(X_WA), shape_b.in(X_WB)).distance <= 0) return true;
      }
    }
    return false;
  }

  test::Panda panda_;
  robot::Semantics semantics_;
  robot::LinkPoses X_WL_;
};

TEST_F(PandaPairs, NamedStatesAreFree) {
  for (const char* name : {"ready", "extended"}) {
    const robot::NamedState* state = semantics_.find_state("panda_arm", name);
    ASSERT_NE(state, nullptr) << name;
    VectorXd q = VectorXd::Zero(panda_.model.position_count());
    ASSERT_EQ(state->values.size(), 7u);
    for (const auto& [joint, value] : state->values) {
      const int j = panda_.model.find_joint(joint);
      const robot::Joint& found = panda_.model.joints()[static_cast<std::size_t>(j)];
      EXPECT_GT(value, found.limits.lower) << name << ' ' << joint;
      EXPECT_LT(value, found.limits.upper) << name << ' ' << joint;
      q[found.position_index] = value;
    }
    robot::forward_kinematics(panda_.model, q, X_WL_);
    for (const auto& [a, unused_a] : panda_.volumes) {
      for (const auto& [b, unused_b] : panda_.volumes) {
        if (a >= b || disabled(a, b)) continue;
        EXPECT_FALSE(touch(a, b)) << name << ": " << a << ", " << b;
      }
    }
  }
}

TEST_F(PandaPairs, DisabledPairsAlwaysOrNeverTouch) {
  ASSERT_EQ(semantics_.disabled_pairs.size(), 32u);
  Rng rng(11);
  for (int i = 0; i < 4000; ++i) {
    // Extremes lie on the limits more often than inside.
    const VectorXd q = random_positions(panda_.model, rng, 0.3);
    robot::forward_kinematics(panda_.model, q, X_WL_);
    for (const robot::DisabledPair& pair : semantics_.disabled_pairs) {
      if (pair.reason == "Default") continue;  // The fingers, which meet when closed.
      ASSERT_TRUE(pair.reason == "Adjacent" || pair.reason == "Never") << pair.reason;
      ASSERT_EQ(touch(pair.link_a, pair.link_b), pair.reason == "Adjacent")
          << pair.link_a << ", " << pair.link_b << " at " << q.transpose();
    }
  }
}

TEST_F(PandaPairs, AllOthersCanTouch) {
  // A pair that never touches and is checked only costs time.
  Rng rng(13);
  std::map<std::pair<std::string, std::string>, bool> seen;
  for (int i = 0; i < 4000; ++i) {
    robot::forward_kinematics(panda_.model, random_positions(panda_.model, rng, 0.3), X_WL_);
    for (const auto& [a, unused_a] : panda_.volumes) {
      for (const auto& [b, unused_b] : panda_.volumes) {
        if (a >= b || disabled(a, b)) continue;
        bool& touched = seen[{a, b}];
        touched = touched || touch(a, b);
      }
    }
  }
  for (const auto& [pair, touched] : seen)
    EXPECT_TRUE(touched) << pair.first << ", " << pair.second;
}

}  // namespace
}  // namespace tandem
