#pragma once
/// The kinematic tree of one robot, or of a whole cell of robots.

#include <Eigen/Geometry>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "tandem/core/result.h"

namespace tandem::robot {

enum class JointType { kFixed, kRevolute, kContinuous, kPrismatic };

/// "fixed", "revolute", ...
const char* to_string(JointType type);

/// Limits of one joint; symmetric but for the position. Infinite where there is none.
struct JointLimits {
  double lower = -std::numeric_limits<double>::infinity();        ///< [rad] or [m]
  double upper = std::numeric_limits<double>::infinity();         ///< [rad] or [m]
  double velocity = std::numeric_limits<double>::infinity();      ///< > 0
  double acceleration = std::numeric_limits<double>::infinity();  ///< > 0
  double jerk = std::numeric_limits<double>::infinity();          ///< > 0, optional
};

/// Follows another joint: q = multiplier * q_source + offset.
struct Mimic {
  int joint;  ///< Index of the joint it follows; in a Model never itself a mimic.
  double multiplier = 1;
  double offset = 0;
};

struct Joint {
  std::string name;
  JointType type = JointType::kFixed;
  int parent_link = -1;
  int child_link = -1;
  Eigen::Isometry3d X_PJ = Eigen::Isometry3d::Identity();  ///< Joint frame in the parent link.
  Eigen::Vector3d axis_J = Eigen::Vector3d::UnitX();  ///< Unit unless fixed, in the joint frame.
  JointLimits limits;
  std::optional<Mimic> mimic;
  int position_index = -1;  ///< Into the position vector; -1 for fixed joints and mimics.
  std::string where = {};   ///< "FILE:LINE:COLUMN", put before messages; empty if in memory.
};

struct BoxGeometry {
  Eigen::Vector3d size;  ///< Full edge lengths [m].
};
struct SphereGeometry {
  double radius;
};
struct CylinderGeometry {
  double radius;
  double length;  ///< Along z, flat ends.
};
struct MeshGeometry {
  std::string uri;   ///< As written: package://, file:// or relative.
  std::string path;  ///< Resolved file; empty where it was not found.
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();
  std::string missing = {};  ///< Of a mesh without path: where it was looked for.
};

/// A piece of a link's geometry, as in the URDF.
struct Geometry {
  Eigen::Isometry3d X_LG = Eigen::Isometry3d::Identity();
  std::variant<BoxGeometry, SphereGeometry, CylinderGeometry, MeshGeometry> shape;
};

struct Inertial {
  double mass = 0;  ///< [kg]
  Eigen::Isometry3d X_LI = Eigen::Isometry3d::Identity();
  Eigen::Matrix3d I_I = Eigen::Matrix3d::Zero();  ///< About the centre of mass [kg m^2].
};

struct Link {
  std::string name;
  int parent_joint = -1;  ///< -1 for the root.
  std::vector<Geometry> collision;
  std::vector<Geometry> visual;
  std::optional<Inertial> inertial;
  std::string where = {};  ///< As of a joint.
};

/// An immutable tree, depth-first: a parent comes before its children, link 0 is the root, and
/// joint k carries link k + 1. Positions are the values of all movable joints that follow no other,
/// in joint order.
class Model {
 public:
  /// Orders links and joints, normalises axes, resolves mimic chains to their source and checks the
  /// tree. Indices in the arguments refer to the arguments; parent_joint and position_index are
  /// set.
  /// @return kInvalidInput naming the link or joint: duplicate names, several roots, cycles, zero
  /// axes, a mimic of nothing, of itself or of a fixed joint, inverted limits, values that are not
  /// finite.
  static Result<Model> make(std::string name, std::vector<Link> links, std::vector<Joint> joints);

  const std::string& name() const { return name_; }
  const std::vector<Link>& links() const { return links_; }
  const std::vector<Joint>& joints() const { return joints_; }
  int position_count() const { return position_count_; }
  /// The joint behind entry `i` of a position vector.
  int joint_of_position(int i) const { return position_joints_[static_cast<std::size_t>(i)]; }

  /// Index by name, or -1.
  int find_link(std::string_view name) const;
  int find_joint(std::string_view name) const;

  /// Joints from `base_link` (exclusive) down to `tip_link`, base first, fixed ones included.
  /// @return kInvalidInput if `tip_link` is not below `base_link`.
  Result<std::vector<int>> chain(int base_link, int tip_link) const;
  /// Movable joints above `link`, base first; a mimic is replaced by the joint it follows.
  const std::vector<int>& moving_ancestors(int link) const {
    return moving_ancestors_[static_cast<std::size_t>(link)];
  }

  /// Replaces the limits of joint `joint`; used by overlays before the model is shared. A revolute
  /// joint without position limits becomes continuous, a continuous one with limits revolute.
  void set_limits(int joint, const JointLimits& limits);

 private:
  std::string name_;
  std::vector<Link> links_;
  std::vector<Joint> joints_;
  std::vector<int> position_joints_;
  std::vector<std::vector<int>> moving_ancestors_;
  int position_count_ = 0;
};

/// A model placed in a cell: its root is welded to the world with a prefix before every name.
struct Placement {
  const Model* model;
  std::string prefix;  ///< "" or e.g. "left/"; put before link and joint names.
  Eigen::Isometry3d X_WB = Eigen::Isometry3d::Identity();
};

/// One tree with root link "world" that carries all placements, in order. Names must be unique
/// after prefixing. A root link that is itself called "world" is kept under its prefixed name
/// unless the prefix is empty, when it becomes the common root (its X_WB must be the identity).
Result<Model> merge(std::string name, const std::vector<Placement>& placements);

}  // namespace tandem::robot
