#pragma once
/// The robots of the test data, small models made by hand, and random positions.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tandem/core/rng.h"
#include "tandem/robot/kinematics.h"
#include "tandem/robot/package_path.h"
#include "tandem/robot/srdf.h"
#include "tandem/robot/urdf.h"
#include "test_data.h"

namespace tandem::robot::test {

/// Files below the test data's robots/; "" where there is none.
struct RobotFiles {
  std::string urdf, srdf, limits;
};

inline const std::vector<RobotFiles>& robot_files() {
  static const std::vector<RobotFiles> kFiles = {
      {"baxter_mbm/baxter.urdf", "baxter_mbm/baxter.srdf", ""},
      {"baxter_mbm/baxter_spherized.urdf", "baxter_mbm/baxter.srdf", ""},
      {"dual_panda/dual_panda.urdf", "dual_panda/panda.srdf", "dual_panda/joint_limits.yaml"},
      {"dual_ur5e/dual_ur5e.urdf", "dual_ur5e/dual_ur5e.srdf", "dual_ur5e/joint_limits.yaml"},
      {"fr3_duo/fr3_duo.urdf", "fr3_duo/fr3_duo.srdf", "fr3_duo/joint_limits.yaml"},
      {"panda_mbm/panda.urdf", "panda_mbm/panda.srdf", "dual_panda/hard_joint_limits.yaml"},
      {"panda_mbm/panda_spherized.urdf", "panda_mbm/panda.srdf",
       "dual_panda/hard_joint_limits.yaml"},
      {"panda_mbm/panda_spherized_straight.urdf", "panda_mbm/panda.srdf",
       "dual_panda/hard_joint_limits.yaml"},
      {"packages/moveit_resources_panda_description/panda.urdf", "",
       "dual_panda/hard_joint_limits.yaml"},
  };
  return kFiles;
}

inline std::filesystem::path robot_path(const std::string& file) {
  return tandem::test::data_path("robots") / file;
}

/// The model, or a thrown message.
inline Model load(const std::string& urdf) {
  auto model = load_urdf(robot_path(urdf), PackagePath({robot_path("packages")}));
  if (!model) throw std::runtime_error(model.error().message);
  return *std::move(model);
}

inline Semantics load_semantics(const std::string& srdf, const Model& model) {
  auto semantics = load_srdf(robot_path(srdf), model);
  if (!semantics) throw std::runtime_error(semantics.error().message);
  return *std::move(semantics);
}

inline int position_of(const Model& model, int joint) {
  return model.joints()[static_cast<std::size_t>(joint)].position_index;
}

/// Uniform inside the limits, where there are any, and inside one turn elsewhere.
inline Eigen::VectorXd random_positions(const Model& model, Rng& rng) {
  Eigen::VectorXd q(model.position_count());
  for (int i = 0; i < q.size(); ++i) {
    const JointLimits& l =
        model.joints()[static_cast<std::size_t>(model.joint_of_position(i))].limits;
    q[i] = rng.uniform(std::max(l.lower, -3.0), std::min(l.upper, 3.0));
  }
  return q;
}

inline Eigen::Isometry3d random_pose(Rng& rng) {
  Eigen::Quaterniond rotation(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1),
                              rng.uniform(-1, 1));
  Eigen::Isometry3d X(rotation.normalized());
  X.translation() = Eigen::Vector3d(rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1));
  return X;
}

inline std::vector<int> all_columns(const Model& model) {
  std::vector<int> columns;
  for (int i = 0; i < model.position_count(); ++i) columns.push_back(i);
  return columns;
}

inline Link named_link(std::string name) {
  Link link;
  link.name = std::move(name);
  return link;
}

/// A joint with limits of +-1 where it needs any.
inline Joint named_joint(std::string name, JointType type, int parent, int child,
                         const Eigen::Vector3d& axis = Eigen::Vector3d::UnitZ()) {
  Joint joint;
  joint.name = std::move(name);
  joint.type = type;
  joint.parent_link = parent;
  joint.child_link = child;
  joint.axis_J = axis;
  if (type == JointType::kRevolute || type == JointType::kPrismatic) {
    joint.limits.lower = -1;
    joint.limits.upper = 1;
  }
  return joint;
}

/// A tree of random shape: every joint type, oblique, negative and long axes, mimic chains; links
/// and joints in shuffled order.
inline Result<Model> random_model(int joint_count, Rng& rng) {
  std::vector<int> place(static_cast<std::size_t>(joint_count) + 1);
  for (std::size_t i = 0; i < place.size(); ++i) place[i] = static_cast<int>(i);
  std::shuffle(place.begin(), place.end(), rng.engine());
  std::vector<Link> links(place.size());
  std::vector<Joint> joints;
  for (std::size_t i = 0; i < place.size(); ++i) {
    links[static_cast<std::size_t>(place[i])] = named_link("link" + std::to_string(i));
    if (i == 0) continue;
    constexpr JointType kTypes[] = {JointType::kFixed, JointType::kRevolute, JointType::kContinuous,
                                    JointType::kPrismatic};
    const auto kind = static_cast<int>(rng.index(3));
    Eigen::Vector3d axis = random_pose(rng).translation();
    if (kind < 2) axis = (kind == 0 ? 1 : -1) * Eigen::Vector3d::Unit(int(rng.index(3)));
    // Three of four joints continue the last link, so that chains get long.
    const std::size_t parent = rng.index(4) ? i - 1 : rng.index(i);
    joints.push_back(named_joint("joint" + std::to_string(i), kTypes[rng.index(4)], place[parent],
                                 place[i], axis));
    joints.back().X_PJ = random_pose(rng);
  }
  std::shuffle(joints.begin(), joints.end(), rng.engine());
  int last_mover = -1;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (joints[i].type == JointType::kFixed) continue;
    if (last_mover >= 0 && rng.index(3) == 0) {
      joints[i].mimic = Mimic{last_mover, rng.uniform(-2, 2), rng.uniform(-0.5, 0.5)};
    }
    last_mover = static_cast<int>(i);
  }
  return Model::make("random", std::move(links), std::move(joints));
}

/// Expects an error of `code` whose message has every one of `parts`.
template <class T>
void expect_error(const Result<T>& result, ErrorCode code, const std::vector<std::string>& parts) {
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, code) << result.error().message;
  for (const std::string& part : parts) {
    EXPECT_NE(result.error().message.find(part), std::string::npos)
        << "no '" << part << "' in: " << result.error().message;
  }
}

}  // namespace tandem::robot::test
