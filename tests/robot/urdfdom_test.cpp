#include <urdf_parser/urdf_parser.h>

#include "robots.h"

namespace tandem::robot {
namespace {

Eigen::Isometry3d pose(const urdf::Pose& p) {
  Eigen::Isometry3d X(Eigen::Quaterniond(p.rotation.w, p.rotation.x, p.rotation.y, p.rotation.z));
  X.translation() = Eigen::Vector3d(p.position.x, p.position.y, p.position.z);
  return X;
}

void expect_same_joint(const Model& model, const Joint& joint, const urdf::Joint& other) {
  SCOPED_TRACE(joint.name);
  const auto type = other.type == urdf::Joint::REVOLUTE     ? JointType::kRevolute
                    : other.type == urdf::Joint::CONTINUOUS ? JointType::kContinuous
                    : other.type == urdf::Joint::PRISMATIC  ? JointType::kPrismatic
                                                            : JointType::kFixed;
  EXPECT_EQ(joint.type, type);
  EXPECT_EQ(model.links()[static_cast<std::size_t>(joint.parent_link)].name,
            other.parent_link_name);
  EXPECT_EQ(model.links()[static_cast<std::size_t>(joint.child_link)].name, other.child_link_name);
  EXPECT_TRUE(joint.X_PJ.isApprox(pose(other.parent_to_joint_origin_transform), 1e-12));
  if (type == JointType::kFixed) return;
  EXPECT_TRUE(joint.axis_J.isApprox(Eigen::Vector3d(other.axis.x, other.axis.y, other.axis.z)));
  EXPECT_EQ(joint.limits.lower, other.limits->lower);
  EXPECT_EQ(joint.limits.upper, other.limits->upper);
  EXPECT_EQ(joint.limits.velocity, other.limits->velocity);
  ASSERT_EQ(joint.mimic.has_value(), other.mimic != nullptr);
  if (!joint.mimic) return;
  EXPECT_EQ(model.joints()[static_cast<std::size_t>(joint.mimic->joint)].name,
            other.mimic->joint_name);
  EXPECT_EQ(joint.mimic->multiplier, other.mimic->multiplier);
  EXPECT_EQ(joint.mimic->offset, other.mimic->offset);
}

void expect_same_geometry(const Geometry& geometry, const urdf::Collision& other) {
  EXPECT_TRUE(geometry.X_LG.isApprox(pose(other.origin), 1e-12));
  if (const auto* box = std::get_if<BoxGeometry>(&geometry.shape)) {
    const auto& b = dynamic_cast<const urdf::Box&>(*other.geometry);
    EXPECT_EQ(box->size, Eigen::Vector3d(b.dim.x, b.dim.y, b.dim.z));
  } else if (const auto* sphere = std::get_if<SphereGeometry>(&geometry.shape)) {
    EXPECT_EQ(sphere->radius, dynamic_cast<const urdf::Sphere&>(*other.geometry).radius);
  } else if (const auto* cylinder = std::get_if<CylinderGeometry>(&geometry.shape)) {
    const auto& c = dynamic_cast<const urdf::Cylinder&>(*other.geometry);
    EXPECT_EQ(cylinder->radius, c.radius);
    EXPECT_EQ(cylinder->length, c.length);
  } else {
    const auto& mesh = std::get<MeshGeometry>(geometry.shape);
    const auto& m = dynamic_cast<const urdf::Mesh&>(*other.geometry);
    EXPECT_EQ(mesh.uri, m.filename);
    EXPECT_EQ(mesh.scale, Eigen::Vector3d(m.scale.x, m.scale.y, m.scale.z));
  }
}

void expect_same_link(const Link& link, const urdf::Link& other) {
  SCOPED_TRACE(link.name);
  ASSERT_EQ(link.collision.size(), other.collision_array.size());
  ASSERT_EQ(link.visual.size(), other.visual_array.size());
  for (std::size_t i = 0; i < link.collision.size(); ++i) {
    expect_same_geometry(link.collision[i], *other.collision_array[i]);
  }
  ASSERT_EQ(link.inertial.has_value(), other.inertial != nullptr);
  if (!link.inertial) return;
  const urdf::Inertial& inertial = *other.inertial;
  EXPECT_EQ(link.inertial->mass, inertial.mass);
  EXPECT_TRUE(link.inertial->X_LI.isApprox(pose(inertial.origin), 1e-12));
  Eigen::Matrix3d I_I;
  I_I << inertial.ixx, inertial.ixy, inertial.ixz, inertial.ixy, inertial.iyy, inertial.iyz,
      inertial.ixz, inertial.iyz, inertial.izz;
  EXPECT_EQ(link.inertial->I_I, I_I);
}

TEST(Urdf, ReadsTheSameAsUrdfdom) {
  TANDEM_SKIP_WITHOUT_DATA("robots");
  for (const test::RobotFiles& files : test::robot_files()) {
    SCOPED_TRACE(files.urdf);
    const Model model = test::load(files.urdf);
    const auto other = urdf::parseURDFFile(test::robot_path(files.urdf).string());
    ASSERT_TRUE(other);
    EXPECT_EQ(model.name(), other->getName());
    EXPECT_EQ(model.links()[0].name, other->getRoot()->name);
    ASSERT_EQ(model.links().size(), other->links_.size());
    ASSERT_EQ(model.joints().size(), other->joints_.size());
    for (const Joint& joint : model.joints()) {
      expect_same_joint(model, joint, *other->joints_.at(joint.name));
    }
    for (const Link& link : model.links()) expect_same_link(link, *other->links_.at(link.name));
  }
}

}  // namespace
}  // namespace tandem::robot
