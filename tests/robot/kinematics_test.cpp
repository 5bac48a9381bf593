#include "tandem/robot/kinematics.h"

#include <kdl/tree.hpp>
#include <kdl/treefksolverpos_recursive.hpp>
#include <kdl/treejnttojacsolver.hpp>

#include "robots.h"
#include "tandem/core/contract.h"

namespace tandem::robot {
namespace {

KDL::Frame to_kdl(const Eigen::Isometry3d& X) {
  const Eigen::Matrix3d R = X.linear();
  const Eigen::Vector3d p = X.translation();
  return {KDL::Rotation(R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1),
                        R(2, 2)),
          KDL::Vector(p.x(), p.y(), p.z())};
}

/// Every movable joint, mimics too, has an entry of its own in KDL.
class KdlOracle {
 public:
  explicit KdlOracle(const Model& model) : model_(model), tree_(model.links()[0].name) {
    for (const Joint& joint : model.joints()) {
      const KDL::Frame X_PJ = to_kdl(joint.X_PJ);
      const Eigen::Vector3d a = joint.axis_J;
      const KDL::Vector axis = X_PJ.M * KDL::Vector(a.x(), a.y(), a.z());
      const KDL::Joint::JointType type =
          joint.type == JointType::kPrismatic ? KDL::Joint::TransAxis : KDL::Joint::RotAxis;
      const KDL::Joint kdl_joint = joint.type == JointType::kFixed
                                       ? KDL::Joint(joint.name, KDL::Joint::Fixed)
                                       : KDL::Joint(joint.name, X_PJ.p, axis, type);
      const KDL::Segment segment(link(joint.child_link), kdl_joint, X_PJ);
      if (!tree_.addSegment(segment, link(joint.parent_link))) {
        throw std::runtime_error("KDL refuses joint " + joint.name);
      }
    }
    fk_ = std::make_unique<KDL::TreeFkSolverPos_recursive>(tree_);
    jacobian_ = std::make_unique<KDL::TreeJntToJacSolver>(tree_);
    q_.resize(tree_.getNrOfJoints());
  }

  void set_positions(const Eigen::VectorXd& positions) {
    for (const Joint& joint : model_.joints()) {
      if (joint.type != JointType::kFixed) q_(entry(joint)) = value(joint, positions);
    }
  }

  Eigen::Matrix4d pose(int link_index) const {
    KDL::Frame X;
    if (fk_->JntToCart(q_, X, link(link_index)) < 0) throw std::runtime_error("KDL FK failed");
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 4; ++c) matrix(r, c) = X(r, c);
    }
    return matrix;
  }

  /// Of the link's origin, for all positions.
  Eigen::MatrixXd jacobian(int link_index) const {
    KDL::Jacobian J(tree_.getNrOfJoints());
    if (jacobian_->JntToJac(q_, J, link(link_index)) < 0) throw std::runtime_error("KDL failed");
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(6, model_.position_count());
    for (const Joint& joint : model_.joints()) {
      if (joint.type == JointType::kFixed) continue;
      sum.col(source(joint).position_index) +=
          (joint.mimic ? joint.mimic->multiplier : 1.0) * J.data.col(int(entry(joint)));
    }
    return sum;
  }

 private:
  const std::string& link(int i) const { return model_.links()[static_cast<std::size_t>(i)].name; }
  const Joint& source(const Joint& joint) const {
    return joint.mimic ? model_.joints()[static_cast<std::size_t>(joint.mimic->joint)] : joint;
  }
  unsigned entry(const Joint& joint) const {
    return tree_.getSegment(link(joint.child_link))->second.q_nr;
  }
  double value(const Joint& joint, const Eigen::VectorXd& positions) const {
    const double q = positions[source(joint).position_index];
    return joint.mimic ? joint.mimic->multiplier * q + joint.mimic->offset : q;
  }

  const Model& model_;
  KDL::Tree tree_;
  std::unique_ptr<KDL::TreeFkSolverPos_recursive> fk_;
  std::unique_ptr<KDL::TreeJntToJacSolver> jacobian_;
  KDL::JntArray q_;
};

/// Poses and Jacobians of every link at `rounds` random positions.
void expect_agreement(const Model& model, int rounds, std::uint64_t seed) {
  Rng rng(seed);
  KdlOracle oracle(model);
  const std::vector<int> columns = test::all_columns(model);
  Eigen::Matrix<double, 6, Eigen::Dynamic> J_W(6, model.position_count());
  LinkPoses X_WL;
  double pose_error = 0, jacobian_error = 0;
  for (int round = 0; round < rounds; ++round) {
    const Eigen::VectorXd q = test::random_positions(model, rng);
    forward_kinematics(model, q, X_WL);
    oracle.set_positions(q);
    for (std::size_t link = 0; link < model.links().size(); ++link) {
      const int i = static_cast<int>(link);
      const Eigen::Matrix4d difference = X_WL[link].matrix() - oracle.pose(i);
      pose_error = std::max(pose_error, difference.cwiseAbs().maxCoeff());
      if (columns.empty()) continue;
      jacobian(model, X_WL, i, X_WL[link].translation(), columns, J_W);
      jacobian_error = std::max(jacobian_error, (J_W - oracle.jacobian(i)).cwiseAbs().maxCoeff());
    }
  }
  EXPECT_LT(pose_error, 1e-10);
  EXPECT_LT(jacobian_error, 1e-10);
}

TEST(Kinematics, AgreesWithKdlOnAllRobots) {
  TANDEM_SKIP_WITHOUT_DATA("robots");
  for (const test::RobotFiles& files : test::robot_files()) {
    SCOPED_TRACE(files.urdf);
    expect_agreement(test::load(files.urdf), 300, 17);
  }
}

TEST(Kinematics, AgreesWithKdlOnRandomTreesWithMimics) {
  Rng rng(23);
  for (int round = 0; round < 100; ++round) {
    const auto model = test::random_model(2 + static_cast<int>(rng.index(15)), rng);
    ASSERT_TRUE(model) << model.error().message;
    if (model->position_count() == 0) continue;  // KDL cannot do without joints.
    expect_agreement(*model, 5, rng.split());
  }
}

/// Central differences of the pose of point P and its link.
void expect_differences(const Model& model, int link, const Eigen::Vector3d& p_LP,
                        const Eigen::VectorXd& q) {
  constexpr double h = 1e-6;
  const auto index = static_cast<std::size_t>(link);
  const std::vector<int> columns = test::all_columns(model);
  Eigen::Matrix<double, 6, Eigen::Dynamic> J_W(6, model.position_count());
  LinkPoses X_WL, plus, minus;
  forward_kinematics(model, q, X_WL);
  jacobian(model, X_WL, link, X_WL[index] * p_LP, columns, J_W);
  for (int i = 0; i < model.position_count(); ++i) {
    const Eigen::VectorXd step = h * Eigen::VectorXd::Unit(q.size(), i);
    forward_kinematics(model, q + step, plus);
    forward_kinematics(model, q - step, minus);
    const Eigen::Vector3d v = (plus[index] * p_LP - minus[index] * p_LP) / (2 * h);
    const Eigen::AngleAxisd turn(
        Eigen::Matrix3d(plus[index].linear() * minus[index].linear().transpose()));
    const Eigen::Vector3d w = turn.angle() * turn.axis() / (2 * h);
    EXPECT_LT((J_W.col(i).head<3>() - v).norm(), 2e-8);
    EXPECT_LT((J_W.col(i).tail<3>() - w).norm(), 2e-8);
  }
}

TEST(Jacobian, AgreesWithDifferencesOnRandomTreesWithMimics) {
  Rng rng(29);
  int mimics = 0;
  for (int round = 0; round < 200; ++round) {
    const auto model = test::random_model(12, rng);
    ASSERT_TRUE(model) << model.error().message;
    for (const Joint& joint : model->joints()) mimics += joint.mimic.has_value();
    const int link = static_cast<int>(rng.index(model->links().size()));
    expect_differences(*model, link, test::random_pose(rng).translation(),
                       test::random_positions(*model, rng));
  }
  EXPECT_GT(mimics, 100);
}

TEST(Jacobian, OfAFingerFollowsItsSource) {
  TANDEM_SKIP_WITHOUT_DATA("robots");
  const Model model = test::load("dual_panda/dual_panda.urdf");
  const int finger = model.find_link("left_panda_rightfinger");
  ASSERT_GE(finger, 0);
  Rng rng(2);
  expect_differences(model, finger, {0, 0, 0.05}, test::random_positions(model, rng));
  // The finger follows its neighbour, whose link it is not below.
  const int source = test::position_of(model, model.find_joint("left_panda_finger_joint1"));
  LinkPoses X_WL;
  forward_kinematics(model, test::random_positions(model, rng), X_WL);
  Eigen::Matrix<double, 6, Eigen::Dynamic> J_W(6, 1);
  jacobian(model, X_WL, finger, Eigen::Vector3d::Zero(), std::vector<int>{source}, J_W);
  EXPECT_NEAR(J_W.norm(), 1, 1e-12);
}

TEST(Jacobian, TakesColumnsInAnyOrderAndLeavesOthersZero) {
  Rng rng(31);
  const auto model = test::random_model(20, rng);
  ASSERT_TRUE(model) << model.error().message;
  LinkPoses X_WL;
  forward_kinematics(*model, test::random_positions(*model, rng), X_WL);
  std::vector<int> columns = test::all_columns(*model);
  const int link = static_cast<int>(model->links().size()) - 1;
  Eigen::Matrix<double, 6, Eigen::Dynamic> all(6, columns.size()), some(6, columns.size());
  jacobian(*model, X_WL, link, Eigen::Vector3d::Ones(), columns, all);
  std::shuffle(columns.begin(), columns.end(), rng.engine());
  columns.resize(columns.size() / 2);
  // Into part of a larger matrix, as solvers do.
  some.setConstant(7);
  const auto count = static_cast<Eigen::Index>(columns.size());
  jacobian(*model, X_WL, link, Eigen::Vector3d::Ones(), columns, some.leftCols(count));
  for (Eigen::Index i = 0; i < count; ++i) {
    EXPECT_EQ(some.col(i), all.col(columns[static_cast<std::size_t>(i)]));
  }
  EXPECT_TRUE((some.rightCols(some.cols() - count).array() == 7).all());
  jacobian(*model, X_WL, 0, Eigen::Vector3d::Ones(), columns, some.leftCols(count));
  EXPECT_TRUE(some.leftCols(count).isZero(0));
}

TEST(Kinematics, ReusesTheMemoryOfThePoses) {
  Rng rng(37);
  const auto model = test::random_model(10, rng);
  ASSERT_TRUE(model) << model.error().message;
  LinkPoses X_WL;
  forward_kinematics(*model, test::random_positions(*model, rng), X_WL);
  const auto* memory = X_WL.data();
  const Eigen::VectorXd q = test::random_positions(*model, rng);
  forward_kinematics(*model, q, X_WL);
  EXPECT_EQ(X_WL.data(), memory);
  LinkPoses fresh;
  forward_kinematics(*model, q, fresh);
  for (std::size_t i = 0; i < fresh.size(); ++i) EXPECT_EQ(X_WL[i].matrix(), fresh[i].matrix());
}

TEST(Kinematics, RejectsWrongSizes) {
  Rng rng(41);
  const auto model = test::random_model(10, rng);
  ASSERT_TRUE(model) << model.error().message;
  LinkPoses X_WL;
  const Eigen::VectorXd q = test::random_positions(*model, rng);
  EXPECT_THROW(forward_kinematics(*model, Eigen::VectorXd::Zero(q.size() + 1), X_WL),
               ContractViolation);
  forward_kinematics(*model, q, X_WL);
  Eigen::Matrix<double, 6, Eigen::Dynamic> J_W(6, 2);
  const std::vector<int> one = {0};
  EXPECT_THROW(jacobian(*model, X_WL, 1, Eigen::Vector3d::Zero(), one, J_W), ContractViolation);
  EXPECT_THROW(jacobian(*model, X_WL, 99, Eigen::Vector3d::Zero(), one, J_W.leftCols(1)),
               ContractViolation);
  X_WL.pop_back();
  EXPECT_THROW(jacobian(*model, X_WL, 1, Eigen::Vector3d::Zero(), one, J_W.leftCols(1)),
               ContractViolation);
}

}  // namespace
}  // namespace tandem::robot
